"""What a joint can be: physics of the gear, consistency inside each section."""

import math
from fractions import Fraction
from typing import Any

import pytest
from pydantic import ValidationError

from helpers.joint_sections import OSCILLATOR, PROVENANCE, gauges, gear
from strainwave.joint import (
    SECTION_MODELS,
    SECTION_NAMES,
    AngleColumn,
    Gains,
    GainsWithoutGauge,
    GaugeSignal,
    Gear,
    Identity,
    Joint,
    Misalignment,
    MisalignmentTerm,
    OscillatorFilter,
    RippleFilter,
    Signals,
    Temperature,
    TorqueCalibration,
    conversion,
    order_value,
)


def test_sections_are_those_of_the_signals_way() -> None:
    assert SECTION_NAMES == (
        "gear",
        "signals",
        "gauges",
        "gains",
        "torque_calibration",
        "ripple_filter",
        "misalignment",
        "temperature",
    )
    assert SECTION_MODELS["gear"] == (Gear,)
    assert SECTION_MODELS["ripple_filter"] == (OscillatorFilter, RippleFilter)
    assert SECTION_MODELS["temperature"] == (Temperature,)


def test_factor_m_is_the_relative_turn_of_wave_generator_and_flexspline() -> None:
    # Fixed circular spline: one motor turn moves the flexspline back by 1/R.
    assert gear(50.0).factor_m == 1.0 + 1.0 / 50.0
    fixed_flexspline = Gear(configuration="fixed_flexspline", ratio=51.0, rated_torque_Nm=100.0)
    assert fixed_flexspline.factor_m == 1.0
    identified = fixed_flexspline.model_copy(update={"identified_factor_m": 1.003})
    assert identified.factor_m == 1.003


@pytest.mark.parametrize(
    ("configuration", "direction"), [("fixed_circular_spline", -1), ("fixed_flexspline", 1)]
)
def test_output_direction_follows_from_the_configuration(
    configuration: str, direction: int
) -> None:
    values = {"configuration": configuration, "ratio": 100.0, "rated_torque_Nm": 40.0}
    assert Gear.model_validate(values).output_direction == direction
    reversed_gear = Gear.model_validate({**values, "output_direction": -direction})
    assert reversed_gear.output_direction == -direction


@pytest.mark.parametrize(
    ("configuration", "ratio"), [("fixed_circular_spline", 50.0), ("fixed_flexspline", 51.0)]
)
def test_teeth_give_the_ratio(configuration: str, ratio: float) -> None:
    values = {
        "configuration": configuration,
        "rated_torque_Nm": 100.0,
        "flexspline_teeth": 100,
        "circular_spline_teeth": 102,
    }
    assert Gear.model_validate({**values, "ratio": ratio}).ratio == ratio
    with pytest.raises(ValidationError, match=rf"give {ratio:g}; correct the one that is wrong"):
        Gear.model_validate({**values, "ratio": ratio * (1.0 + 2e-6)})


@pytest.mark.parametrize(
    ("teeth", "message"),
    [
        ({"flexspline_teeth": 200}, "add circular_spline_teeth"),
        ({"circular_spline_teeth": 202}, "add flexspline_teeth"),
        ({"flexspline_teeth": 202, "circular_spline_teeth": 200}, "were swapped"),
        ({"flexspline_teeth": 200, "circular_spline_teeth": 200}, "more teeth on the circular"),
    ],
)
def test_teeth_that_cannot_be(teeth: dict[str, int], message: str) -> None:
    values = {"configuration": "fixed_circular_spline", "ratio": 100.0, "rated_torque_Nm": 40.0}
    with pytest.raises(ValidationError, match=message):
        Gear.model_validate({**values, **teeth})


def test_models_cannot_be_changed() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        gear().ratio = 3.0  # type: ignore[misc]


def test_angle_side_follows_the_angle_that_is_there() -> None:
    column = AngleColumn(column="q", unit="rad")
    assert Signals().angle_side == "motor"
    assert Signals(motor_angle=column, output_angle=column).angle_side == "motor"
    assert Signals(output_angle=column).angle_side == "output"
    with pytest.raises(ValidationError, match="no motor_angle; add that column"):
        Signals(output_angle=column, angle_side="motor")


