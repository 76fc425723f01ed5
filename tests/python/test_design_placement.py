"""Placement errors: against the core's rosette, the simulated strain field and closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave import _core
from strainwave.calibrate.fluctuation import compensation_conditions, equally_spaced_positions_rad
from strainwave.design.case import LayoutCase
from strainwave.design.placement import (
    GaugeErrors,
    Tolerances,
    Wave,
    draw_errors,
    gauge_signals,
)
from strainwave.design.sensitivity import Sensitivity, sensitivities
from strainwave.simulate.strain_field import (
    FieldInputs,
    GaugePlacement,
    StrainField,
    WaveHarmonic,
    strain_at,
)

ANGLE_RAD = np.linspace(0.0, 2 * np.pi, 64, endpoint=False)
RADIUS_M = 0.022


def simulated(field: StrainField, gauge: GaugePlacement, torque_Nm: float) -> np.ndarray:
    """Signal of a gauge over one turn, from the simulator's strain and the core's rosette."""
    ones = np.ones_like(ANGLE_RAD)
    strain = strain_at(field, gauge, FieldInputs(ANGLE_RAD, 0 * ones, torque_Nm * ones, 0 * ones))
    rosette = _core.Rosette(
        position_rad=gauge.position_rad,
        radius_m=gauge.radius_m,
        orientation_error_rad=gauge.orientation_error_rad,
        gauge_factor=gauge.gauge_factor,
    )
    first, second = rosette.strain(
        strain.radial, strain.circumferential, strain.wave_shear + strain.torsional
    )
    return np.asarray(rosette.half_bridge_V(first, second, 10.0))


def test_signals_are_those_of_the_simulated_station() -> None:
    amplitudes_FS = (56.7, 2.8)
    field = StrainField(
        thickness_m=0.7e-3,
        rated_torque_Nm=100.0,
        harmonics=tuple(
            WaveHarmonic(
                shear_strain=1e-6 * a,
                radial_strain=0.9e-6 * a,
                circumferential_strain=-0.4e-6 * a,
            )
            for a in amplitudes_FS
        ),
    )
    ideal = GaugePlacement(0.0, radius_m=RADIUS_M)
    no_wave = replace(field, harmonics=())
    rated_V = simulated(no_wave, ideal, 100.0)[0]
    volts_per_strain = 2.0 / 4 * 10.0
    percent = 100 * volts_per_strain * 1e-6 / rated_V

    generator = np.random.default_rng(5)
    errors = draw_errors(
        generator,
        Tolerances(3.0, 0.1, 5.0, 0.02, 0.5, 4.0),
        1e3 * RADIUS_M,
        (1, 2, 4),
    )
    # The simulated wave does not change with the radius.
    wave = Wave(tuple(percent * a for a in amplitudes_FS), 1.3, radius_exponent=0.0)
    torque, phasors = gauge_signals(wave, errors)
    for j, position in enumerate(equally_spaced_positions_rad(4)):
        gauge = GaugePlacement(
            position + errors.position_rad[0, j],
            radius_m=RADIUS_M * (1 + errors.radius[0, j]),
            orientation_error_rad=errors.orientation_rad[0, j],
            gauge_factor=2.0 * (1 + errors.gauge_factor[0, j]),
            wave_scale=tuple(1 + errors.amplitude[0, :, j]),
            wave_phase_error_rad=tuple(errors.phase_rad[0, :, j]),
        )
        assert simulated(no_wave, gauge, 100.0)[0] / rated_V == pytest.approx(torque[0, j])
        signal = 100 * simulated(field, gauge, 0.0) / rated_V
        for i in (1, 2):
            expected = 2 * np.mean(signal * np.exp(-2j * i * ANGLE_RAD)) * 1j
            assert phasors[0, i - 1, j] == pytest.approx(expected, rel=1e-6)


def test_phasors_are_the_solver_s_conditions() -> None:
    errors = GaugeErrors.none(1, 3, 5)
    errors.position_rad[:] = [[0.01, -0.02, 0.03, 0.0, -0.01]]
    wave = Wave((10.0, 2.0, 0.5))
    _, phasors = gauge_signals(wave, errors)
    orders = 2 * np.arange(1, 4)[:, np.newaxis]
    matrix = compensation_conditions(
        np.repeat(np.array(wave.amplitudes_FS)[:, np.newaxis], 5, axis=1),
        orders * errors.position_rad,
        equally_spaced_positions_rad(5),
    )
    assert phasors[0].real == pytest.approx(matrix[0::2], abs=1e-6)
    assert phasors[0].imag == pytest.approx(matrix[1::2], abs=1e-6)


def row(case: LayoutCase, error: str, per: str) -> Sensitivity:
    return next(each for each in sensitivities(case) if (each.error, each.per) == (error, per))


@pytest.mark.parametrize("gauges", [2, 3, 4, 8])
def test_sensitivities_in_closed_form(gauges: int) -> None:
    """First order: a d/M, with d the phasor's relative change."""
    wave = Wave((60.0,), normal_strain_ratio=0.7, radius_exponent=1.5)
    case = LayoutCase(gauges, 1, wave=wave, radius_mm=20.0)
    each_FS = 60.0 / gauges
    degree = np.deg2rad(1.0)

    radial = row(case, "radial", "0.1 mm")
    assert radial.gauge_torque_percent == pytest.approx(100 * (1.005**-2 - 1))
    assert radial.ripple_FS[0] == pytest.approx(each_FS * 1.5 * 0.005, rel=1e-3)
    around = row(case, "circumferential", "1 deg")
    assert around.gauge_torque_percent == pytest.approx(0.0, abs=1e-12)
    assert around.ripple_FS[0] == pytest.approx(each_FS * 2 * degree, rel=1e-3)
    assert row(case, "circumferential", "0.1 mm").ripple_FS[0] == pytest.approx(
        each_FS * 2 * 0.1 / 20.0, rel=1e-3
    )
    angular = row(case, "angular", "1 deg")
    assert angular.gauge_torque_percent == pytest.approx(100 * (np.cos(2 * degree) - 1))
    assert angular.sum_torque_percent == pytest.approx(
        angular.gauge_torque_percent / gauges, rel=1e-6
    )
    assert angular.ripple_FS[0] == pytest.approx(each_FS * 2 * degree * 0.7, rel=1e-3)
    assert row(case, "gauge factor", "1 %").sum_torque_percent == pytest.approx(1.0 / gauges)
    assert row(case, "gauge factor", "1 %").ripple_FS[0] == pytest.approx(each_FS / 100, rel=1e-3)
    assert row(case, "amplitude", "1 %").ripple_FS[0] == pytest.approx(each_FS / 100, rel=1e-3)


