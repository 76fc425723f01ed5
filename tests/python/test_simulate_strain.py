"""Strain, bridge and converter of a station against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import strainwave._core as core
from strainwave.errors import ConfigurationError, InputError
from strainwave.simulate import (
    Acquisition,
    Bridge,
    Flexspline,
    GaugePlacement,
    Load,
    MeshRipple,
    Misalignment,
    MisalignmentTerm,
    PiecewiseLinear,
    RippleOrder,
    Sine,
    Station,
    StrainField,
    Temperature,
    WaveHarmonic,
    constant_speed,
    godler2000,
)

FINE = core.Converter(bits=24, minimum_V=-10.0, maximum_V=10.0)
FIXED_FLEXSPLINE = core.GearConfiguration.fixed_flexspline


def station(gauge_count: int = 3, harmonics=(), **changes) -> Station:
    gauges = tuple(GaugePlacement(math.pi * j / gauge_count) for j in range(gauge_count))
    parts = {
        "gear": core.Gear(ratio=51, configuration=FIXED_FLEXSPLINE, rated_torque_Nm=40.0),
        "gauges": gauges,
        "strain_field": StrainField(0.6e-3, harmonics=harmonics),
        "flexspline": Flexspline(1e4),
        "load": Load(0.5),
        "bridge": Bridge(converter=FINE),
    }
    return Station(**(parts | changes))


def test_torsional_strain_is_that_of_a_tube():
    run = station().hold(PiecewiseLinear((0.0,), (30.0,)), 0.1, 1)
    shear = 30.0 / (2 * math.pi * 0.015**2 * 0.6e-3 * 79e9)
    np.testing.assert_allclose(run.truth.strain, shear, rtol=1e-12)
    volts = 2.0 / 4 * shear * 10.0 * 1000.0
    np.testing.assert_allclose(run.volts, volts, atol=0.6 * FINE.step_V)
    np.testing.assert_allclose(run.raw_torque_Nm, 30.0, atol=1e-3)


def test_full_bridge_answers_with_supply_times_gauge_factor_times_half_the_shear():
    """Taghirad & Belanger 1999, eq. (4): E_out = K epsilon_t E_sup, epsilon_t half the shear."""
    made = station(4, bridge=Bridge("full_bridge", converter=FINE))
    run = made.hold(PiecewiseLinear((0.0,), (30.0,)), 0.1, 1)
    assert run.codes.shape == (100, 1)
    epsilon_t = made.strain_field.shear_per_Nm(0.015) * 30.0 / 2
    np.testing.assert_allclose(run.volts, 2.0 * epsilon_t * 10.0 * 1000.0, atol=1e-5)
    np.testing.assert_allclose(run.raw_torque_Nm, 30.0, atol=1e-3)


def test_fluctuation_is_godlers_equation_six():
    """Godler et al. 2000, eq. (6), by the core's own evaluation of it."""
    run = (
        godler2000(3)
        .with_changes(acquisition=Acquisition())
        .rotate(constant_speed(6.0, 0.0), 1.0, 1)
    )
    truth = run.truth
    amplitudes = (18.9, 18.9 * 1.07, 18.9 * 1.15)
    for j, (amplitude, degrees) in enumerate(zip(amplitudes, (0.0, -1.5, -0.4), strict=True)):
        gauge = core.GaugeFluctuation(
            amplitudes=[amplitude],
            phase_errors_rad=[math.radians(degrees)],
            position_rad=core.equally_spaced_position_rad(j + 1, 3),
        )
        expected = gauge.signal(truth.motor_angle_rad)
        wave = 2 * truth.motor_angle_rad
        basis = np.stack([f(k * wave) for k in (1, 2) for f in (np.cos, np.sin)], axis=1)
        found = np.linalg.lstsq(basis, truth.fluctuation_Nm[:, j], rcond=None)[0]
        asked = np.linalg.lstsq(basis, expected, rcond=None)[0]
        np.testing.assert_allclose(found[:2], asked[:2], atol=1e-6)


