"""The published filter as a method: oscillators that turn with the motor, by a Kalman filter.

Taghirad & Belanger 1999, eq. (9) to (14); the arithmetic is `strainwave.OscillatorFilter`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave import _core
from strainwave.configuration import oscillator_filter_of
from strainwave.errors import InputError
from strainwave.filter import OscillatorFilter, oscillator_preset
from strainwave.methods.interface import Cleaned, nothing
from strainwave.methods.motion import BackwardDifference

if TYPE_CHECKING:
    from strainwave.methods.setting import Setting
    from strainwave.samples import Samples

#: A tuning belongs to a sample period, because its process noise is per sample: this much of
#: difference between the joint file's and the recording's is put up with.
LARGEST_PERIOD_DIFFERENCE = 0.1


class Published:
    """An oscillator filter over a recording's rows.

    With rotation by speed, as printed, the filter turns by speed x sample period from each row to
    the next. The speed is the backward difference of the motor angles over the real time stamps, so
    that it is causal; it belongs to the interval before the row, and the filter takes it for the
    one after. The sample period is the setting's. Rows without torque or angle are rejected and
    flagged by the core, which holds the last torque and carries the last speed on.

    Parameters
    ----------
    config : OscillatorFilterConfig
        Orders, variances, protection and sample period.
    """

    def __init__(self, config: _core.OscillatorFilterConfig) -> None:
        self._filter = OscillatorFilter(config)
        self._motion = BackwardDifference()

    @property
    def config(self) -> _core.OscillatorFilterConfig:
        """Orders, variances, protection and sample period."""
        return self._filter.config

    @property
    def turns_by_speed(self) -> bool:
        """Whether the filter turns by speed x sample period; else by the angle."""
        return self.config.rotation_source is _core.RotationSource.speed

    def process(self, samples: Samples, /) -> Cleaned:
        """Remove the ripple from the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            One row for each.
        """
        speed_rad_s = angle_rad = None
        if self.turns_by_speed:
            speed_rad_s = self._motion.speeds(samples.time_s, samples.motor_angle_rad)
        else:
            angle_rad = samples.motor_angle_rad
        result = self._filter.process(
            samples.torque_Nm,
            motor_speed_rad_s=speed_rad_s,
            motor_angle_rad=angle_rad,
            expected_torque_Nm=samples.expected_torque_Nm,
        )
        return Cleaned(result.torque_Nm, result.ripple_Nm, result.status)

    def finish(self) -> Cleaned:
        """Hand out nothing: no rows are held back.

        Returns
        -------
        Cleaned
            No rows.
        """
        return nothing()


def taghirad1999(setting: Setting) -> Published:
    """Build the published filter of section VI: orders 2, 4 and 1/ratio.

    Parameters
    ----------
    setting : Setting
        Sample period and ratio.

    Returns
    -------
    Published
        The filter at its start.

    Raises
    ------
    InputError
        If the ratio is not known.
    """
    if setting.ratio is None:
        raise InputError(
            "method taghirad1999 needs the ratio of the gear, because it removes order 1/ratio: "
            "expected --ratio or a joint file with [gear]; give one, or use taghirad1999-4"
        )
    config = oscillator_preset("taghirad1999", setting.ratio)
    return Published(_at_period(config, setting.sample_period_s))


def taghirad1999_4(setting: Setting) -> Published:
    """Build the published filter of section V: orders 2 and 4.

    Parameters
    ----------
    setting : Setting
        Sample period.

    Returns
    -------
    Published
        The filter at its start.
    """
    return Published(_at_period(oscillator_preset("taghirad1999-4"), setting.sample_period_s))


def oscillator(setting: Setting) -> Published:
    """Build the oscillator filter that the joint file describes.

    Parameters
    ----------
    setting : Setting
        Sample period, and a joint with a section ``[ripple_filter]`` of method ``oscillator``.

    Returns
    -------
    Published
        The filter at its start; it turns by the recording's sample period.

    Raises
    ------
    InputError
        If there is no such section, or it was tuned for another sample period.
    """
    joint = setting.joint
    if joint is None:
        raise InputError(
            "method oscillator takes its values from a joint file: expected one with a section "
            "[ripple_filter]; give it with --joint, or choose another method"
        )
    section = joint.ripple_filter
    if section is None or str(section.method) != "oscillator":
        raise InputError(
            f'joint "{joint.identity.name}": there is no section [ripple_filter] with method = '
            '"oscillator", where method oscillator takes its values from; add it, or choose '
            "another method"
        )
    config = oscillator_filter_of(joint)
    tuned_s = config.sample_period_s
    if abs(setting.sample_period_s - tuned_s) > LARGEST_PERIOD_DIFFERENCE * tuned_s:
        raise InputError(
            f'joint "{joint.identity.name}": [ripple_filter] is tuned for sample_period_s = '
            f"{tuned_s:g} s, and the recording has {setting.sample_period_s:g} s: expected the "
            "same within 10 %, because the process noise is per sample; tune it for this rate"
        )
    return Published(_at_period(config, setting.sample_period_s))


def _at_period(
    config: _core.OscillatorFilterConfig, sample_period_s: float
) -> _core.OscillatorFilterConfig:
    """Make the same configuration for another sample period."""
    return _core.OscillatorFilterConfig(
        orders=config.orders,
        process_noise_variance_Nm2=config.process_noise_variance_Nm2,
        measurement_noise_variance_Nm2=config.measurement_noise_variance_Nm2,
        initial_variance_Nm2=config.initial_variance_Nm2,
        sample_period_s=sample_period_s,
        rotation_source=config.rotation_source,
        minimum_travel_rad=config.minimum_travel_rad,
        minimum_speed_rad_s=config.minimum_speed_rad_s,
        variance_limit_ratio=config.variance_limit_ratio,
    )
