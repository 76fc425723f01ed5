"""The bindings: no copies, no arithmetic of their own, exact ratios, errors in words."""

import pathlib
import re
import tracemalloc
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import strainwave
from strainwave import (
    ConfigurationError,
    EncoderCounter,
    GaugeFluctuation,
    Gear,
    GearConfiguration,
    InputError,
    OscillatorFilter,
    OscillatorFilterConfig,
    Phase,
    Rational,
    Rosette,
    TorqueCalibration,
    _core,
)

PART = st.integers(1, 2**31 - 1)
PHASES = st.builds(Phase, st.integers(-(2**40), 2**40), st.integers(0, 2**32 - 1))


def units(phase):
    return (phase.turns << 32) + phase.fraction


@given(PHASES, PART, PART)
def test_order_fraction_is_exact(phase, numerator, denominator):
    order = Fraction(numerator, denominator)
    exact = units(phase) * order.numerator // order.denominator % 2**32
    assert phase.order_fraction(order) == exact


@pytest.mark.parametrize("ratio", [Fraction(100), Fraction(241, 2), Fraction(161)])
@given(turns=st.integers(0, 30 * 24 * 60 * 6000), fraction=st.integers(0, 2**32 - 1))
def test_misalignment_phase_within_thirty_days_at_6000_rpm(ratio, turns, fraction):
    output_turns = Fraction((turns << 32) + fraction, 2**32) / ratio
    exact = int(output_turns % 1 * 2**32)
    assert Phase(turns, fraction).order_fraction(1 / ratio) == exact


@given(PHASES, PHASES)
def test_phases_add_and_subtract_as_whole_numbers(a, b):
    assert units(a + b) == units(a) + units(b)
    assert units(a - b) == units(a) - units(b)


@given(st.floats(-1e5, 1e5))
def test_phase_of_an_angle_is_the_nearest(angle):
    turns = Fraction(angle / (2 * np.pi))  # the division is the double's own
    assert abs(Fraction(units(Phase.from_radians(angle)), 2**32) - turns) <= Fraction(1, 2**33)
    assert Phase.from_radians(angle).to_radians() == pytest.approx(angle, abs=8e-10)


@given(st.integers(-(2**62), 2**62), st.integers(1, 2**32 - 1))
def test_phase_of_counts_is_the_nearest(counts, per_turn):
    phase = Phase.from_counts(counts, per_turn)
    assert abs(Fraction(units(phase), 2**32) - Fraction(counts, per_turn)) <= Fraction(1, 2**33)


@given(st.lists(st.integers(-(2**31) + 1, 2**31 - 1), min_size=1, max_size=50))
def test_encoder_counter_extends_across_wraps(steps):
    counter = EncoderCounter()
    position = counter.update(0)
    for step in steps:
        position += step
        assert counter.update(position % 2**32) == position
    assert counter.counts == position


@given(PART, PART)
def test_fractions_come_back(numerator, denominator):
    value = Fraction(numerator, denominator)
    ratio = Rational(value)
    assert (ratio.numerator, ratio.denominator) == (value.numerator, value.denominator)
    assert float(ratio) == numerator / denominator
    assert hash(ratio) == hash(Rational(value))


@given(st.integers(1, 20_000), st.integers(1, 20_000))
def test_floats_become_the_ratio_they_were_meant_to_be(numerator, denominator):
    value = Fraction(numerator, denominator)
    ratio = Rational(numerator / denominator)
    assert Fraction(ratio.numerator, ratio.denominator) == value


@given(st.floats(1e-5, 1e5))
def test_floats_are_met_to_1e_12_where_a_ratio_is_that_near(value):
    try:
        ratio = Rational(value)
    except ConfigurationError:
        # 100.000000001 has none: what is nearer than 100 needs a numerator beyond 2^31.
        largest = 2**31 - 1
        best = Fraction(value).limit_denominator(min(largest, int(largest / value)))
        assert abs(best / Fraction(value) - 1) > 0.999e-12
        return
    assert abs(Fraction(ratio.numerator, ratio.denominator) / Fraction(value) - 1) < 1.001e-12


@given(st.floats(1e-12, 2e-8) | st.floats(1e7, 1e12))
def test_floats_far_out_are_met_or_refused(value):
    try:
        ratio = Rational(value)
    except ConfigurationError:
        return
    assert abs(Fraction(ratio.numerator, ratio.denominator) / Fraction(value) - 1) < 1.001e-12