def test_wave_passes_the_gauges_m_times_two_per_motor_turn():
    harmonic = (WaveHarmonic(2e-4),)
    for configuration, factor in (
        (FIXED_FLEXSPLINE, 1.0),
        (core.GearConfiguration.fixed_circular_spline, 51 / 50),
    ):
        gear = core.Gear(ratio=50, configuration=configuration, rated_torque_Nm=40.0)
        run = station(1, harmonic, gear=gear).rotate(constant_speed(40.0, 0.0), 20.0, 1)
        wave = run.truth.fluctuation_Nm[:, 0]
        phase = np.unwrap(np.angle(np.exp(1j * 2 * factor * run.truth.motor_angle_rad)))
        np.testing.assert_allclose(wave, np.max(wave) * np.sin(phase), atol=1e-3 * np.max(wave))


def test_equally_spaced_gauges_cancel_all_but_every_mth_harmonic():
    for count in (2, 3, 4, 5):
        for harmonic in range(1, 6):
            field = tuple(WaveHarmonic(1e-4 if i == harmonic else 0.0) for i in range(1, 6))
            run = station(count, field).rotate(constant_speed(20.0, 0.0), 1.0, 1)
            left = np.abs(run.truth.sensing_ripple_Nm).max()
            alone = np.abs(run.truth.fluctuation_Nm).max()
            if harmonic % count == 0:
                assert left == pytest.approx(count * alone, rel=1e-6)
            else:
                assert left < 1e-9 * alone


def test_orientation_error_lets_the_normal_strain_in():
    """Strain transformation: (e_r - e_c) sin(2 delta) joins the difference."""
    field = (WaveHarmonic(0.0, radial_strain=3e-4, circumferential_strain=-1e-4),)
    gauges = (GaugePlacement(0.0, orientation_error_rad=0.02), GaugePlacement(math.pi / 2))
    run = station(gauges=gauges, strain_field=StrainField(0.6e-3, harmonics=field)).rotate(
        constant_speed(20.0, 0.0), 1.0, 1
    )
    strain = run.truth.strain
    expected = -4e-4 * math.sin(0.04) * np.cos(2 * run.truth.motor_angle_rad)
    np.testing.assert_allclose(strain[:, 0], expected, atol=1e-12)
    np.testing.assert_allclose(strain[:, 1], 0.0, atol=1e-15)


def test_radius_error_changes_the_sensitivity_by_its_square():
    gauges = (GaugePlacement(0.0, radius_m=0.0153), GaugePlacement(math.pi / 2))
    run = station(gauges=gauges).hold(PiecewiseLinear((0.0,), (10.0,)), 0.1, 1)
    assert run.truth.strain[0, 0] / run.truth.strain[0, 1] == pytest.approx(1.02**-2, rel=1e-12)


def test_fluctuation_grows_with_load_and_speed_as_stated():
    field = (WaveHarmonic(1e-4, load_growth=0.5, speed_growth=0.2, load_phase_rad=0.3),)
    made = station(1, field)

    def phasor(speed_rad_s, load_Nm):
        run = made.rotate(
            constant_speed(speed_rad_s, 0.0), 1.0, 1, PiecewiseLinear((0.0,), (load_Nm,))
        )
        wave = 2 * run.truth.motor_angle_rad
        basis = np.stack([np.sin(wave), np.cos(wave)], axis=1)
        sine, cosine = np.linalg.lstsq(basis, run.truth.sensing_ripple_Nm, rcond=None)[0]
        return complex(sine, cosine)

    base = phasor(50.0, 0.0)
    assert abs(phasor(100.0, 0.0)) / abs(base) == pytest.approx(1.2 / 1.1, rel=1e-3)
    loaded = phasor(50.0, 40.0) / base
    assert abs(loaded) == pytest.approx(1.6 / 1.1, rel=1e-3)
    assert np.angle(loaded) == pytest.approx(0.3, abs=1e-3)
    assert np.angle(phasor(50.0, -40.0) / base) == pytest.approx(-0.3, abs=1e-3)


