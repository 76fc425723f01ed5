"""The five chains of the golden vectors, run through the Python package."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import DTypeLike, NDArray

import strainwave as sw
from benchmarks.golden.inputs import (
    INFINITY_CODE,
    NAN_CODE,
    SPEED_STEP_RAD_S,
    TEMPERATURE_STEP_DEGC,
    TICK_S,
    TORQUE_STEP_NM,
    Integers,
    Samples,
)


@dataclass(frozen=True)
class Answers:
    """What a chain says of every sample.

    Attributes
    ----------
    torque_Nm, ripple_Nm : numpy.ndarray
        Float or double, shape (samples,), Nm.
    status : numpy.ndarray
        Bits of `strainwave.StatusFlag`, shape (samples,), uint32.
    """

    torque_Nm: NDArray[Any]
    ripple_Nm: NDArray[Any]
    status: NDArray[np.uint32]

    def checksum(self) -> int:
        """Return the CRC-32 of all answers.

        Returns
        -------
        int
            Over little-endian records of torque, ripple and status.
        """
        return zlib.crc32(self.records().tobytes())

    def records(self) -> NDArray[Any]:
        """Return the answers as the firmware writes them.

        Returns
        -------
        numpy.ndarray
            Structured, shape (samples,).
        """
        real = self.torque_Nm.dtype.newbyteorder("<")
        rows = np.zeros(
            self.status.size, [("torque_Nm", real), ("ripple_Nm", real), ("status", "<u4")]
        )
        rows["torque_Nm"], rows["ripple_Nm"] = self.torque_Nm, self.ripple_Nm
        rows["status"] = self.status
        return rows


def numbers(codes: Integers, step: float, dtype: DTypeLike) -> NDArray[Any]:
    """Return what codes stand for; exact, because steps are powers of two.

    Parameters
    ----------
    codes : numpy.ndarray
        Whole numbers, `NAN_CODE` and `INFINITY_CODE` among them.
    step : float
        Of one code.
    dtype : dtype_like
        float32 or float64.

    Returns
    -------
    numpy.ndarray
        In the step's unit.
    """
    values = codes * step
    values[codes == NAN_CODE] = np.nan
    values[codes == INFINITY_CODE] = np.inf
    return values.astype(dtype)


def motor_angle_rad(samples: Samples) -> NDArray[np.float64]:
    """Return the motor's angle from a count that wraps at 32 bits.

    Parameters
    ----------
    samples : Samples
        The samples.

    Returns
    -------
    numpy.ndarray
        NaN where the encoder said nothing, rad, shape (samples,).
    """
    raw = samples.encoder.astype(np.uint32).astype(np.int32).astype(np.int64)
    steps = (np.diff(raw) + 2**31) % 2**32 - 2**31
    counts = raw[0] + np.concatenate([[0], np.cumsum(steps)])
    angle: NDArray[np.float64] = counts * (2 * np.pi / 2**16)
    angle[samples.angle_known == 0] = np.nan
    return angle


def _published(preset: str) -> Callable[[dict[str, Any], Samples, DTypeLike], Answers]:
    def run(_: dict[str, Any], samples: Samples, dtype: DTypeLike) -> Answers:
        found = sw.OscillatorFilter(sw.oscillator_preset(preset), dtype=dtype).process(
            numbers(samples.torque, TORQUE_STEP_NM, dtype),
            motor_speed_rad_s=numbers(samples.speed, SPEED_STEP_RAD_S, dtype),
            expected_torque_Nm=numbers(samples.expected, TORQUE_STEP_NM, dtype),
        )
        return Answers(found.torque_Nm, found.ripple_Nm, found.status)

    return run


def ripple_config(definition: dict[str, Any], **terms: bool) -> sw.RippleFilterConfig:
    """Return the configuration of a ripple filter.

    Parameters
    ----------
    definition : dict
        As in ``golden.json``.
    **terms
        What each order depends on, as in `strainwave.RippleOrder`.

    Returns
    -------
    RippleFilterConfig
        The definition's orders.
    """
    orders = [sw.RippleOrder(order, **terms) for order in definition["orders"]]
    return sw.RippleFilterConfig(orders=orders)


def _ripple(**terms: bool) -> Callable[[dict[str, Any], Samples, DTypeLike], Answers]:
    def run(definition: dict[str, Any], samples: Samples, dtype: DTypeLike) -> Answers:
        found = sw.RippleFilter(ripple_config(definition, **terms), dtype=dtype).process(
            samples.ticks * TICK_S,
            motor_angle_rad(samples),
            numbers(samples.torque, TORQUE_STEP_NM, dtype),
            expected_torque_Nm=numbers(samples.expected, TORQUE_STEP_NM, dtype),
        )
        return Answers(found.torque_Nm, found.ripple_Nm, found.status)

    return run


def sensor_config(definition: dict[str, Any]) -> sw.TorqueSensorConfig:
    """Return the configuration of the whole chain.

    Parameters
    ----------
    definition : dict
        As in ``golden.json``.

    Returns
    -------
    TorqueSensorConfig
        Four gauges, calibration, monitor, ripple filter with load and speed terms.
    """
    told = definition["chain"]
    consistency = sw.ConsistencyCheck(
        signal_directions=[told["directions"]],
        gauge_zero_V=told["gauge_zero_V"],
        fluctuation_V=told["wave_V"],
        **told["consistency"],
    )
    without = [
        sw.GainsWithoutGauge(
            j + 1,
            gains,
            zero_shift_V=told["zero_shift_V"][j],
            residual_fluctuation_V=told["residual_without_V"][j],
        )
        for j, gains in enumerate(told["gains_without"])
    ]
    return sw.TorqueSensorConfig(
        converter=sw.Converter(**told["converter"]),
        gains=sw.Gains(told["gains"]),
        calibration=sw.TorqueCalibration(**told["calibration"]),
        filter=ripple_config(definition, with_load=True, with_speed=True),
        monitor=sw.GaugeMonitorConfig(consistency=consistency, without=without, **told["monitor"]),
    )


def _chain(definition: dict[str, Any], samples: Samples, dtype: DTypeLike) -> Answers:
    found = sw.TorqueSensor(sensor_config(definition), dtype=dtype).process(
        samples.gauges,
        motor_angle_rad=motor_angle_rad(samples),
        expected_torque_Nm=numbers(samples.expected, TORQUE_STEP_NM, dtype),
        temperature_degC=numbers(samples.temperature, TEMPERATURE_STEP_DEGC, dtype),
        sequence=samples.sequence.astype(np.uint32),
        time_s=samples.ticks * TICK_S,
    )
    return Answers(found.torque_Nm, found.ripple_Nm, found.status)


#: By the names of the firmware's budgets.
CHAINS: Final[dict[str, Callable[[dict[str, Any], Samples, DTypeLike], Answers]]] = {
    "published_4": _published("taghirad1999-4"),
    "published_6": _published("taghirad1999"),
    "default_3_orders": _ripple(),
    "default_3_orders_load_speed_direction": _ripple(
        with_load=True, with_speed=True, with_direction=True
    ),
    "chain_4_gauges": _chain,
}