def test_numbers_of_every_kind_are_ratios():
    for value in (241 / 2, Fraction(241, 2), np.float64(120.5), np.float32(120.5), Rational(120.5)):
        assert Rational(value) == Rational(Fraction(241, 2))
    assert Rational(np.int64(7)) == Rational(7)
    for wrong in (0, -1, 2**31, float("nan"), float("inf"), "100", 1j, Fraction(-1, 3)):
        with pytest.raises(ConfigurationError, match="expected a positive ratio of whole numbers"):
            Rational(wrong)


def test_results_that_fit_no_ratio_are_refused():
    with pytest.raises(InputError):
        _ = Rational(65537) * Rational(65537)
    with pytest.raises(InputError):
        strainwave.nominal_ratio(200, 200)
    with pytest.raises(InputError):
        _ = Gear(ratio=2**31 - 1).wave_factor


@pytest.mark.parametrize("ratio", [0, -100, 0.5, float("nan"), 2**31])
def test_gear_refuses_impossible_ratios(ratio):
    with pytest.raises(ConfigurationError, match="ratio = ") as caught:
        Gear(ratio=ratio)
    assert "\n" not in str(caught.value)


def test_gear_from_teeth_and_factor_m():
    gear = Gear.from_teeth(flexspline_teeth=200, circular_spline_teeth=202)
    assert gear.ratio == Rational(100)
    assert gear.output_direction == -1
    assert gear.wave_factor == Rational(Fraction(101, 100))
    fixed = GearConfiguration.fixed_flexspline
    gear = Gear.from_teeth(
        flexspline_teeth=100, circular_spline_teeth=102, configuration=fixed, rated_torque_Nm=100
    )
    assert gear.ratio == Rational(51)
    assert gear.output_direction == 1
    assert gear.wave_factor == Rational(1)
    with pytest.raises(ConfigurationError, match="circular_spline_teeth = "):
        Gear.from_teeth(flexspline_teeth=202, circular_spline_teeth=200)
    with pytest.raises(ConfigurationError, match="rated_torque_Nm = nan"):
        Gear(ratio=100, rated_torque_Nm=float("nan"))
    with pytest.raises(ConfigurationError, match="output_direction = 0"):
        Gear(ratio=100, output_direction=0)


def test_phase_refusals():
    for wrong in (float("nan"), float("inf"), 1e300):
        with pytest.raises(ConfigurationError, match="angle_rad = "):
            Phase.from_radians(wrong)
        with pytest.raises(ConfigurationError, match="turns = "):
            Phase.from_turns(wrong)
    with pytest.raises(ConfigurationError, match="counts_per_turn = 0"):
        Phase.from_counts(1, 0)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_contiguous_arrays_are_neither_copied_in_nor_out(dtype):
    n = 400_000
    torque = np.zeros(n, dtype)
    speed = np.ones(n, dtype)
    torque.flags.writeable = False
    ours = OscillatorFilter(OscillatorFilterConfig(orders=[2]), dtype=dtype)
    ours.process(torque[:10], motor_speed_rad_s=speed[:10])
    tracemalloc.start()
    try:
        result = ours.process(torque, motor_speed_rad_s=speed)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 50_000  # numpy reports its arrays to tracemalloc: a copy would be 1.6 MB
    for array in (result.torque_Nm, result.ripple_Nm, result.status):
        assert not array.flags.owndata  # the memory the core wrote, behind a capsule
        assert array.base is not None
        assert array.flags.writeable
        assert array.flags.c_contiguous


def test_results_outlive_the_filter():
    ours = OscillatorFilter(OscillatorFilterConfig(orders=[2]))
    ripple = ours.process(np.full(1000, 2.0), motor_speed_rad_s=np.full(1000, 9.0)).ripple_Nm
    kept = ripple.copy()
    del ours
    np.testing.assert_array_equal(ripple, kept)
    assert kept.any()


def test_a_filter_of_one_precision_refuses_the_other():
    single = _core.OscillatorFilter(OscillatorFilterConfig(orders=[2]), single_precision=True)
    ones = np.ones(5)
    with pytest.raises((InputError, TypeError)):
        single.process_float64(ones, ones, None, None)


def test_compiled_calls_convert_nothing_silently():
    double = _core.OscillatorFilter(OscillatorFilterConfig(orders=[2]))
    with pytest.raises(TypeError):
        double.process_float64(np.ones(5, np.float32), np.ones(5), None, None)
    with pytest.raises(TypeError):
        double.process_float64(np.ones(10)[::2], np.ones(5), None, None)


def test_calibration_against_numpy():
    c = [0.02, -0.03, 0.01, 0.004]
    calibration = TorqueCalibration(
        gain_Nm_per_V=6.6, zero_V=0.2, full_scale_Nm=40, linearisation=c, gain_drift_per_K=1e-3
    )
    volts = np.linspace(-7, 7, 201)
    temperature = np.linspace(-20, 80, 201)
    u = 6.6 * (1 + 1e-3 * (temperature - 20)) * (volts - 0.2) / 40
    expected = 40 * np.polynomial.polynomial.polyval(u, [0, 1, *c])
    np.testing.assert_allclose(calibration.torque_Nm(volts, temperature), expected, atol=1e-12)


