"""A joint file's sensor is the one that is built by hand."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import strainwave as sw
from helpers.joint_sections import OSCILLATOR, PROVENANCE
from strainwave.configuration import (
    calibration_of,
    gear_of,
    learned_of,
    oscillator_filter_of,
    ripple_filter_of,
    sensor_of,
    verify,
)
from strainwave.errors import InputError
from strainwave.joint import (
    Gear,
    Identity,
    Joint,
    Misalignment,
    MisalignmentTerm,
    OscillatorFilter,
    RippleFilter,
    parse_joint,
    read_joint,
)

SHOULDER = Path(__file__).parents[1] / "data" / "joints" / "shoulder.toml"
SHOULDER_TEXT = SHOULDER.read_text(encoding="utf-8")
ELBOW = Path(__file__).parents[1] / "data" / "joints" / "elbow.toml"
TEXT = ELBOW.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def joint() -> Joint:
    return read_joint(ELBOW).joint


def test_gear_has_the_sections_ratio_and_factor(joint: Joint) -> None:
    gear = gear_of(joint)
    assert joint.gear is not None
    assert float(gear.ratio) == joint.gear.ratio
    assert float(gear.wave_factor) == pytest.approx(joint.gear.factor_m, rel=1e-12)
    assert gear.output_direction == joint.gear.output_direction


def test_order_1_over_r_is_exact(joint: Joint) -> None:
    config = oscillator_filter_of(joint)
    assert joint.gear is not None
    assert [str(order) for order in config.orders] == ["2", "4", f"1/{joint.gear.ratio:.0f}"]


def test_chain_computes_what_the_sections_say(joint: Joint) -> None:
    sensor = sw.TorqueSensor(sensor_of(joint))
    gauges, gains = joint.gauges, joint.gains
    calibration, temperature = joint.torque_calibration, joint.temperature
    assert gauges is not None
    assert gains is not None
    assert calibration is not None
    assert temperature is not None
    assert joint.gear is not None
    assert gauges.converter_minimum_V is not None
    assert gauges.converter_maximum_V is not None
    rng = np.random.default_rng(4)
    codes = rng.integers(20000, 45000, (50, 3)).astype(np.int32)
    warm_degC = 31.0
    result = sensor.process(
        codes, motor_speed_rad_s=np.zeros(50), temperature_degC=np.full(50, warm_degC)
    )
    # The same by numpy, from the joint file's documentation.
    step_V = (gauges.converter_maximum_V - gauges.converter_minimum_V) / 2**16
    volts = (gauges.converter_minimum_V + codes * step_V) @ np.array(gains.gains)
    warmer = warm_degC - temperature.reference_temperature_degC
    zero = calibration.zero_V + temperature.zero_drift_V_per_K * warmer
    gain = calibration.gain_Nm_per_V * (1 + temperature.gain_drift_per_K * warmer)
    u = gain * (volts - zero)
    full_scale = joint.gear.rated_torque_Nm
    powers = [c * (u / full_scale) ** n for n, c in enumerate(calibration.linearisation, start=2)]
    expected = u + full_scale * np.sum(powers, axis=0)
    assert result.torque_measured_Nm == pytest.approx(expected, rel=1e-12)


def test_protection_is_the_filters_own_unless_the_file_says_otherwise(joint: Joint) -> None:
    own = sw.OscillatorFilterConfig(orders=[2])
    assert oscillator_filter_of(joint).minimum_travel_rad == own.minimum_travel_rad
    changed = TEXT.replace(
        "sample_period_s = 0.001", "sample_period_s = 0.001\nminimum_travel_rad = 0.02"
    )
    assert oscillator_filter_of(parse_joint(changed).joint).minimum_travel_rad == 0.02


@pytest.mark.parametrize(
    "build",
    [gear_of, oscillator_filter_of, ripple_filter_of, learned_of, calibration_of, sensor_of],
)
def test_a_missing_section_is_named(build) -> None:
    empty = parse_joint('schema_version = 1\n[joint]\nname = "bare"\n').joint
    with pytest.raises(InputError, match=r'joint "bare": there is no section \[\w+\]; expected'):
        build(empty)


def test_a_missing_converter_is_named() -> None:
    lines = [line for line in TEXT.splitlines() if not line.startswith("converter_")]
    with pytest.raises(InputError, match="no converter; expected converter_bits"):
        sensor_of(parse_joint("\n".join(lines)).joint)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("orders = [2, 4,", "orders = [2, 4000,", None),
        (
            "sample_period_s = 0.001",
            "sample_period_s = 0.001\nvariance_limit_ratio = 5.0",
            r"\[ripple_filter\] variance_limit_ratio = 5.0: expected 0 \(off\) or at least 100",
        ),
        (
            "[1.0586, 0.9966, 0.9448]",
            "[1.0, -1.0, 0.0]",
            r"\[gains\] gains = 0.0: expected a finite sum other than 0",
        ),
        (
            "measurement_noise_variance_Nm2 = 1.0",
            "measurement_noise_variance_Nm2 = 1e-35",
            r"\[ripple_filter\] measurement_noise_variance_Nm2",
        ),
        (
            "converter_bits = 16",
            "converter_bits = 16\nconverter_lowest_code = -5",
            r"\[gauges\] lowest_code = -5.0: expected 0 \(straight binary\) or",
        ),
    ],
)
def test_values_that_the_core_cannot_use_are_found(
    before: str, after: str, words: str | None
) -> None:
    assert before in TEXT
    if words is None:
        with pytest.raises(InputError):
            parse_joint(TEXT.replace(before, after))
        return
    with pytest.raises(InputError, match=words):
        verify(parse_joint(TEXT.replace(before, after)).joint)


def test_a_drift_that_turns_the_gain_around_is_found() -> None:
    line = next(line for line in TEXT.splitlines() if line.startswith("gain_drift_per_K"))
    with pytest.raises(InputError, match="leaves the gain its sign"):
        verify(parse_joint(TEXT.replace(line, "gain_drift_per_K = -0.5")).joint)


def test_the_documented_joint_can_be_used(joint: Joint) -> None:
    verify(joint)


@pytest.fixture(scope="module")
def shoulder() -> Joint:
    return read_joint(SHOULDER).joint


def test_ripple_filter_has_what_the_sections_say(shoulder: Joint) -> None:
    config = ripple_filter_of(shoulder)
    # Fixed circular spline with ratio 160: m = 161/160.
    assert [str(order.order) for order in config.orders] == ["1", "161/80", "161/40", "483/80"]
    assert [order.with_load for order in config.orders] == [False, True, False, False]
    assert [order.with_speed for order in config.orders] == [False] * 4
    assert [order.with_direction for order in config.orders] == [False, False, True, False]
    assert [order.keep for order in config.orders] == [True, False, False, False]
    assert config.memory_turns == 30.0
    assert config.torque_noise_Nm == 0.06
    assert config.torque_walk_Nm_per_sqrt_s == 1.5
    assert config.initial_amplitude_Nm == 3.0
    assert config.rated_torque_Nm == 118.0
    assert config.angle_to_torque_delay_s == 0.0031
    own = sw.RippleFilterConfig(orders=[2])
    assert config.reference_speed_rad_s == own.reference_speed_rad_s
    assert config.minimum_speed_rad_s == own.minimum_speed_rad_s
    assert [str(term.order) for term in config.frozen] == ["1/160", "1/80"]


def test_ripple_filter_takes_the_other_values_too() -> None:
    text = SHOULDER_TEXT.replace(
        "memory_turns = 30",
        "speed_orders = ['6m']\nmemory_turns = 30\nreference_speed_rad_s = 90\n"
        "minimum_speed_rad_s = 0",
    )
    # Up to what was learned, which belongs to the orders as they were.
    start, rest = text.index("initial_amplitude_Nm"), text.index("[ripple_filter.provenance]")
    joint = parse_joint(text[:start] + text[rest:]).joint
    config = ripple_filter_of(joint)
    assert [order.with_speed for order in config.orders] == [False, False, False, True]
    assert config.reference_speed_rad_s == 90.0
    assert config.minimum_speed_rad_s == 0.0
    assert config.initial_amplitude_Nm == sw.RippleFilterConfig(orders=[2]).initial_amplitude_Nm
    assert learned_of(joint) is None


def test_a_filter_starts_with_what_was_learned(shoulder: Joint) -> None:
    section = shoulder.ripple_filter
    assert isinstance(section, RippleFilter)
    learned = learned_of(shoulder)
    assert learned is not None
    assert section.learned_coefficients_Nm == tuple(learned.coefficients_Nm)
    assert section.learned_standard_deviations_Nm == tuple(learned.standard_deviations_Nm)
    assert section.learned_innovation_scale_Nm == learned.innovation_scale_Nm
    running = sw.RippleFilter(ripple_filter_of(shoulder), learned=learned)
    assert running.learned().coefficients_Nm == learned.coefficients_Nm
    amplitude_Nm, _ = running.order_ripple()
    assert amplitude_Nm[3] == pytest.approx(math.hypot(-0.08, 0.13), rel=1e-12)


def bare_ripple_joint(**sections: Any) -> Joint:
    ripple_filter = RippleFilter.model_validate(
        {
            "method": "ripple",
            "orders": (2.0,),
            "memory_turns": 30.0,
            "torque_noise_Nm": 0.05,
            "torque_walk_Nm_per_sqrt_s": 1.0,
            "provenance": PROVENANCE,
        }
    )
    return Joint.model_validate(
        {"joint": Identity(name="wrist"), "ripple_filter": ripple_filter, **sections}
    )


def misalignment(terms: tuple[MisalignmentTerm, ...], zero_rad: float = 0.0) -> Misalignment:
    return Misalignment(zero_of_output_angle_rad=zero_rad, terms=terms, provenance=PROVENANCE)


TERM = st.builds(
    MisalignmentTerm,
    cycles_per_output_turn=st.integers(1, 1000),
    cosine_Nm=st.floats(-20.0, 20.0),
    sine_Nm=st.floats(-20.0, 20.0),
)


@given(
    terms=st.lists(
        TERM, min_size=1, max_size=8, unique_by=lambda term: term.cycles_per_output_turn
    ),
    zero_rad=st.floats(-7.0, 7.0),
    ratio=st.sampled_from([30.0, 51.0, 120.5, 100.3, 160.0, 1000.0 / 7.0]),
    configuration=st.sampled_from(["fixed_circular_spline", "fixed_flexspline"]),
    direction=st.sampled_from([None, 1, -1]),
    motor_angle_rad=st.floats(-2000.0, 2000.0),
)
def test_misalignment_is_removed_at_standstill_as_the_section_defines_it(
    terms: list[MisalignmentTerm],
    zero_rad: float,
    ratio: float,
    configuration: str,
    direction: int | None,
    motor_angle_rad: float,
) -> None:
    values = {"configuration": configuration, "ratio": ratio, "rated_torque_Nm": 40.0}
    if direction is not None:
        values["output_direction"] = direction
    gear = Gear.model_validate({**values, "provenance": PROVENANCE})
    joint = bare_ripple_joint(gear=gear, misalignment=misalignment(tuple(terms), zero_rad))
    result = sw.RippleFilter(ripple_filter_of(joint)).process([0.0], [motor_angle_rad], [3.0])
    gamma = gear.output_direction * motor_angle_rad / ratio - zero_rad
    expected_Nm = sum(
        term.cosine_Nm * math.cos(term.cycles_per_output_turn * gamma)
        + term.sine_Nm * math.sin(term.cycles_per_output_turn * gamma)
        for term in terms
    )
    # The core's angle is a whole number of 2^-32 turns.
    assert result.ripple_Nm[0] == pytest.approx(expected_Nm, abs=2e-5)
    assert result.torque_Nm[0] == pytest.approx(3.0 - expected_Nm, abs=2e-5)


def test_misalignment_of_too_many_terms_is_refused() -> None:
    terms = tuple(
        MisalignmentTerm(cycles_per_output_turn=n, cosine_Nm=0.1, sine_Nm=0.0) for n in range(1, 10)
    )
    gear = Gear(
        configuration="fixed_flexspline", ratio=51, rated_torque_Nm=9, provenance=PROVENANCE
    )
    eight = bare_ripple_joint(gear=gear, misalignment=misalignment(terms[:8]))
    assert len(ripple_filter_of(eight).frozen) == 8
    nine = bare_ripple_joint(gear=gear, misalignment=misalignment(terms))
    with pytest.raises(InputError, match=r"\[misalignment\] has 9 terms; expected at most 8 for"):
        ripple_filter_of(nine)
    with pytest.raises(InputError, match=r"^\[ripple_filter\] joint \"wrist\": \[misalignment\]"):
        verify(nine)
    # Against the motor's angle it takes the ratio; a file that is still to be filled is no error.
    without_gear = bare_ripple_joint(misalignment=misalignment(terms[:1]))
    with pytest.raises(InputError, match=r"there is no section \[gear\]"):
        ripple_filter_of(without_gear)
    verify(without_gear)


def test_a_zero_beyond_all_measure_is_still_a_zero() -> None:
    term = MisalignmentTerm(cycles_per_output_turn=1000, cosine_Nm=3.0, sine_Nm=4.0)
    gear = Gear(
        configuration="fixed_flexspline", ratio=51, rated_torque_Nm=9, provenance=PROVENANCE
    )
    joint = bare_ripple_joint(gear=gear, misalignment=misalignment((term,), 1e308))
    (frozen,) = ripple_filter_of(joint).frozen
    assert math.hypot(frozen.cosine_Nm, frozen.sine_Nm) == pytest.approx(5.0, rel=1e-12)


@pytest.mark.parametrize("build", [ripple_filter_of, learned_of])
def test_the_ripple_filter_is_not_made_of_oscillators(build, joint: Joint) -> None:
    words = r'has method = "oscillator"; expected method = "ripple" for this filter, so fill'
    with pytest.raises(InputError, match=words):
        build(joint)


def test_the_oscillator_filter_is_not_made_of_the_ripple_filters_values(shoulder: Joint) -> None:
    words = (
        r'"shoulder": \[ripple_filter\] has method = "ripple"; expected method = "oscillator" for'
    )
    with pytest.raises(InputError, match=words):
        oscillator_filter_of(shoulder)


def test_oscillators_too_can_follow_the_factor_m() -> None:
    section = OscillatorFilter.model_validate(
        {**OSCILLATOR, "orders": ("2m", "4m"), "provenance": PROVENANCE}
    )
    gear = Gear(
        configuration="fixed_circular_spline", ratio=50, rated_torque_Nm=9, provenance=PROVENANCE
    )
    joint = Joint(joint=Identity(name="wrist"), gear=gear, ripple_filter=section)
    assert [str(order) for order in oscillator_filter_of(joint).orders] == ["51/25", "102/25"]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            "delay_s = 0.0031",
            "delay_s = 0.3",
            r"angle_to_torque_delay_s = 0\.3 s: .* 0\.05; correct this value in \[signals\], for",
        ),
        (
            "rated_torque_Nm = 118",
            "rated_torque_Nm = 1e12",
            r"rated_torque_Nm = .* from 1e-9 to 1e9; correct this value in \[gear\], for the ripple",
        ),
        ("cosine_Nm = 1.4", "cosine_Nm = 1e12", r"1e9; correct this value in \[misalignment\]"),
        ('"6m"]', '"999m"]', r"at most 1000"),
    ],
)
def test_values_that_the_ripple_filter_cannot_use_are_found(
    before: str, after: str, words: str
) -> None:
    verify(parse_joint(SHOULDER_TEXT).joint)
    assert before in SHOULDER_TEXT
    with pytest.raises(InputError, match=words) as caught:
        verify(parse_joint(SHOULDER_TEXT.replace(before, after)).joint)
    assert str(caught.value).startswith(("[ripple_filter] ", "[gear] "))
