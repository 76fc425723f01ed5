"""Taghirad & Belanger 1999: the filter as published, and its structure with another Q/R."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import strainwave
from benchmarks.accuracy.methods.interface import Method, Removal
from benchmarks.accuracy.methods.packaged import run_packaged
from benchmarks.accuracy.methods.speed import difference_speed_rad_s

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting


def remove_as_published(log: Log, setting: Setting) -> Removal:
    """Run orders 2, 4 and 1/ratio with Q = 1e3 I, R = 1.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Sample period and ratio.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    return run_packaged("taghirad1999", log, setting)


def tuned_config(
    setting: Setting, *, process_over_measurement: float, minimum_speed_rad_s: float
) -> strainwave.OscillatorFilterConfig:
    """Configure the setting's orders, without 1/ratio, with a tuned Q/R.

    Parameters
    ----------
    setting : Setting
        Sample period and orders.
    process_over_measurement : float
        Q/R.
    minimum_speed_rad_s : float
        Speed below which the oscillators rest; 0 as published.

    Returns
    -------
    OscillatorFilterConfig
        The configuration.
    """
    return strainwave.OscillatorFilterConfig(
        orders=setting.orders,
        process_noise_variance_Nm2=process_over_measurement,
        measurement_noise_variance_Nm2=1.0,
        sample_period_s=setting.sample_period_s,
        minimum_speed_rad_s=minimum_speed_rad_s,
    )


def remove_tuned(log: Log, setting: Setting, **tuning: float) -> Removal:
    """Run the published structure with a tuned Q/R.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Sample period and orders.
    **tuning
        As for `tuned_config`.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    result = strainwave.OscillatorFilter(tuned_config(setting, **tuning)).process(
        log.torque_Nm,
        motor_speed_rad_s=difference_speed_rad_s(log),
        expected_torque_Nm=log.expected_torque_Nm,
    )
    return Removal(np.asarray(result.torque_Nm), np.asarray(result.ripple_Nm))


PUBLISHED = Method(
    "published", remove_as_published, remark="orders 2, 4 and 1/ratio, Q = 1e3 I, R = 1"
)
PUBLISHED_TUNED = Method(
    "published, tuned",
    remove_tuned,
    tuple(
        {"process_over_measurement": float(f"{10.0**power:.2g}"), "minimum_speed_rad_s": speed}
        for power in (-8, -7, -6.5, -6, -5.5, -5, -4.5, -4, -3)
        for speed in (10.0, 0.0)
    ),
    "same structure without order 1/ratio; may rest at low speed",
)
