"""From a joint file to the core's configuration: what the file knows, checked by the core."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from strainwave import _core
from strainwave.errors import InputError
from strainwave.joint import order_value

if TYPE_CHECKING:
    from collections.abc import Callable

    from strainwave.joint import Joint
    from strainwave.joint.provenance import Section

SectionType = TypeVar("SectionType", bound="Section")


def gear_of(joint: Joint) -> _core.Gear:
    """Build the gear of a joint.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[gear]``.

    Returns
    -------
    Gear
        Ratio, configuration, direction and rated torque.

    Raises
    ------
    InputError
        If the section is missing.
    """
    gear = _required(joint, "gear", joint.gear)
    return _core.Gear(
        ratio=gear.ratio,
        configuration=_core.GearConfiguration[gear.configuration],
        rated_torque_Nm=gear.rated_torque_Nm,
        output_direction=gear.output_direction,
    )


def oscillator_filter_of(joint: Joint) -> _core.OscillatorFilterConfig:
    """Build the oscillator filter's configuration of a joint.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[ripple_filter]``, and ``[gear]`` where an order needs its ratio.

    Returns
    -------
    OscillatorFilterConfig
        Orders, variances, protection.

    Raises
    ------
    InputError
        If a section is missing.
    """
    section = _required(joint, "ripple_filter", joint.ripple_filter)
    ratio = None if joint.gear is None else joint.gear.ratio
    orders = []
    for order in section.orders:
        value = order_value(order, ratio)
        # A fraction of a float ratio may have more digits than the core keeps; its value has not.
        exact = isinstance(value, Fraction) and max(value.numerator, value.denominator) < 2**31
        orders.append(value if exact else float(value))
    variances = list(section.process_noise_variances_Nm2)
    given = {
        name: value
        for name in ("minimum_travel_rad", "minimum_speed_rad_s", "variance_limit_ratio")
        if (value := getattr(section, name)) is not None
    }
    return _core.OscillatorFilterConfig(
        orders=orders,
        process_noise_variance_Nm2=variances[0] if len(variances) == 1 else variances,
        measurement_noise_variance_Nm2=section.measurement_noise_variance_Nm2,
        initial_variance_Nm2=section.initial_variance_Nm2,
        sample_period_s=section.sample_period_s,
        rotation_source=_core.RotationSource[section.rotation_source],
        **given,
    )


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
    section = _required(joint, "torque_calibration", joint.torque_calibration)
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
        ``[torque_calibration]`` and ``[ripple_filter]``; without ``[gains]`` they are all 1.

    Returns
    -------
    TorqueSensorConfig
        Configuration for `strainwave.TorqueSensor`.

    Raises
    ------
    InputError
        If a section or the converter is missing.
    """
    return _core.TorqueSensorConfig(
        converter=converter_of(joint),
        gains=gains_of(joint),
        calibration=calibration_of(joint),
        filter=oscillator_filter_of(joint),
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
    gauges = _required(joint, "gauges", joint.gauges)
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
    return _core.Gains([1.0] * _required(joint, "gauges", joint.gauges).channel_count)


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
    has_converter = joint.gauges is not None and joint.gauges.converter_bits is not None
    needs_gear = joint.gear is not None
    builders: tuple[tuple[str, bool, Callable[[Joint], object]], ...] = (
        ("gear", joint.gear is not None, gear_of),
        ("gauges", has_converter, converter_of),
        ("gains", joint.gains is not None, gains_of),
        ("torque_calibration", joint.torque_calibration is not None and needs_gear, calibration_of),
        ("ripple_filter", joint.ripple_filter is not None, oscillator_filter_of),
    )
    for name, is_present, build in builders:
        if is_present:
            try:
                build(joint)
            except InputError as error:
                raise InputError(f"[{name}] {error}") from error


def _required(joint: Joint, name: str, section: SectionType | None) -> SectionType:
    if section is None:
        raise InputError(
            f'joint "{joint.identity.name}": there is no section [{name}]; expected it for this '
            "configuration, so fill it first"
        )
    return section
