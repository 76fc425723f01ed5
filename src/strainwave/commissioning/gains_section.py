"""The section ``[gains]`` from a calibration of the fluctuation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from strainwave.joint import Gains, build_section

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun
    from strainwave.commissioning.fluctuation_result import FluctuationCalibration


def rms_left(runs: Sequence[FluctuationRun], gains: NDArray[np.float64]) -> float:
    """Root mean square of the fluctuation left, in all harmonics fitted, in the worst run.

    What gains leave in the run they were solved from is nothing; in another one it is what the
    phasors are uncertain by. Both count.

    Parameters
    ----------
    runs : sequence of FluctuationRun
        The runs.
    gains : numpy.ndarray
        g_j, shape (gauges,).

    Returns
    -------
    float
        In the unit of the signals.
    """
    return max(
        float(
            np.sqrt(
                np.sum(
                    np.abs(run.weighted_sum(gains)) ** 2 / 2
                    + run.sum_standard_uncertainty(gains) ** 2
                )
            )
        )
        for run in runs
    )


def gains_section(
    result: FluctuationCalibration, torque_sensitivities: NDArray[np.float64] | None
) -> Gains:
    """Build the section.

    Parameters
    ----------
    result : FluctuationCalibration
        What was found.
    torque_sensitivities : numpy.ndarray or None
        t_j where they were told, shape (gauges,).

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
            for each in result.without_gauge
        ],
    }
    if torque_sensitivities is not None:
        values["torque_sensitivities"] = torque_sensitivities.tolist()
    return cast("Gains", build_section("gains", values, "what was calibrated"))
