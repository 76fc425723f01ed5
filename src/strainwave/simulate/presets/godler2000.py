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
three (what makes +-2 %FS of the published amplitudes and phases); placement errors of the first two
builds; phases and load dependence of the harmonics, hysteresis and what passes by the gauges, to
match the linearity; the diaphragm, mechanics, noise, converter and encoders.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import strainwave._core as core
from strainwave.errors import ConfigurationError
from strainwave.simulate.acquisition import Acquisition, Encoder
from strainwave.simulate.driving import constant_speed, up_and_down
from strainwave.simulate.loading import LoadingExperiment, load_by_weights
from strainwave.simulate.mechanics import Flexspline, Friction, Load, Motor
from strainwave.simulate.results import Run
from strainwave.simulate.station import Bridge, Station
from strainwave.simulate.strain_field import GaugePlacement, StrainField, WaveHarmonic
from strainwave.simulate.temperature import Temperature

RATED_TORQUE_NM = 100.0
GAUGE_RADIUS_M = 0.022
THICKNESS_M = 0.7e-3
SHEAR_MODULUS_PA = 79e9
TURN_SPEED_RAD_S = 2 * math.pi
"""One turn of the input shaft in a second: slow enough that inertia plays no part."""


@dataclass(frozen=True)
class _Harmonic:
    """Harmonic of one build: amplitude in the sum of all gauges, %FS, and its load dependence."""

    amplitude_percent: float
    phase_rad: float = 0.0
    load_growth: float = 0.0
    load_phase_rad: float = 0.0


@dataclass(frozen=True)
class _Build:
    """What differs between the three gears."""

    ratio: int
    configuration: core.GearConfiguration
    harmonics: tuple[_Harmonic, ...]
    scales: tuple[tuple[float, ...], ...]
    phase_errors_deg: tuple[tuple[float, ...], ...]
    torsional_softening: float
    bypassed_hysteresis: float
    standstill_rad: float


def _build(gauges: int) -> _Build:
    if gauges == 2:
        return _Build(
            ratio=50,
            configuration=core.GearConfiguration.fixed_circular_spline,
            harmonics=(_Harmonic(39.0, 0.0, 0.1, 0.05), _Harmonic(1.95, 0.9, 0.85, 0.5)),
            scales=((1.0, 1.0), (1.008, 0.97)),
            phase_errors_deg=((0.0, 0.0), (0.5, 6.0)),
            torsional_softening=0.0,
            bypassed_hysteresis=0.35,
            standstill_rad=0.2,
        )
    if gauges == 4:
        return _Build(
            ratio=50,
            configuration=core.GearConfiguration.fixed_circular_spline,
            harmonics=(_Harmonic(20.0, 0.0, 0.1, 0.05), _Harmonic(1.0, 0.9, 0.8, 0.5)),
            scales=((1.0, 1.0), (1.03, 1.03), (0.975, 0.98), (1.015, 1.0)),
            phase_errors_deg=((0.0, 0.0), (1.6, 3.0), (-1.2, -4.0), (1.3, 2.0)),
            torsional_softening=0.0,
            bypassed_hysteresis=0.12,
            standstill_rad=0.2,
        )
    if gauges == 3:
        # Higher harmonics do not follow the placement errors: the meshing teeth make them.
        return _Build(
            ratio=51,
            configuration=core.GearConfiguration.fixed_flexspline,
            harmonics=(_Harmonic(18.9, 0.0, 0.1, 0.05), _Harmonic(0.945, 0.9, 0.8, 0.5)),
            scales=((1.0, 1.0), (1.07, 1.07), (1.15, 0.96)),
            phase_errors_deg=((0.0, 0.0), (-1.5, 3.0), (-0.4, -4.0)),
            torsional_softening=0.0,
            bypassed_hysteresis=0.4,
            standstill_rad=0.2,
        )
    raise ConfigurationError("gauges", gauges, "gauges", "2, 3 or 4, the paper's three builds,")


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
    shear_per_Nm = 1.0 / (2 * math.pi * GAUGE_RADIUS_M**2 * THICKNESS_M * SHEAR_MODULUS_PA)
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
            harmonics=tuple(
                WaveHarmonic(
                    percent * harmonic.amplitude_percent,
                    phase_rad=harmonic.phase_rad,
                    load_growth=harmonic.load_growth,
                    load_phase_rad=harmonic.load_phase_rad,
                )
                for harmonic in build.harmonics
            ),
            torsional_softening=build.torsional_softening,
            bypassed_hysteresis=build.bypassed_hysteresis,
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
        position_rad=_build(gauges).standstill_rad,
    )