def test_rosette_against_a_rotated_tensor():
    rng = np.random.default_rng(5)
    radial, circumferential, shear = 1e-4 * rng.standard_normal((3, 50))
    for error in (-0.3, 0.0, 0.02, 1.0):
        first, second = Rosette(orientation_error_rad=error).strain(radial, circumferential, shear)
        tensor = np.array([[radial, shear / 2], [shear / 2, circumferential]])
        for strain, angle in ((first, np.pi / 4 + error), (second, -np.pi / 4 + error)):
            rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            turned = np.einsum("ji,jkn,kl->iln", rotation, tensor, rotation)
            np.testing.assert_allclose(strain, turned[0, 0], rtol=0, atol=1e-18)


def test_signal_refuses_angles_that_are_none():
    gauge = GaugeFluctuation(amplitudes=[1.0], phase_errors_rad=[0.0])
    with pytest.raises(ConfigurationError, match=re.escape("motor_angle_rad[1] = nan rad")):
        gauge.signal(np.array([0.0, np.nan]))
    with pytest.raises(InputError, match="harmonic = 2"):
        gauge.phasor(2)
    with pytest.raises(InputError, match="phase_errors_rad has 1 elements"):
        GaugeFluctuation(amplitudes=[1.0, 2.0], phase_errors_rad=[0.0])
    with pytest.raises(ConfigurationError, match=re.escape("amplitudes[0] = inf")):
        GaugeFluctuation(amplitudes=[np.inf], phase_errors_rad=[0.0])
    with pytest.raises(InputError, match="gauge = 4"):
        strainwave.equally_spaced_position_rad(4, 3)


ROSETTE = Rosette()
CONVERTER = _core.Converter()
GAUGE = GaugeFluctuation(amplitudes=(1.0,), phase_errors_rad=np.zeros(1, np.float32))
CALIBRATION = TorqueCalibration(gain_Nm_per_V=2)
WIDE = np.arange(12, dtype=np.float32).reshape(3, 4)


