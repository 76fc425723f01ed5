"""The three gears of Godler, Horiuchi, Hashimoto & Ninomiya 2000, simulated.

From the paper: rated torque 100 Nm; builds of two and of four gauges with the circular spline fixed
and ratio 50, of three gauges at 60 degrees with the flexspline fixed and ratio 51; every gauge a
crossed pair in a half bridge; harmonics 1 and 2 of the fluctuation at 20:1 (section II.B); of the
third build amplitudes 1 : 1.07 : 1.15 and phase errors 0 : -1.5 : -0.4 degrees in harmonic 1.
What the sum of the gauges leaves is the paper's result and is what these stations were matched to:
+-4 %FS mostly at the double frequency with two gauges (fig. 3), +-1 %FS at the basic frequency with
four (fig. 6), +-2 %FS with three (fig. 9), +-0.2 %FS of higher frequencies once harmonic 1 is
compensated (fig. 10); linearity error with hysteresis +-2 %FS, +-0.5 %FS and below 2 %FS, the last
between the others (figs. 4, 7, 11).

Chosen, because the paper does not give it: wave amplitudes of 39 %FS in the sum of two gauges
(fig. 3 shows a compensation of about ten times), the same strain for four gauges, 18.9 %FS for
three (what makes +-2 %FS of the published amplitudes and phases); errors of the first two builds;
the diaphragm, mechanics, noise, converter and encoders.  Every gauge is given its amplitude and its
phase error psi, as the paper prints them for the third build, and no misplacement.

Linearity is put in; the paper names no cause.  But for the third build's smaller wave, all builds
have one flexspline.  The same share of its hysteresis torque, `BYPASSED_HYSTERESIS`, passes by the
gauges and makes +-0.5 %FS in each.  The rest is the wave under load: its second harmonic grows, the
torque's own strain is uneven around the flexspline by 5 % in the second harmonic and 2.5 % in the
third, and both shift with torsion.  Two gauges leave the second harmonic, three the third, four
neither.  `STANDSTILL_RAD` is where this comes to the paper's figures; at other angles two gauges
have +-0.8 to +-2.0 %FS and three +-0.5 to +-1.2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import strainwave._core as core
from strainwave.simulate.acquisition import Acquisition, Encoder
from strainwave.simulate.checks import require_integer
from strainwave.simulate.driving import constant_speed, up_and_down
from strainwave.simulate.loading import LoadingExperiment, load_by_weights
from strainwave.simulate.mechanics import Flexspline, Friction, Load, Motor
from strainwave.simulate.results import Run
from strainwave.simulate.station import Bridge, Station
from strainwave.simulate.strain_field import (
    GaugePlacement,
    StrainField,
    WaveHarmonic,
    tube_shear_per_Nm,
)
from strainwave.simulate.temperature import Temperature

RATED_TORQUE_NM = 100.0
GAUGE_RADIUS_M = 0.022
THICKNESS_M = 0.7e-3
SHEAR_MODULUS_PA = 79e9
TURN_SPEED_RAD_S = 2 * math.pi
"""One turn of the input shaft in a second: slow enough that inertia plays no part."""

BYPASSED_HYSTERESIS = 0.11
HARMONIC_PHASES_RAD = (0.0, -0.3, -0.9)
LOAD_GROWTHS = (0.1, 0.8, 0.0)
LOAD_PHASES_RAD = (0.05, 0.6, 0.6)
TORQUE_SHARES = (0.0, 0.05, 0.025)
"""Of harmonics 1, 2 and 3 of the one flexspline; how it takes load is the same for all builds."""
STANDSTILL_RAD = 0.2
"""Where the wave generator stands under the weights: where linearity comes to the paper's."""


@dataclass(frozen=True)
class _Build:
    """What differs between the three gears; harmonics in the inner tuples.

    wave_percent is the first harmonic's amplitude of one gauge in the sum of all, %FS.
    """

    ratio: int
    configuration: core.GearConfiguration
    wave_percent: float
    scales: tuple[tuple[float, float, float], ...]
    phase_errors_deg: tuple[tuple[float, float, float], ...]


_BUILDS = {
    2: _Build(
        ratio=50,
        configuration=core.GearConfiguration.fixed_circular_spline,
        wave_percent=39.0,
        scales=((1.0, 1.0, 1.0), (1.008, 0.97, 1.0)),
        phase_errors_deg=((0.0, 0.0, 0.0), (0.5, 6.0, 0.0)),
    ),
    4: _Build(
        ratio=50,
        configuration=core.GearConfiguration.fixed_circular_spline,
        wave_percent=19.5,
        scales=((1.0, 1.0, 1.0), (1.035, 1.03, 1.0), (0.97, 0.98, 1.0), (1.015, 1.0, 1.0)),
        phase_errors_deg=((0.0, 0.0, 0.0), (1.6, 3.0, 0.0), (-1.2, -4.0, 0.0), (1.3, 2.0, 0.0)),
    ),
    # Higher harmonics do not follow the placement errors: the meshing teeth make them.
    3: _Build(
        ratio=51,
        configuration=core.GearConfiguration.fixed_flexspline,
        wave_percent=18.9,
        scales=((1.0, 1.0, 1.0), (1.07, 1.07, 1.0), (1.15, 0.96, 1.0)),
        phase_errors_deg=((0.0, 0.0, 0.0), (-1.5, 3.0, 0.0), (-0.4, -4.0, 0.0)),
    ),
}


