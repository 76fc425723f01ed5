"""How a recording is to be read: the options, and the joint file where they are silent."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal, TypeVar

from strainwave.errors import InputError
from strainwave.records.mapping import MappedColumn, gauge_key, is_gauge_key
from strainwave.records.options import AngleSide, Options, check_options
from strainwave.records.sensor_chain import SensorChain, build_chain

if TYPE_CHECKING:
    from collections.abc import Mapping

    from strainwave.joint import Joint
    from strainwave.joint.signals import Column, Signals

RatedTorqueSource = Literal["option", "joint file", "estimated"]
Value = TypeVar("Value")


@dataclass(frozen=True)
class Layout:
    """How a recording is read.

    Attributes
    ----------
    columns : dict
        What is read, by key: either ``angle`` or ``speed``, ``torque``, and where there is one
        ``time`` and ``expected-torque``.
    angle_side : {"motor", "output"}
        The side that angle and speed were measured on.
    ratio : Fraction or None
        Motor turns per output turn; known where `angle_side` is "output".
    rate_Hz : float or None
        Rate of the rows where there is no column of time, Hz.
    rated_torque_Nm : float or None
        Full scale, Nm; None where it is to be estimated.
    rated_torque_source : {"option", "joint file", "estimated"}
        Where the full scale comes from.
    load_inertia_kg_m2 : float or None
        Inertia at the output that stands in for a column of expected torque, kg m^2.
    output_direction : int
        Sense of the output's rotation for positive motor rotation, 1 or -1.
    remarks : tuple of str
        What a person should know of how this came about.
    chain : SensorChain or None
        From the mapped gauges to torque; None where the torque itself is mapped.
    """

    columns: dict[str, MappedColumn]
    angle_side: AngleSide
    ratio: Fraction | None = None
    rate_Hz: float | None = None
    rated_torque_Nm: float | None = None
    rated_torque_source: RatedTorqueSource = "estimated"
    load_inertia_kg_m2: float | None = None
    output_direction: int = 1
    remarks: tuple[str, ...] = ()
    chain: SensorChain | None = None

    @property
    def motor_turns_per_turn(self) -> float:
        """Turns of the motor for one turn of the side that was measured."""
        if self.angle_side == "motor":
            return 1.0
        assert self.ratio is not None
        return float(self.ratio)


def build_layout(options: Options, joint: Joint | None = None) -> Layout:
    """Bring options and joint file together; an option wins, and that is said.

    Parameters
    ----------
    options : Options
        What was asked for.
    joint : Joint, optional
        What is known of the joint.

    Returns
    -------
    Layout
        How the recording is read.

    Raises
    ------
    InputError
        If something needed is missing, or a number is out of range.
    """
    check_options(options)
    return _Merge(options, joint).layout()


class _Merge:
    def __init__(self, options: Options, joint: Joint | None) -> None:
        self.options = options
        self.joint = joint
        self.signals: Signals | None = None if joint is None else joint.signals
        self.gear = None if joint is None else joint.gear
        self.remarks: list[str] = []

    def layout(self) -> Layout:
        ratio = self.chosen("--ratio", self.options.ratio, self._joint_ratio())
        side = "motor" if "motor-angle" in self.options.mapping else self.side()
        columns = self.columns(side)
        has_gauges = any(is_gauge_key(key) for key in columns)
        chain = build_chain(self.joint, columns) if has_gauges else None
        if side == "output" and ratio is None:
            raise InputError(
                "--ratio: it is missing; an angle of the output needs the motor turns per output "
                "turn, so add --ratio N or a [gear] in the joint file"
            )
        if "time" in columns and self.options.rate_Hz is not None:
            self.remarks.append(
                f"--rate {self.options.rate_Hz:g} is not used: the recording has a column of time"
            )
        joint_rate = None if self.signals is None else self.signals.sampling_rate_Hz
        rate = None
        if "time" not in columns:
            rate = self.chosen("--rate", self.options.rate_Hz, joint_rate)
            if rate is None:
                raise InputError(
                    "--map: nothing is mapped for time; expected time=COLUMN, or --rate HZ where "
                    "the recording has no time stamps"
                )
        joint_rated = None if self.gear is None else self.gear.rated_torque_Nm
        rated = self.chosen("--rated-torque", self.options.rated_torque_Nm, joint_rated)
        source: RatedTorqueSource = "estimated"
        if rated is not None:
            source = "joint file" if self.options.rated_torque_Nm is None else "option"
        return Layout(
            columns,
            side,
            ratio,
            rate,
            rated,
            source,
            self.inertia(columns, side, ratio),
            1 if self.gear is None else self.gear.output_direction,
            tuple(self.remarks),
            chain,
        )

    def chosen(self, name: str, option: Value | None, in_joint: Value | None) -> Value | None:
        if option is None:
            return in_joint
        if in_joint is not None and in_joint != option:
            self.remarks.append(
                f"{name} {_shown(option)} is used instead of {_shown(in_joint)} in the joint file"
            )
        return option

    def _joint_ratio(self) -> Fraction | None:
        if self.gear is None:
            return None
        flexspline, circular = self.gear.flexspline_teeth, self.gear.circular_spline_teeth
        if flexspline is not None and circular is not None:
            fixed_circular = self.gear.configuration == "fixed_circular_spline"
            return Fraction(flexspline if fixed_circular else circular, circular - flexspline)
        # Of its decimal digits: 80.4 is 402/5 and not the float next to it.
        return Fraction(repr(self.gear.ratio))

    def side(self) -> AngleSide:
        in_joint: AngleSide | None = None
        if self.signals is not None:
            signals = self.signals
            speeds = (signals.motor_speed, signals.output_speed)
            if (
                "angle_side" in signals.model_fields_set
                or signals.motor_angle
                or (signals.output_angle)
            ):
                in_joint = signals.angle_side
            elif any(speeds):
                in_joint = "motor" if signals.motor_speed else "output"
        side: AngleSide | None = self.chosen("--angle-side", self.options.angle_side, in_joint)
        if side is None:
            raise InputError(
                "--angle-side: it is missing; expected motor or output, the side that the angle "
                "was measured on"
            )
        return side

    def columns(self, side: AngleSide) -> dict[str, MappedColumn]:
        in_joint = {} if self.signals is None else _joint_columns(self.signals, side)
        given = self.options.mapping
        if "speed" in given and "angle" not in given and "angle" in in_joint:
            self.remarks.append("the mapped speed is used instead of the angle in the joint file")
            del in_joint["angle"]
        given = self.motor_angle_first(given, side)
        if any(is_gauge_key(key) for key in given):
            # Other columns than the joint file's, and perhaps another number of them.
            in_joint = {key: each for key, each in in_joint.items() if not is_gauge_key(key)}
        merged = {**in_joint}
        for key, column in given.items():
            chosen = self.chosen(f"--map {key}", column, in_joint.get(key))
            assert chosen is not None
            merged[key] = chosen
        if "angle" in merged:
            speed = merged.pop("speed", None)
            if speed is not None and "speed" in given:
                self.remarks.append("the mapped speed is not used: an angle is there")
        elif "speed" not in merged:
            raise InputError(
                "--map: nothing is mapped for the angle; expected angle=COLUMN, or speed=COLUMN "
                f"where there is no angle, measured on the {side} side"
            )
        return self.one_torque(merged)

    def one_torque(self, merged: dict[str, MappedColumn]) -> dict[str, MappedColumn]:
        """Keep either the torque or the gauges that it is made of."""
        gauges = [key for key in merged if is_gauge_key(key)]
        given = self.options.mapping
        if "torque" in given and any(is_gauge_key(key) for key in given):
            raise InputError(
                "--map: torque and gauges are both mapped; expected the recorded torque, or the "
                "gauges that it is computed from, so remove one of them"
            )
        # The temperature is that of the gauges' drift; a torque has none left.
        beside = {*gauges, "temperature"}
        if "torque" in given:
            return {key: each for key, each in merged.items() if key not in beside}
        can_compute = self.joint is not None and self.joint.torque_calibration is not None
        if gauges and (can_compute or "torque" not in merged):
            return {key: each for key, each in merged.items() if key != "torque"}
        if "torque" not in merged:
            raise InputError(
                "--map: nothing is mapped for the torque; expected torque=COLUMN, the torque with "
                "ripple, or gauges=COLUMN+COLUMN+... with a joint file that has a calibration"
            )
        return {key: each for key, each in merged.items() if key not in beside}

    def motor_angle_first(
        self, given: Mapping[str, MappedColumn], side: AngleSide
    ) -> Mapping[str, MappedColumn]:
        if "motor-angle" not in given:
            return given
        if "angle" in given and self.options.angle_side == "motor":
            raise InputError(
                "--map: angle and motor-angle are both mapped with --angle-side motor; expected the "
                "output's angle as angle beside motor-angle, so give --angle-side output or remove "
                "one of them"
            )
        assert side == "motor"
        if "angle" in given:
            self.remarks.append(
                "the ripple is taken against the motor's angle, not the output's beside it"
            )
        kept = {key: each for key, each in given.items() if key not in ("angle", "motor-angle")}
        return {**kept, "angle": given["motor-angle"]}

    def inertia(
        self, columns: dict[str, MappedColumn], side: AngleSide, ratio: Fraction | None
    ) -> float | None:
        inertia = None if self.signals is None else self.signals.load_inertia_kg_m2
        if inertia is None or "expected-torque" in columns:
            return None
        if side == "motor" and ratio is None:
            self.remarks.append(
                "load_inertia_kg_m2 in the joint file is not used: without a ratio the output's "
                "acceleration is not known; add --ratio N"
            )
            return None
        return inertia


def _joint_columns(signals: Signals, side: AngleSide) -> dict[str, MappedColumn]:
    motor = side == "motor"
    found: dict[str, Column | None] = {
        "time": signals.time,
        "angle": signals.motor_angle if motor else signals.output_angle,
        "speed": signals.motor_speed if motor else signals.output_speed,
        "torque": signals.torque,
        "expected-torque": signals.expected_torque,
        "temperature": signals.temperature,
    }
    found |= {gauge_key(number): column for number, column in enumerate(signals.gauges, 1)}
    return {
        key: MappedColumn(column.column, column.unit, column.sign, quoted=True)
        for key, column in found.items()
        if column is not None
    }


def _shown(value: object) -> str:
    if isinstance(value, MappedColumn):
        sign = "minus " if value.sign < 0 else ""
        return f"{sign}{value.column!r} in {value.unit}"
    return f"{float(value):g}" if isinstance(value, int | float | Fraction) else str(value)