def test_what_the_paper_says_of_the_three_errors() -> None:
    """Taghirad & Belanger 1999, section III: circumferential more than radial, angular similar."""
    case = LayoutCase(4, 1)
    around = row(case, "circumferential", "0.1 mm").ripple_FS[0]
    assert around > 1.5 * row(case, "radial", "0.1 mm").ripple_FS[0]
    ratio = (
        row(case, "angular", "1 deg").ripple_FS[0]
        / row(case, "circumferential", "1 deg").ripple_FS[0]
    )
    assert 0.8 < ratio < 1.25


def test_a_gauge_factor_does_not_move_what_looks_like_torque() -> None:
    # Harmonic M of M gauges counts like torque: a gauge factor changes both alike.
    case = LayoutCase(3, 1, wave=Wave((50.0, 0.0, 5.0)))
    assert row(case, "gauge factor", "1 %").ripple_FS[2] == pytest.approx(0.0, abs=1e-6)
    assert row(case, "amplitude", "1 %").ripple_FS[2] == pytest.approx(0.05 / 3, rel=1e-3)


@settings(max_examples=40, deadline=None)
@given(
    gauges=st.integers(2, 9),
    position_rad=st.floats(-0.5, 0.5),
    orientation_rad=st.floats(-0.7, 0.7),
    radius=st.floats(-0.5, 0.5),
)
def test_errors_common_to_all_gauges_leave_nothing(
    gauges: int, position_rad: float, orientation_rad: float, radius: float
) -> None:
    """Turned or widened as a whole, a layout still cancels what equal spacing cancels."""
    errors = GaugeErrors.none(1, 1, gauges)
    errors.position_rad[:] = position_rad
    errors.orientation_rad[:] = orientation_rad
    errors.radius[:] = radius
    _, phasors = gauge_signals(Wave((50.0,)), errors)
    assert abs(phasors.sum()) < 1e-9


def test_drawn_errors_have_their_deviations() -> None:
    tolerances = Tolerances(2.0, 0.1, 7.0, 0.03, 0.4, 1.5)
    errors = draw_errors(np.random.default_rng(1), tolerances, 20.0, (20_000, 2, 3))
    found = (
        np.rad2deg(errors.position_rad.std()),
        errors.amplitude.std(),
        np.rad2deg(errors.phase_rad.std()),
        errors.gauge_factor.std(),
        20.0 * errors.radius.std(),
        np.rad2deg(errors.orientation_rad.std()),
    )
    assert found == pytest.approx((2.0, 0.1, 7.0, 0.03, 0.4, 1.5), rel=0.015)
    # Each gauge, and each harmonic, has its own.
    both = np.corrcoef(errors.amplitude.reshape(len(errors.amplitude), -1).T)
    assert np.abs(both - np.eye(6)).max() < 0.03
