"""The section ``[gains]`` from a calibration of the fluctuation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from strainwave.calibrate.fluctuation_run import rms_left
from strainwave.joint import Gains, build_section

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.commissioning.fluctuation_result import FluctuationCalibration
    from strainwave.joint import Joint


def gains_section(
    result: FluctuationCalibration,
    torque_sensitivities: NDArray[np.float64] | None,
    joint: Joint | None = None,
) -> Gains:
    """Build the section.

    Parameters
    ----------
    result : FluctuationCalibration
        What was found.
    torque_sensitivities : numpy.ndarray or None
        t_j where they were told, shape (gauges,).
    joint : Joint, optional
        The joint as it was: what a person chose stays.

    Returns
    -------
    Gains
        The section, without provenance.
    """
    values: dict[str, Any] = {
        "gains": result.gains.tolist(),
        "harmonics": list(result.solution.harmonics),
        # Rounding may leave it a little below the least there is.
        "noise_factor": max(1.0, result.noise_factor),
        "condition_number": max(1.0, result.solution.condition_number),
        "residual_fluctuation_V": result.rms_left,
        "without_gauge": [
            {
                "gauge": each.gauge,
                "gains": each.gains.tolist(),
                "noise_factor": each.noise_factor,
                "residual_fluctuation_V": rms_left(result.runs, each.gains),
            }
            for each in result.lost_gauges.sets
        ],
        **_watch(result),
    }
    if joint is not None and joint.gains is not None and joint.gains.detection_time_s is not None:
        values["detection_time_s"] = joint.gains.detection_time_s
    if torque_sensitivities is not None:
        values["torque_sensitivities"] = torque_sensitivities.tolist()
    return cast("Gains", build_section("gains", values, "what was calibrated"))


def _watch(result: FluctuationCalibration) -> dict[str, Any]:
    watch = result.watch
    amplitudes, phases = np.abs(watch.phasors), np.angle(watch.phasors)
    limits = {
        "noise_V": watch.noise_V,
        "consistency_limit_V": watch.limit_V,
        "consistency_limit_share": watch.share,
    }
    signals = [
        {
            "zero_V": float(zero_V),
            "amplitudes_V": amplitudes[:, j].tolist(),
            "phases_rad": phases[:, j].tolist(),
        }
        for j, zero_V in enumerate(watch.zeros_V)
    ]
    known = {name: value for name, value in limits.items() if value is not None}
    return {"gauge_signals": signals, **known}
