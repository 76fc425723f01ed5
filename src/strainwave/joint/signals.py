"""The section ``[signals]``: how a recording of this joint is read."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from strainwave.joint.base import FilePart, Line, ListOf, Unit, refuse_boolean
from strainwave.joint.provenance import Section
from strainwave.units import check_unit

AngleSide = Literal["motor", "output"]


def _check_column(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise ValueError("expected the name of the column, or its number counted from 1")
    if isinstance(value, int) and not 1 <= value <= 1_000_000:
        raise ValueError("expected the number of the column, counted from 1")
    return value


class Column(FilePart):
    """One column of a recording."""

    column: Annotated[int | Line, BeforeValidator(_check_column)] = Field(
        description="Name of the column, or its number counted from 1 where the recording has "
        "no names"
    )
    unit: str = Field(description="Unit of the column; which ones are allowed depends on the row")
    sign: Annotated[Literal[1, -1], BeforeValidator(refuse_boolean), Unit("1")] = Field(
        default=1, description="-1 where the column counts against this joint's positive direction"
    )


class TimeColumn(Column):
    """A column of times."""

    unit: Annotated[str, AfterValidator(partial(check_unit, "time"))] = Field(
        description="Unit of the column, one of time"
    )


class AngleColumn(Column):
    """A column of angles."""

    unit: Annotated[str, AfterValidator(partial(check_unit, "angle"))] = Field(
        description="Unit of the column, one of angle"
    )


class SpeedColumn(Column):
    """A column of angular speeds."""

    unit: Annotated[str, AfterValidator(partial(check_unit, "speed"))] = Field(
        description="Unit of the column, one of speed"
    )


class TorqueColumn(Column):
    """A column of torques at the output."""

    unit: Annotated[str, AfterValidator(partial(check_unit, "torque"))] = Field(
        description="Unit of the column, one of torque"
    )


class VoltageColumn(Column):
    """A column of voltages or converter codes."""

    unit: Annotated[str, AfterValidator(partial(check_unit, "voltage"))] = Field(
        description="Unit of the column, one of voltage"
    )


class TemperatureColumn(Column):
    """A column of temperatures."""

    unit: Annotated[str, AfterValidator(partial(check_unit, "temperature"))] = Field(
        description="Unit of the column, one of temperature"
    )


def _side_of(values: dict[str, Any]) -> AngleSide:
    only_output = values.get("motor_angle") is None and values.get("output_angle") is not None
    return "output" if only_output else "motor"


class Signals(Section):
    """Columns, units and timing of a recording of this joint."""

    time: TimeColumn | None = Field(default=None, description="Time stamps")
    motor_angle: AngleColumn | None = Field(
        default=None, description="Angle of the motor, that is of the wave generator"
    )
    output_angle: AngleColumn | None = Field(default=None, description="Angle of the joint")
    angle_side: AngleSide = Field(
        default_factory=_side_of,
        description="The angle that the wave generator's angle is taken from; where left out, "
        "`motor`, or `output` if there is only an output angle",
    )
    motor_speed: SpeedColumn | None = Field(default=None, description="Speed of the motor")
    output_speed: SpeedColumn | None = Field(default=None, description="Speed of the joint")
    torque: TorqueColumn | None = Field(
        default=None, description="Torque at the output as the joint's own sensor reports it"
    )
    sensor_voltage: VoltageColumn | None = Field(
        default=None, description="Sum of the gauges after the amplifier, before calibration"
    )
    expected_torque: TorqueColumn | None = Field(
        default=None, description="Torque expected from a model or measured by a reference sensor"
    )
    temperature: TemperatureColumn | None = Field(
        default=None, description="Temperature of the flexspline"
    )
    gauges: ListOf[VoltageColumn] = Field(
        default=(), description="One column for each gauge, in the order of gauges.rosettes"
    )
    sampling_rate_Hz: Annotated[float, Unit("Hz")] | None = Field(
        default=None, gt=0.0, le=1e9, description="Nominal rate of the rows"
    )
    angle_to_torque_delay_s: Annotated[float, Unit("s")] | None = Field(
        default=None,
        ge=-1.0,
        le=1.0,
        description="Time by which the torque (or gauge) columns lag the angle column; positive "
        "where the torque comes later",
    )
    load_inertia_kg_m2: Annotated[float, Unit("kg m^2")] | None = Field(
        default=None,
        gt=0.0,
        description="Moment of inertia at the output; times the output's acceleration it is the "
        "expected torque in free motion",
    )

    @model_validator(mode="after")
    def _angle_side_is_there(self) -> Signals:
        angles = {"motor": self.motor_angle, "output": self.output_angle}
        if angles[self.angle_side] is None and any(angles.values()):
            raise ValueError(
                f'has angle_side = "{self.angle_side}", but no {self.angle_side}_angle; add that '
                "column or change angle_side"
            )
        return self
