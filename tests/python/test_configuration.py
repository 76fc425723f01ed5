"""A joint file's sensor is the one that is built by hand."""

from pathlib import Path

import numpy as np
import pytest

import strainwave as sw
from strainwave.configuration import (
    calibration_of,
    gear_of,
    oscillator_filter_of,
    sensor_of,
    verify,
)
from strainwave.errors import InputError
from strainwave.joint import Joint, parse_joint, read_joint

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


@pytest.mark.parametrize("build", [gear_of, oscillator_filter_of, calibration_of, sensor_of])
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
