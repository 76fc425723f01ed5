"""What a joint can be: its sections do not contradict each other."""

from typing import Any

import pytest
from pydantic import ValidationError

from helpers.joint_sections import OSCILLATOR, PROVENANCE, gauges, gear
from strainwave.joint import (
    SECTION_NAMES,
    Gains,
    Identity,
    Joint,
    Misalignment,
    MisalignmentTerm,
    OscillatorFilter,
    Signals,
    Temperature,
    TorqueCalibration,
    VoltageColumn,
)


def test_sections_that_need_the_gear() -> None:
    identity = Identity(name="elbow")
    ripple_filter = OscillatorFilter.model_validate(
        {**OSCILLATOR, "orders": ("1/R",), "provenance": PROVENANCE}
    )
    with pytest.raises(ValidationError, match=r'has the order "1/R".* no section \[gear\]'):
        Joint(joint=identity, ripple_filter=ripple_filter)
    calibration = TorqueCalibration(gain_Nm_per_V=6.6, linearisation=(0.01,), provenance=PROVENANCE)
    with pytest.raises(ValidationError, match=r"relative to the rated torque"):
        Joint(joint=identity, torque_calibration=calibration)
    straight = calibration.model_copy(update={"linearisation": ()})
    assert Joint(joint=identity, torque_calibration=straight).torque_calibration == straight


def test_gains_and_columns_are_as_many_as_channels() -> None:
    identity = Identity(name="elbow")
    gains = Gains(gains=(1.0, 1.0), provenance=PROVENANCE)
    columns = (VoltageColumn(column="g1", unit="V"), VoltageColumn(column="g2", unit="V"))
    signals = Signals(gauges=columns, provenance=PROVENANCE)
    assert Joint(joint=identity, gauges=gauges(2), gains=gains, signals=signals).gains == gains
    with pytest.raises(ValidationError, match=r"\[gains\] has 2 gains, but \[gauges\] has 3 ch"):
        Joint(joint=identity, gauges=gauges(3), gains=gains)
    with pytest.raises(ValidationError, match=r"has 2 gains, but \[gauges\] has 1 channel"):
        Joint(joint=identity, gauges=gauges(2, "full_bridge"), gains=gains)
    with pytest.raises(ValidationError, match="has 2 gauge columns"):
        Joint(joint=identity, gauges=gauges(3), signals=signals)


def test_converter_codes_need_the_converter() -> None:
    identity = Identity(name="elbow")
    signals = Signals(
        sensor_voltage=VoltageColumn(column="adc", unit="counts"), provenance=PROVENANCE
    )
    with pytest.raises(ValidationError, match="does not describe the converter"):
        Joint(joint=identity, gauges=gauges(2), signals=signals)
    converter: dict[str, Any] = {
        "converter_bits": 16,
        "converter_minimum_V": -5.0,
        "converter_maximum_V": 5.0,
    }
    described = gauges(2, **converter)
    assert Joint(joint=identity, gauges=described, signals=signals).gauges == described


def test_a_section_of_a_joint_has_its_provenance() -> None:
    bare = {
        "gear": gear(),
        "signals": Signals(),
        "gauges": gauges(1),
        "gains": Gains(gains=(1.0,)),
        "torque_calibration": TorqueCalibration(gain_Nm_per_V=1.0),
        "ripple_filter": OscillatorFilter.model_validate({**OSCILLATOR, "orders": (2,)}),
        "misalignment": Misalignment(
            terms=(MisalignmentTerm(cycles_per_output_turn=1, cosine_Nm=1.0, sine_Nm=0.0),)
        ),
        "temperature": Temperature(
            reference_temperature_degC=20.0, zero_drift_V_per_K=0.0, gain_drift_per_K=0.0
        ),
    }
    assert tuple(bare) == SECTION_NAMES
    for name, section in bare.items():
        without = section.model_copy(update={"provenance": None})
        with pytest.raises(ValidationError, match=rf"lacks the section \[{name}\.provenance\]"):
            Joint.model_validate({"joint": Identity(name="elbow"), name: without})
        with_it = section.model_copy(update={"provenance": PROVENANCE})
        joint = Joint.model_validate({"joint": Identity(name="elbow"), name: with_it})
        assert getattr(joint, name) == with_it
