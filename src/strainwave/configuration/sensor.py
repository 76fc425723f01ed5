"""From a joint file to the core's configuration of the sensor: what the file knows, checked."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from strainwave import _core
from strainwave.configuration.filters import (
    oscillator_filter_of,
    ripple_filter_of,
    running_ripple_filter,
)
from strainwave.configuration.gauge_monitor import gauge_monitor_of
from strainwave.configuration.gear import gear_of
from strainwave.configuration.sections import required
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from strainwave.joint import Joint


def calibration_of(joint: Joint) -> _core.TorqueCalibration:
    """Build the torque calibration of a joint.

    Parameters
    ----------
    joint : Joint
        A joint with the sections ``[gear]`` and ``[torque_calibration]``, and ``[temperature]``
        where drifts are known.

    Returns
    -------
    TorqueCalibration
        Gain, zero, linearisation and drifts.

    Raises
    ------
    InputError
        If a section is missing.
    """
    section = required(joint, "torque_calibration", joint.torque_calibration)
    drifts = {}
    if joint.temperature is not None:
        temperature = joint.temperature
        drifts = {
            "reference_temperature_degC": temperature.reference_temperature_degC,
            "zero_drift_V_per_K": temperature.zero_drift_V_per_K,
            "gain_drift_per_K": temperature.gain_drift_per_K,
        }
        if temperature.lowest_temperature_degC is not None:
            drifts["minimum_temperature_degC"] = temperature.lowest_temperature_degC
        if temperature.highest_temperature_degC is not None:
            drifts["maximum_temperature_degC"] = temperature.highest_temperature_degC
    return _core.TorqueCalibration(
        gain_Nm_per_V=section.gain_Nm_per_V,
        zero_V=section.zero_V,
        full_scale_Nm=gear_of(joint).rated_torque_Nm,
        linearisation=list(section.linearisation),
        **drifts,
    )


def sensor_of(joint: Joint) -> _core.TorqueSensorConfig:
    """Build the whole chain of a joint, from converter codes to clean torque.

    Parameters
    ----------
    joint : Joint
        A joint with the sections ``[gear]``, ``[gauges]`` (converter included),
        ``[torque_calibration]`` and ``[ripple_filter]``, whose ``method`` is the filter; without
        ``[gains]`` they are all 1. The ripple filter takes its sample period from ``[signals]``.
        Where ``[gains]`` has ``without_gauge`` or ``gauge_signals``, lost gauges are watched for.

    Returns
    -------
    TorqueSensorConfig
        Configuration for `strainwave.TorqueSensor`; what its ripple filter starts with is
        `learned_of` the joint.

    Raises
    ------
    InputError
        If a section, the converter or, for the ripple filter, the sampling rate is missing.
    """
    filter_config: _core.RippleFilterConfig | _core.OscillatorFilterConfig
    if joint.ripple_filter is not None and joint.ripple_filter.method == "ripple":
        filter_config = ripple_filter_of(joint)
        sample_period_s = _sample_period_s(joint)
    else:
        filter_config = oscillator_filter_of(joint)
        sample_period_s = filter_config.sample_period_s
    return _core.TorqueSensorConfig(
        converter=converter_of(joint),
        gains=gains_of(joint),
        calibration=calibration_of(joint),
        filter=filter_config,
        sample_period_s=sample_period_s,
        monitor=gauge_monitor_of(joint, sample_period_s),
    )


def converter_of(joint: Joint) -> _core.Converter:
    """Build the converter of a joint.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[gauges]`` that describes its converter.

    Returns
    -------
    Converter
        Bits, range and lowest code.

    Raises
    ------
    InputError
        If the section or the converter is missing.
    """
    gauges = required(joint, "gauges", joint.gauges)
    if (
        gauges.converter_bits is None
        or gauges.converter_minimum_V is None
        or gauges.converter_maximum_V is None
    ):
        raise InputError(
            f'joint "{joint.identity.name}": [gauges] has no converter; expected converter_bits, '
            "converter_minimum_V and converter_maximum_V to read codes with, so add them"
        )
    return _core.Converter(
        bits=gauges.converter_bits,
        minimum_V=gauges.converter_minimum_V,
        maximum_V=gauges.converter_maximum_V,
        lowest_code=gauges.converter_lowest_code,
    )


def gains_of(joint: Joint) -> _core.Gains:
    """Build the gains of a joint; without a section ``[gains]`` they are all 1.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[gains]`` or ``[gauges]``.

    Returns
    -------
    Gains
        One a channel.

    Raises
    ------
    InputError
        If both sections are missing.
    """
    if joint.gains is not None:
        return _core.Gains(list(joint.gains.gains))
    return _core.Gains([1.0] * required(joint, "gauges", joint.gauges).channel_count)


def verify(joint: Joint) -> None:
    """Build everything that a joint's sections describe, and keep none of it.

    The joint file checks that its values belong together; only the core knows what it can compute
    with. A file that passes both can be used.

    Parameters
    ----------
    joint : Joint
        Any joint; sections that are missing are passed over.

    Raises
    ------
    InputError
        If a section cannot be used; the message begins with its name.
    """
    has_gear = joint.gear is not None
    filter_builder: Callable[[Joint], object] = oscillator_filter_of
    has_filter = joint.ripple_filter is not None
    if joint.ripple_filter is not None and joint.ripple_filter.method == "ripple":
        filter_builder = running_ripple_filter
        has_filter = has_gear or joint.misalignment is None
    has_converter = joint.gauges is not None and joint.gauges.converter_bits is not None
    builders: tuple[tuple[str, bool, Callable[[Joint], object]], ...] = (
        ("gear", has_gear, gear_of),
        ("gauges", has_converter, converter_of),
        ("gains", joint.gains is not None, gains_of),
        ("gains", has_converter and has_gear, partial(gauge_monitor_of, sample_period_s=1e-3)),
        ("torque_calibration", joint.torque_calibration is not None and has_gear, calibration_of),
        ("ripple_filter", has_filter, filter_builder),
    )
    for name, is_present, build in builders:
        if is_present:
            try:
                build(joint)
            except InputError as error:
                raise InputError(f"[{name}] {error}") from error


def _sample_period_s(joint: Joint) -> float:
    """Return the time between two rows, which the ripple filter goes by where rows have no time."""
    rate_Hz = required(joint, "signals", joint.signals).sampling_rate_Hz
    if rate_Hz is None:
        raise InputError(
            f'joint "{joint.identity.name}": [signals] has no sampling_rate_Hz; expected it for '
            "the chain with the ripple filter, so add it"
        )
    return 1.0 / rate_Hz
