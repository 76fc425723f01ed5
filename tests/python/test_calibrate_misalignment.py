"""Misalignment over the output's angle: what a fit finds, cannot tell, and says of itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.free_runs import (
    GRAVITY_NM,
    MAP,
    RATIO,
    made_up_run,
    station_columns,
    station_run,
)
from strainwave.calibrate.free_motion import FreeMotion, free_motion
from strainwave.calibrate.misalignment import check_map, fit_misalignment
from strainwave.calibrate.misalignment_design import Gravity
from strainwave.errors import InputError

PHASORS = {1: 2.0 - 1.0j, 2: 0.3 + 0.4j, 8: -0.15 + 0.1j}
NONE = Gravity(0.0)


def _motion(columns: dict[str, np.ndarray], mounting_rad: float = 0.0) -> FreeMotion:
    return free_motion(
        columns["t"],
        columns["q"],
        columns["tau"],
        ripple_angle_rad=RATIO * columns["q"],
        mounting_rad=mounting_rad,
    )


def _made_up(seed: int, phasors: Any = PHASORS, **more: Any) -> FreeMotion:
    return _motion(made_up_run(seed, phasors, **more), more.get("mounting_rad", 0.0))


def _complex(terms: Any) -> dict[int, complex]:
    return {each.cycles_per_output_turn: complex(each.cosine_Nm, each.sine_Nm) for each in terms}


def test_the_station_of_1999() -> None:
    """Simulated: gravity is told, and the map of one run removes that of another."""
    runs = [station_run(1), station_run(2, 0.8, 40.0)]
    motions = []
    for run in runs:
        columns = station_columns(run)
        motions.append(
            free_motion(
                columns["t"],
                columns["q"],
                columns["tau"],
                ripple_angle_rad=1.01 * columns["q_motor"],
            )
        )
    # The station reckons gravity in the motor's sense, 5 sin(-q), and so does the map's sine here.
    gravity = Gravity(GRAVITY_NM, -np.pi / 2)
    fit = fit_misalignment(motions[:1], gravity)
    found = _complex(fit.terms)
    assert set(found) == set(MAP)
    for n, (amplitude, phase) in MAP.items():
        wanted = amplitude * complex(np.sin(phase), np.cos(phase))
        # The station's own gain is not exactly its nominal one: 2 % of gravity is left in order 1.
        assert abs(found[n] - wanted) < (0.03 * GRAVITY_NM if n == 1 else 0.02)
    assert fit.others["inertia_kg_m2#0"][0] == pytest.approx(-2.0, rel=0.03)
    check = check_map(motions[1], fit.terms, gravity)
    assert 0.98 < check.share_removed < 1.0


def test_uncertainties_hold() -> None:
    """Errors over their standard uncertainties scatter by 1: chi-square of 40 seeds x 6 amplitudes."""
    ratios = []
    for seed in range(40):
        fit = fit_misalignment([_made_up(seed)], NONE, cycles=(1, 2, 8))
        for term in fit.terms:
            wanted = PHASORS[term.cycles_per_output_turn]
            ratios.append((term.cosine_Nm - wanted.real) / term.cosine_standard_uncertainty_Nm)
            ratios.append((term.sine_Nm - wanted.imag) / term.sine_standard_uncertainty_Nm)
    assert 0.8 < float(np.mean(np.square(ratios))) < 1.8


def test_only_cycles_with_evidence_are_taken() -> None:
    chosen = []
    for seed in range(15):
        fit = fit_misalignment([_made_up(seed)], NONE)
        chosen.append(tuple(term.cycles_per_output_turn for term in fit.terms))
    assert all({1, 2, 8} <= set(each) for each in chosen)
    # A pair of coefficients that are 0 passes Schwarz's limit by chance: exp(-ln n), 5 x 0.4 %.
    assert sum(len(each) - 3 for each in chosen) <= 3
    nothing = [fit_misalignment([_made_up(seed, {})], NONE).terms for seed in range(15)]
    assert sum(len(each) for each in nothing) <= 3


def test_gravity_is_not_taken_for_misalignment() -> None:
    columns = made_up_run(1, PHASORS, gravity_Nm=4.0 + 1.0j)
    motion = _motion(columns)
    fit = fit_misalignment([motion], "unknown")
    assert set(_complex(fit.terms)) == {2, 8}
    assert fit.once_a_turn is not None
    assert fit.once_a_turn.amplitude_Nm == pytest.approx(abs(PHASORS[1] + 4.0 + 1.0j), abs=0.05)
    told = fit_misalignment([motion], Gravity(abs(4.0 + 1.0j), float(np.angle(4.0 + 1.0j))))
    assert _complex(told.terms)[1] == pytest.approx(PHASORS[1], abs=0.05)
    with pytest.raises(InputError, match="gravity has one as well"):
        fit_misalignment([motion], "unknown", cycles=(1, 2))


def test_turned_housings_tell_gravity_from_misalignment() -> None:
    gravity = 4.0 + 1.0j
    runs = [
        _made_up(seed, gravity_Nm=gravity, mounting_rad=mounting)
        for seed, mounting in ((1, 0.0), (2, 1.5))
    ]
    fit = fit_misalignment(runs, "turned")
    assert _complex(fit.terms)[1] == pytest.approx(PHASORS[1], abs=0.05)
    assert fit.gravity is not None
    assert complex(fit.gravity.cosine_Nm, fit.gravity.sine_Nm) == pytest.approx(gravity, abs=0.05)
    alike = [
        _made_up(seed, gravity_Nm=gravity, mounting_rad=mounting)
        for seed, mounting in ((1, 0.0), (2, 0.005))
    ]
    with pytest.raises(InputError, match="housings are hardly turned"):
        fit_misalignment(alike, "turned", cycles=(1, 2, 8))


def test_a_part_of_a_turn() -> None:
    fit = fit_misalignment([_made_up(3, range_rad=4.5)], NONE, cycles=(1, 2))
    assert fit.lowest_output_angle_rad is not None
    assert fit.highest_output_angle_rad is not None
    assert -2.3 < fit.lowest_output_angle_rad < -1.8
    assert 1.8 < fit.highest_output_angle_rad < 2.3
    whole = fit_misalignment([_made_up(3)], NONE, cycles=(1, 2))
    assert whole.lowest_output_angle_rad is None
    with pytest.raises(InputError, match=r"cannot tell cycles 1, 2, 3, 4 .* only"):
        fit_misalignment([_made_up(3, range_rad=1.0)], NONE, cycles=(1, 2, 3, 4))


def test_direction_and_zero_of_the_angle() -> None:
    columns = made_up_run(4, PHASORS)
    straight = _complex(fit_misalignment([_motion(columns)], NONE, cycles=(1, 2, 8)).terms)
    moved = fit_misalignment([_motion(columns)], NONE, cycles=(1, 2, 8), zero_rad=0.7)
    for n, value in _complex(moved.terms).items():
        # a cos n(g + z) + b sin n(g + z), with g the angle less z.
        assert value == pytest.approx(straight[n] * np.exp(-1j * n * 0.7), abs=1e-6)
    columns["q"] = -columns["q"]
    turned = _complex(fit_misalignment([_motion(columns)], NONE, cycles=(1, 2, 8)).terms)
    for n, value in turned.items():
        assert value == pytest.approx(np.conj(straight[n]), abs=1e-6)


def test_a_late_torque_is_read_at_its_own_angle() -> None:
    columns = made_up_run(5, {8: 1.0 + 0.0j})
    late = {name: values[25:] for name, values in columns.items()}
    late["tau"] = columns["tau"][:-25]
    plain = fit_misalignment([_motion(late)], NONE, cycles=(8,)).terms[0]
    told = free_motion(
        late["t"], late["q"], late["tau"], ripple_angle_rad=RATIO * late["q"], delay_s=0.05
    )
    term = fit_misalignment([told], NONE, cycles=(8,)).terms[0]
    assert term.amplitude_Nm == pytest.approx(1.0, abs=0.02)
    assert plain.amplitude_Nm < 0.97


@settings(max_examples=15, deadline=None)
@given(
    st.floats(-5, 5), st.floats(-5, 5), st.floats(0.1, 10), st.floats(0, 3), st.integers(0, 2**31)
)
def test_what_else_acts_does_not_move_the_map(
    cosine: float, sine: float, inertia: float, coulomb: float, seed: int
) -> None:
    run = _made_up(
        seed, {2: complex(cosine, sine)}, inertia_kg_m2=inertia, coulomb_Nm=coulomb, noise_Nm=0.02
    )
    term = fit_misalignment([run], NONE, cycles=(2,)).terms[0]
    assert abs(complex(term.cosine_Nm, term.sine_Nm) - complex(cosine, sine)) < 0.05


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"t": slice(0, 300)}, "300 rows have time, angle and torque"),
        ({"nan": True}, "0 rows have time, angle and torque"),
        ({"still": True}, "0 rows are in motion"),
    ],
)
def test_bad_runs(change: dict[str, Any], words: str) -> None:
    columns = made_up_run(6, PHASORS)
    if "t" in change:
        columns = {name: values[change["t"]] for name, values in columns.items()}
    if "nan" in change:
        columns["tau"] = np.full_like(columns["tau"], np.nan)
    if "still" in change:
        columns["q"] = np.zeros_like(columns["q"])
    with pytest.raises(InputError, match=words):
        _motion(columns)


def test_bad_values() -> None:
    columns = made_up_run(7, PHASORS)
    with pytest.raises(InputError, match="torque_Nm has 3 elements"):
        free_motion(columns["t"], columns["q"], columns["tau"][:3])
    with pytest.raises(InputError, match="cycles 0, 2: expected whole numbers"):
        fit_misalignment([_motion(columns)], NONE, cycles=(0, 2))
    with pytest.raises(InputError, match="cycles 2, 2: expected whole numbers"):
        fit_misalignment([_motion(columns)], NONE, cycles=(2, 2))


def test_one_direction_is_said() -> None:
    columns = made_up_run(8, PHASORS)
    half = {name: values[:9500] for name, values in columns.items()}
    rows = np.diff(half["q"], append=half["q"][-1] - 1) < 0
    fit = fit_misalignment(
        [_motion({name: values[rows] for name, values in half.items()})], NONE, cycles=(1, 2, 8)
    )
    assert any("one direction only" in each for each in fit.says)
    assert abs(_complex(fit.terms)[2] - PHASORS[2]) < 0.1