@pytest.mark.parametrize(
    "call",
    [
        lambda form: ROSETTE.strain(form([1, 2]), form([3, 4]), form([5, 6])),
        lambda form: ROSETTE.half_bridge_V(form([1, 2]), form([3, 4]), np.float32(5)),
        lambda form: _core.full_bridge_V((ROSETTE, ROSETTE), form([[1, 2]]), form([[3, 4]]), 10),
        lambda form: _core.Amplifier(gain=2).amplified_V(form([1, 2])),
        lambda form: CONVERTER.to_code(form([1, 2])),
        lambda form: CONVERTER.to_volts(form([1, 2])),
        lambda form: CONVERTER.is_saturated(form([0, 2])),
        lambda form: CALIBRATION.torque_Nm(form([1, 2]), form([20, 30])),
        lambda form: GAUGE.signal(form([1, 2])),
        lambda form: _core.Gains(form([1, 2])).weighted_sum(form([[1, 2], [3, 4]])),
    ],
)
def test_array_likes_are_what_contiguous_arrays_are(call):
    expected = call(lambda values: np.array(values, np.float64))
    for form in (
        list,
        lambda values: np.array(values, np.float32),
        lambda values: np.array(values, np.int64),
        np.asfortranarray,
        lambda values: np.repeat(np.array(values, float), 2, axis=-1)[..., ::2],
    ):
        np.testing.assert_array_equal(call(form), expected)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: ROSETTE.strain(1.0, [2], [3]), "radial has the shape (): expected 1 axis"),
        (lambda: ROSETTE.strain([1], None, [3]), "circumferential holds object values"),
        (lambda: ROSETTE.strain([1], [2], [3, 4]), "shear has 2 elements: expected 1"),
        (lambda: ROSETTE.half_bridge_V([1], ["a"], 5), "second holds <U1 values"),
        (lambda: ROSETTE.half_bridge_V([1], [1], None), "supply_V = None: expected a number"),
        (lambda: ROSETTE.half_bridge_V([1], [1], np.nan), "supply_V = nan V: expected a finite"),
        (lambda: _core.full_bridge_V([1], WIDE, WIDE, 5), "rosettes is of type list: expected a"),
        (lambda: _core.full_bridge_V([ROSETTE] * 4, [1], WIDE, 5), "first has the shape (1,)"),
        (lambda: Rosette(radius_m="a"), "radius_m = 'a': expected a number"),
        (lambda: Rosette(radius_m=np.zeros(99)), "radius_m is of type ndarray: expected a number"),
        (lambda: Rosette(radius_m=10**5000), "radius_m is of type int: expected a number"),
        (lambda: Rosette(gauge_factor=0), "gauge_factor = 0.0: expected"),
        (lambda: _core.Amplifier(gain=None), "gain = None: expected a number"),
        (lambda: _core.Amplifier().amplified_V([[1]]), "input_V has the shape (1, 1)"),
        (lambda: _core.Converter(bits=-1), "bits = -1: expected a whole number, 1 to 24"),
        (lambda: _core.Converter(bits=16.5), "bits = 16.5: expected a whole number, 1 to 24"),
        (lambda: _core.Converter(bits=25), "bits = 25.0: expected 1 to 24"),
        (lambda: _core.Converter(lowest_code="a"), "lowest_code = 'a': expected a whole number"),
        (lambda: CONVERTER.to_code(WIDE), "input_V has the shape (3, 4)"),
        (lambda: CONVERTER.to_volts([0.5]), "codes holds values that are no whole numbers"),
        (lambda: CONVERTER.is_saturated([2**31]), "codes reaches from 2147483648"),
        (lambda: CALIBRATION.torque_Nm([1], 20), "temperature_degC has the shape ()"),
        (lambda: TorqueCalibration(gain_Nm_per_V="a"), "gain_Nm_per_V = 'a': expected a number"),
        (
            lambda: TorqueCalibration(gain_Nm_per_V=1, linearisation=[0.0] * 5),
            "linearisation has 5 elements: expected at most 4",
        ),
        (lambda: _core.Gains("ab"), "gains holds <U2 values: expected real numbers"),
        (lambda: _core.Gains([]), "gains has 0 elements: expected 1 to 32"),
        (lambda: _core.Gains([1, 2]).weighted_sum([1, 2]), "signals has the shape (2,)"),
        (lambda: _core.Gains([1, 2]).weighted_sum(WIDE), "signals' second axis has 4 elements"),
        (lambda: GAUGE.signal("a"), "motor_angle_rad holds <U1 values"),
        (lambda: GAUGE.phasor(-1), "harmonic = -1: expected a whole number"),
        (lambda: GAUGE.phasor(1.5), "harmonic = 1.5: expected a whole number"),
        (lambda: GAUGE.phasor(2), "harmonic = 2: expected 1 to 1"),
        (lambda: strainwave.equally_spaced_position_rad(1, 0), "count = 0: expected at least 1"),
        (lambda: strainwave.equally_spaced_position_rad(1, 2.5), "count = 2.5: expected a whole"),
        (
            lambda: GaugeFluctuation(amplitudes=[], phase_errors_rad=[]),
            "amplitudes has 0 elements: expected 1 to 16",
        ),
        (
            lambda: GaugeFluctuation(amplitudes=[1], phase_errors_rad=[0], position_rad=1e300),
            "position_rad = 1e+300 rad: expected a finite angle within",
        ),
    ],
)
def test_wrong_values_get_one_sentence(call, words):
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(words)
    assert "expected" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_defaults_of_the_stub_are_those_of_the_core():
    """Signatures that are written out, because None must reach the check that refuses it."""
    stub = pathlib.Path(_core.__file__).parent.joinpath("_core.pyi").read_text(encoding="utf-8")
    for part in (ROSETTE, _core.Amplifier(), CONVERTER, CALIBRATION):
        text = stub[stub.index(f"class {type(part).__name__}:") :]
        defaults = re.findall(r"(\w+): (?:float|int) = ([-\d.]+)", text[: text.index("-> None")])
        assert len(defaults) >= 3
        for name, value in defaults:
            assert getattr(part, name) == float(value)


def test_copies_are_independent():
    ours = OscillatorFilter(OscillatorFilterConfig(orders=[2]))
    twin = ours.copy()
    ours.process(np.ones(10), motor_speed_rad_s=np.ones(10))
    assert twin.counters["samples"] == 0


def test_bindings_hold_no_arithmetic():
    """No floating-point operator of theirs: what a binding computes, firmware would not."""
    folder = pathlib.Path(__file__).parents[2] / "bindings"
    sources = sorted(folder.glob("*.cpp"))
    assert len(sources) > 8
    arithmetic = re.compile(r"std::(sin|cos|sqrt|exp|pow|fmod|abs|fabs)\b|[-+*/]=? *\d+\.\d")
    for source in sources:
        code = re.sub(r'"(\\.|[^"\\])*"|//[^\n]*', "", source.read_text(encoding="utf-8"))
        assert not arithmetic.search(code), source.name