@pytest.mark.parametrize("torque_Nm", [-30.0, 12.0])
def test_uneven_torque_strain_is_a_share_of_the_torques_own(torque_Nm):
    field = (WaveHarmonic(0.0), WaveHarmonic(0.0, phase_rad=0.4, torque_share=0.05))
    made = station(2, field)
    angle = np.linspace(0.0, math.pi, 7)
    loaded = [made.hold(PiecewiseLinear((0.0,), (torque_Nm,)), 0.002, 1, each) for each in angle]
    read = np.array([run.truth.sensed_torque_Nm[0] for run in loaded])
    # Two gauges at 90 degrees both meet four cycles a turn in the same phase.
    np.testing.assert_allclose(read / torque_Nm, 1 + 0.05 * np.sin(4 * angle + 0.4), rtol=1e-12)
    unloaded = made.rotate(constant_speed(20.0, 0.0), 0.5, 1).truth.sensing_ripple_Nm
    np.testing.assert_array_equal(unloaded, 0.0)


def test_misalignment_repeats_with_the_output_and_is_not_transmitted():
    terms = (MisalignmentTerm(1.0, 5.0), MisalignmentTerm(4.0, 1.0))
    run = station(misalignment=Misalignment(terms)).rotate(
        constant_speed(2 * math.pi * 51, 0.0), 4.0, 1
    )
    spectrum = np.abs(np.fft.rfft(run.truth.misalignment_Nm)) * 2 / len(run.time_s)
    assert spectrum[4] == pytest.approx(5.0, rel=0.01)  # four output turns in four seconds
    assert spectrum[16] == pytest.approx(1.0, rel=0.02)
    np.testing.assert_allclose(run.truth.torque_Nm, 0.0, atol=1e-12)
    np.testing.assert_allclose(run.raw_torque_Nm, run.truth.misalignment_Nm, atol=1e-3)


def test_truth_parts_add_up_to_what_is_sensed():
    run = (
        godler2000(4)
        .with_changes(
            mesh_ripple=MeshRipple((RippleOrder(2.0, 1.5, load_growth=1.0),), 100.0),
            misalignment=Misalignment((MisalignmentTerm(2.0, 1.0),)),
        )
        .rotate(constant_speed(60.0, 0.2), 2.0, 3, Sine(50.0, 1.0))
    )
    truth = run.truth
    np.testing.assert_allclose(
        truth.torque_Nm, truth.torque_without_ripple_Nm + truth.mesh_ripple_Nm, atol=1e-12
    )
    np.testing.assert_allclose(truth.sensing_ripple_Nm, truth.fluctuation_Nm.sum(axis=1))
    parts = (
        truth.torque_Nm
        - truth.unsensed_hysteresis_Nm
        + truth.misalignment_Nm
        + truth.sensing_ripple_Nm
    )
    np.testing.assert_allclose(truth.sensed_torque_Nm, parts, atol=1e-9)
    error = run.raw_torque_Nm - truth.sensed_torque_Nm
    assert abs(error.mean()) < 0.01
    noise_Nm = 0.001 * math.sqrt(4) * run.sensor_gain_Nm_per_V
    assert error.std() == pytest.approx(noise_Nm, rel=0.1)


@given(first=st.floats(-40, 40), second=st.floats(-40, 40), angle=st.floats(-10, 10))
def test_torque_strains_superpose_on_the_wave(first, second, angle):
    """Without load dependence the field is linear in torque: strains of two loads add."""
    made = station(3, (WaveHarmonic(2e-4), WaveHarmonic(1e-5, phase_rad=0.4)))

    def strain(torque_Nm):
        run = made.hold(PiecewiseLinear((0.0,), (torque_Nm,)), 0.002, 1, angle)
        return run.truth.strain[0]

    np.testing.assert_allclose(
        strain(first + second), strain(first) + strain(second) - strain(0.0), atol=1e-15
    )