def test_full_bridge_is_one_channel_of_paired_rosettes() -> None:
    assert gauges(4, "full_bridge").channel_count == 1
    assert gauges(3).channel_count == 3
    with pytest.raises(ValidationError, match="an even number"):
        gauges(3, "full_bridge")


@pytest.mark.parametrize(
    ("converter", "message"),
    [
        ({"converter_bits": 16}, "without converter_minimum_V and converter_maximum_V"),
        (
            {"converter_bits": 16, "converter_minimum_V": 5.0, "converter_maximum_V": -5.0},
            "were swapped",
        ),
    ],
)
def test_converter_is_described_whole(converter: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        gauges(3, **converter)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"gains": (0.0, 0.0)}, "no gain other than 0"),
        ({"gains": (1.0, 1.0), "torque_sensitivities": (1.0,)}, "2 gains but 1 torque_sens"),
        ({"gains": (1.0, 1.0), "harmonics": (1, 1)}, "different whole numbers from 1"),
        ({"gains": (1.0, 1.0), "harmonics": (0,)}, "different whole numbers from 1"),
    ],
)
def test_gains_that_cannot_be(values: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Gains.model_validate(values)


def test_gains_for_a_lost_gauge() -> None:
    lost = GainsWithoutGauge(gauge=2, gains=(1.4, 0.0, 1.6))
    assert Gains(gains=(1.0, 1.0, 1.0), without_gauge=(lost,)).without_gauge[0].gains[1] == 0.0
    with pytest.raises(ValidationError, match=r"gives the failed gauge 1 the gain 1\.4"):
        GainsWithoutGauge(gauge=1, gains=(1.4, 0.0, 1.6))
    with pytest.raises(ValidationError, match="expected a gauge from 1 to 3"):
        GainsWithoutGauge(gauge=4, gains=(1.4, 0.0, 1.6))
    with pytest.raises(ValidationError, match="two entries of without_gauge for one gauge"):
        Gains(gains=(1.0, 1.0, 1.0), without_gauge=(lost, lost))
    with pytest.raises(ValidationError, match="4 gains but 3 in the entry"):
        Gains(gains=(1.0, 1.0, 1.0, 1.0), without_gauge=(lost,))


def test_signals_of_the_gauges_are_as_many() -> None:
    one = GaugeSignal(zero_V=0.1, amplitudes_V=(1.0,), phases_rad=(0.5,))
    assert Gains(gains=(1.0, 1.0), gauge_signals=(one, one)).gauge_signals == (one, one)
    with pytest.raises(ValidationError, match="2 gains but 1 gauge_signals"):
        Gains(gains=(1.0, 1.0), gauge_signals=(one,))
    with pytest.raises(ValidationError, match="1 amplitudes_V but 2 phases_rad"):
        GaugeSignal(zero_V=0.1, amplitudes_V=(1.0,), phases_rad=(0.5, 0.2))
    two = GaugeSignal(zero_V=0.1, amplitudes_V=(1.0, 0.1), phases_rad=(0.5, 0.2))
    with pytest.raises(ValidationError, match="different numbers of harmonics"):
        Gains(gains=(1.0, 1.0), gauge_signals=(one, two))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"gain_Nm_per_V": 0.0}, "other than 0"),
        ({"gain_Nm_per_V": 1.0, "lowest_torque_Nm": 1.0}, "one end of the calibrated range"),
        (
            {"gain_Nm_per_V": 1.0, "lowest_torque_Nm": 1.0, "highest_torque_Nm": 1.0},
            "were swapped",
        ),
    ],
)
def test_torque_calibration_that_cannot_be(values: dict[str, float], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        TorqueCalibration.model_validate(values)


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"lowest_temperature_degC": 5.0}, "one end of the temperature range"),
        ({"lowest_temperature_degC": 35.0, "highest_temperature_degC": 5.0}, "were swapped"),
    ],
)
def test_temperature_range_that_cannot_be(limits: dict[str, float], message: str) -> None:
    drift = {"reference_temperature_degC": 20.0, "zero_drift_V_per_K": 0.0, "gain_drift_per_K": 0.0}
    with pytest.raises(ValidationError, match=message):
        Temperature.model_validate({**drift, **limits})