def _build(gauges: int) -> _Build:
    require_integer("gauges", gauges, "", minimum=min(_BUILDS), maximum=max(_BUILDS))
    return _BUILDS[gauges]


def _harmonics(build: _Build, percent: float) -> tuple[WaveHarmonic, ...]:
    """Harmonics 1 and 2 at 20:1; the third is there under load alone."""
    amplitudes = (build.wave_percent, build.wave_percent / 20.0, 0.0)
    return tuple(
        WaveHarmonic(
            percent * amplitude,
            phase_rad=phase_rad,
            load_growth=load_growth,
            load_phase_rad=load_phase_rad,
            torque_share=torque_share,
        )
        for amplitude, phase_rad, load_growth, load_phase_rad, torque_share in zip(
            amplitudes,
            HARMONIC_PHASES_RAD,
            LOAD_GROWTHS,
            LOAD_PHASES_RAD,
            TORQUE_SHARES,
            strict=True,
        )
    )


def godler2000(gauges: int) -> Station:
    """Return one of the three gears of Godler et al. 2000, simulated.

    What of it is the paper's and what was chosen is said at the head of this module.

    Parameters
    ----------
    gauges : int
        2 or 4: circular spline fixed, ratio 50; 3: at 60 degrees, flexspline fixed, ratio 51.

    Returns
    -------
    Station
        The station; every gauge has a channel of its own.
    """
    build = _build(gauges)
    shear_per_Nm = tube_shear_per_Nm(GAUGE_RADIUS_M, THICKNESS_M, SHEAR_MODULUS_PA)
    # In the sum of M gauges torque counts M times, one gauge's fluctuation once.
    percent = gauges * RATED_TORQUE_NM * shear_per_Nm / 100
    return Station(
        gear=core.Gear(
            ratio=build.ratio,
            configuration=build.configuration,
            rated_torque_Nm=RATED_TORQUE_NM,
        ),
        gauges=tuple(
            GaugePlacement(
                position_rad=math.pi * j / gauges,
                radius_m=GAUGE_RADIUS_M,
                wave_scale=build.scales[j],
                wave_phase_error_rad=tuple(math.radians(d) for d in build.phase_errors_deg[j]),
            )
            for j in range(gauges)
        ),
        strain_field=StrainField(
            thickness_m=THICKNESS_M,
            shear_modulus_Pa=SHEAR_MODULUS_PA,
            rated_torque_Nm=RATED_TORQUE_NM,
            harmonics=_harmonics(build, percent),
            bypassed_hysteresis=BYPASSED_HYSTERESIS,
        ),
        motor=Motor(
            torque_constant_Nm_per_A=0.1,
            torque_limit_Nm=2.5,
            inertia_kg_m2=2e-4,
            friction=Friction(coulomb_Nm=0.03, viscous_Nm_s_per_rad=2e-4),
        ),
        flexspline=Flexspline(
            stiffness_Nm_per_rad=2.5e4,
            hardening_Nm_per_rad3=2e8,
            damping_Nm_s_per_rad=30.0,
            hysteresis_Nm=3.0,
            hysteresis_stiffness_Nm_per_rad=6e3,
        ),
        load=Load(inertia_kg_m2=0.5, bearing_friction_Nm=0.1),
        bridge=Bridge(
            wiring="half_bridge_each",
            supply_V=10.0,
            amplifier=core.Amplifier(gain=1000.0),
            converter=core.Converter(bits=16, minimum_V=-10.0, maximum_V=10.0),
        ),
        temperature=Temperature(zero_strain_per_K=2e-7, gain_per_K=2e-4),
        acquisition=Acquisition(rate_Hz=1000.0, noise_V=0.001),
        motor_encoder=Encoder(4096),
        output_encoder=Encoder(8192),
    )


def one_turn(gauges: int, seed: int) -> Run:
    """Simulate one turn of the input shaft without load: figures 3, 6 and 9.

    Parameters
    ----------
    gauges : int
        2, 3 or 4.
    seed : int
        Seed of everything random.

    Returns
    -------
    Run
        Recording and truth.
    """
    turn = constant_speed(TURN_SPEED_RAD_S, 0.0)
    return godler2000(gauges).rotate(turn, 2 * math.pi / TURN_SPEED_RAD_S, seed)


def linearity_experiment(gauges: int, seed: int) -> LoadingExperiment:
    """Simulate loading at standstill up to +-100 Nm: figures 4, 7 and 11.

    Parameters
    ----------
    gauges : int
        2, 3 or 4.
    seed : int
        Seed of everything random.

    Returns
    -------
    LoadingExperiment
        Increasing and decreasing weights in both directions and the first direction once more, so
        that the whole hysteresis loop is closed.
    """
    there_and_back = up_and_down(RATED_TORQUE_NM, 10, both_directions=True)[1:]
    return load_by_weights(
        godler2000(gauges),
        there_and_back + up_and_down(RATED_TORQUE_NM, 10)[1:11],
        seed,
        position_rad=STANDSTILL_RAD,
    )