def test_temperature_drifts_zero_and_gain_as_stated():
    temperature = Temperature((0.0, 3.0), (5.0, 35.0), 20.0, (1e-6, 2e-6, 3e-6), 1e-3)
    made = station(temperature=temperature)
    shear = made.strain_field.shear_per_Nm(0.015) * 20.0
    run = made.hold(PiecewiseLinear((0.0,), (20.0,)), 3.0, 1)
    warmer = run.truth.temperature_degC - 20.0
    assert warmer[0] == pytest.approx(-15.0)
    assert warmer[-1] == pytest.approx(15.0, abs=0.02)
    for j in range(3):
        expected = shear * (1 + 1e-3 * warmer) + (j + 1) * 1e-6 * warmer
        np.testing.assert_allclose(run.truth.strain[:, j], expected, rtol=1e-12)
    np.testing.assert_array_equal(run.temperature_degC, run.truth.temperature_degC)


def test_quantisation_step_is_the_converters():
    bridge = Bridge(converter=core.Converter(bits=8, minimum_V=-10.0, maximum_V=10.0))
    run = station(bridge=bridge).hold(PiecewiseLinear((0.0, 1.0), (-30.0, 30.0)), 1.0, 1)
    steps = np.unique(np.diff(np.unique(run.volts[:, 0])))
    np.testing.assert_allclose(steps, 20.0 / 256)
    exact = run.truth.strain[:, 0] * 2.0 / 4 * 10.0 * 1000.0
    assert np.abs(run.volts[:, 0] - exact).max() <= 0.5001 * 20.0 / 256


def test_amplifier_ends_at_its_rails():
    bridge = Bridge(amplifier=core.Amplifier(gain=1000.0, rail_V=5.0), converter=FINE)
    run = station(bridge=bridge).hold(PiecewiseLinear((0.0, 1.0), (-300.0, 300.0)), 1.0, 1)
    assert run.volts.max() == pytest.approx(5.0, abs=1e-5)
    assert run.volts.min() == pytest.approx(-5.0, abs=1e-5)


@pytest.mark.parametrize(
    ("build", "parameter"),
    [
        (lambda: station(gauges=()), "gauges"),
        (lambda: station(1, bridge=Bridge("full_bridge")), "gauges"),
        (lambda: Bridge("quarter"), "wiring"),
        (lambda: Bridge(supply_V=0.0), "supply_V"),
        (lambda: GaugePlacement(0.0, radius_m=0.0), "radius_m"),
        (lambda: GaugePlacement(0.0, orientation_error_rad=1.0), "orientation_error_rad"),
        (lambda: GaugePlacement(math.nan), "position_rad"),
        (lambda: StrainField(-1.0), "thickness_m"),
        (lambda: StrainField(1e-3, bypassed_hysteresis=-0.1), "bypassed_hysteresis"),
        (lambda: WaveHarmonic(-1e-4), "shear_strain"),
        (lambda: station(gauges=(GaugePlacement(0.0, wave_scale=(1.0,)),)), "wave_scale"),
        (lambda: station(temperature=Temperature(zero_strain_per_K=(0.0,))), "zero_strain_per_K"),
        (lambda: Temperature(values_degC=(500.0,)), "values_degC"),
        (lambda: Temperature((0.0, 1.0), (20.0,)), "values_degC"),
        (lambda: Temperature(gain_per_K=1.0), "gain_per_K"),
        (lambda: MisalignmentTerm(0.0, 1.0), "cycles_per_output_turn"),
        (lambda: station().hold(PiecewiseLinear((0.0,), (1.0,)), 0.0, 1), "duration_s"),
        (lambda: station().hold(PiecewiseLinear((0.0,), (1.0,)), 1.0, -1), "seed"),
        (
            lambda: station().hold(PiecewiseLinear((0.0,), (1.0,)), 1.0, 1, math.inf),
            "position_rad",
        ),
        (lambda: WaveHarmonic(0.0, torque_share=-0.1), "torque_share"),
        (lambda: WaveHarmonic(0.0, torque_share=1.1), "torque_share"),
    ],
)
def test_impossible_station_is_refused_by_name(build, parameter):
    with pytest.raises(ConfigurationError) as caught:
        build()
    assert caught.value.parameter == parameter


def test_the_cores_own_parts_refuse_by_themselves():
    with pytest.raises(InputError, match="gain"):
        Bridge(amplifier=core.Amplifier(gain=math.nan))