def test_misalignment_terms_differ() -> None:
    term = MisalignmentTerm(cycles_per_output_turn=2, cosine_Nm=0.1, sine_Nm=0.2)
    with pytest.raises(ValidationError, match="two terms with cycles_per_output_turn = 2"):
        Misalignment(terms=(term, term))


def test_orders() -> None:
    assert order_value(2, None) == 2.0
    assert order_value("1/100", None) == Fraction(1, 100)
    assert order_value("2/R", gear(120.5)) == Fraction(4, 241)
    # Fixed circular spline: m = (R + 1) / R, exactly.
    assert order_value("2m", gear(120.5)) == 2 * Fraction(243, 241)
    fixed_flexspline = Gear(configuration="fixed_flexspline", ratio=51.0, rated_torque_Nm=100.0)
    assert order_value("4m", fixed_flexspline) == 4
    identified = fixed_flexspline.model_copy(update={"identified_factor_m": 1.25})
    assert order_value("2m", identified) == Fraction(5, 2)
    for given_by_the_gear in ("1/R", "2m"):
        with pytest.raises(ValueError, match="needs the gear"):
            order_value(given_by_the_gear, None)
    wrong_ones = ("R", "m", "0m", "2.0m", "2 m", "-2m", "0/1", "1/0", "1.5/3", "1/R ", -2, 0)
    for wrong in (*wrong_ones, True, math.inf, math.nan):
        with pytest.raises(ValueError, match="expected a number of cycles per motor turn above 0"):
            order_value(wrong, gear())


@pytest.mark.parametrize("ratio", [1.0, 50.0, 100.3, 1e6])
def test_the_exact_factor_m_is_the_factor_m(ratio: float) -> None:
    assert float(gear(ratio).exact_factor_m) == pytest.approx(gear(ratio).factor_m, rel=1e-15)


def test_an_order_is_there_once() -> None:
    with pytest.raises(ValidationError, match="the order 2/50 twice"):
        OscillatorFilter.model_validate({**OSCILLATOR, "orders": ("1/25", 2.0, "2/50")})
    ripple_filter = OscillatorFilter.model_validate(
        {**OSCILLATOR, "orders": ("1/100", "1/R"), "provenance": PROVENANCE}
    )
    identity = Identity(name="elbow")
    assert Joint(joint=identity, gear=gear(101.0), ripple_filter=ripple_filter).gear == gear(101.0)
    with pytest.raises(ValidationError, match="the order 1/R twice in orders, for the ratio 100 "):
        Joint(joint=identity, gear=gear(100.0), ripple_filter=ripple_filter)


@pytest.mark.parametrize(
    ("quantity", "unit", "raw", "expected"),
    [
        ("time", "us", 2_500_000.0, 2.5),
        ("angle", "deg", 180.0, math.pi),
        ("angle", "counts/16777216", 8388608.0, math.pi),
        ("speed", "turn/min", 60.0, 2.0 * math.pi),
        ("speed", "counts/4096/s", 4096.0, 2.0 * math.pi),
        ("torque", "mNm", 1500.0, 1.5),
        ("voltage", "uV", 1e6, 1.0),
        ("temperature", "K", 273.15, 0.0),
        ("temperature", "degF", 212.0, 100.0),
    ],
)
def test_units_convert(quantity: str, unit: str, raw: float, expected: float) -> None:
    rule = conversion(quantity, unit)  # type: ignore[arg-type]
    assert rule is not None
    assert raw * rule.factor + rule.offset == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_units_that_do_not_fit() -> None:
    assert conversion("voltage", "counts") is None
    for quantity, unit in (("angle", "counts"), ("angle", "counts/0"), ("time", "rad")):
        with pytest.raises(ValueError, match=f"expected a unit of {quantity}: "):
            conversion(quantity, unit)  # type: ignore[arg-type]
