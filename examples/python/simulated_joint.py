"""Make a simulated joint to certify: recordings, joint file and session file, in a new folder.

    python examples/python/simulated_joint.py certified

Five careless gauges on the gear of Godler et al. 2000; gains that cancel two harmonics; known loads
at five positions of the wave generator. The commands that follow are printed.
"""

import csv
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from strainwave.commissioning.fluctuation import FluctuationOptions, calibrate_fluctuation
from strainwave.joint import (
    Gear,
    Provenance,
    new_joint,
    write_joint,
)
from strainwave.simulate import (
    GaugePlacement,
    Station,
    constant_speed,
    godler2000,
    load_by_weights,
    up_and_down,
)

GAUGES, HARMONICS, POSITIONS, SEED = 5, 2, 5, 5
RATED_TORQUE_NM = 100.0
GAUGE_MAP = "angle=beta_rad,gauges=" + "+".join(f"g{j + 1}_V" for j in range(GAUGES))

SESSION = """\
operator = "A. Example"
laboratory = "Bench for gear sensors"
place = "simulated bench"
date = 2026-11-20
valid_until = 2099-12-31
data = "simulated"
setup = "Wave generator locked at five positions; weights on an arm of 1 m, up and down."
decision_rule = "simple"

[environment]
temperature_degC = 20.0
temperature_uncertainty_K = 0.5
relative_humidity_percent = 45.0
relative_humidity_uncertainty_percent = 5.0

[[instruments]]
name = "weights"
serial = "W-17"
certificate = "M1-2026-0417"
calibrated_until = 2027-04-30

[[instruments]]
name = "lever arm"
serial = "L-3"
certificate = "LEN-2025-118"
calibrated_until = 2027-01-31

[limits]
linearity_error_percent_of_rated_torque = 1.0
hysteresis_percent_of_rated_torque = 1.0
consistency = 0.01
residual_fluctuation_percent_of_rated_torque = 0.5
noise_factor = 1.5
"""


def station() -> Station:
    """Five gauges, bonded with 15 % of amplitude and 10 degrees of phase scatter."""
    random = np.random.default_rng(SEED)
    base = godler2000(3)
    harmonics = tuple(
        replace(each, shear_strain=each.shear_strain * GAUGES / 3)
        for each in base.strain_field.harmonics
    )
    placements = tuple(
        GaugePlacement(
            position_rad=math.pi * j / GAUGES,
            radius_m=base.gauges[0].radius_m,
            wave_scale=(*(1 + random.normal(0, [0.06, 0.15])), 1.0),
            wave_phase_error_rad=(*np.deg2rad(random.normal(0, [3.0, 10.0])), 0.0),
        )
        for j in range(GAUGES)
    )
    field = replace(base.strain_field, harmonics=harmonics)
    return replace(base, gauges=placements, strain_field=field)


def write_csv(path: Path, names: list[str], rows: list[list[object]]) -> None:
    """Write a table."""
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(names)
        writer.writerows(rows)


def write_gauges(path: Path, joint: Station) -> None:
    """Record two turns without load."""
    run = joint.rotate(constant_speed(2 * math.pi, 0.0), 2.0, SEED)
    names = ["beta_rad", *(f"g{j + 1}_V" for j in range(GAUGES))]
    write_csv(path, names, np.column_stack([run.motor_angle_rad, run.volts]).tolist())


def write_loads(path: Path, joint: Station, gains: tuple[float, ...]) -> None:
    """Load the joint up and down at every position."""
    rows: list[list[object]] = []
    loads = up_and_down(RATED_TORQUE_NM, 5, both_directions=True)
    for k in range(POSITIONS):
        position = math.pi * k / POSITIONS
        found = load_by_weights(joint, loads, SEED + k, position_rad=position)
        volts = (found.volts + found.zero_V) @ np.array(gains)
        for load, read in zip(found.applied_torque_Nm.tolist(), volts.tolist(), strict=True):
            rows.append([k + 1, math.degrees(position), load, read])
    write_csv(path, ["run", "beta_deg", "load_Nm", "bridge_V"], rows)


def make(folder: Path) -> None:
    """Write run.csv, loads.csv, joint.toml with gear and gains, and session.toml."""
    folder.mkdir(parents=True)
    simulated, run, path = station(), folder / "run.csv", folder / "joint.toml"
    file = new_joint("simulated elbow", serial="SIM-0005")
    made = Provenance.of_simulation(f"gear of Godler et al. 2000, five gauges, seed {SEED}")
    gear = Gear(configuration="fixed_flexspline", ratio=51.0, rated_torque_Nm=RATED_TORQUE_NM)
    file.set_section("gear", gear, made)
    write_joint(file, path)
    write_gauges(run, simulated)
    options = FluctuationOptions(mapping=(GAUGE_MAP,), harmonics=HARMONICS)
    command = (
        f"strainwave calibrate fluctuation run.csv --map {GAUGE_MAP} --harmonics {HARMONICS} "
        "--joint joint.toml --out joint.toml"
    )
    found = calibrate_fluctuation(run, path, options, joint_path=path, command=command)
    write_loads(folder / "loads.csv", simulated, tuple(found.gains.tolist()))
    (folder / "session.toml").write_text(SESSION)


if __name__ == "__main__":
    made_in = Path(sys.argv[1])
    make(made_in)
    print(f"""\
cd {made_in}
strainwave calibrate torque loads.csv --map load=load_Nm,voltage=bridge_V,experiment=run \\
    --map position=beta_deg:deg --joint joint.toml --out joint.toml
strainwave certify joint.toml --session session.toml --loads loads.csv --fluctuation run.csv \\
    --out certificate.html --pdf certificate.pdf
strainwave verify joint.toml --certificate certificate.html""")
