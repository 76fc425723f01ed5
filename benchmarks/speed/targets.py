"""What is asked for: a name, a number and which way it counts, for each result of the bench."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final


@dataclass(frozen=True)
class Target:
    """One acceptance value.

    Attributes
    ----------
    how : str
        What is measured.
    least, most : float, optional
        Limits; without either the value is for information.
    """

    how: str
    least: float | None = None
    most: float | None = None

    def result(self, value: float | None, reason: str = "") -> dict[str, Any]:
        """Hold a value against the target.

        Parameters
        ----------
        value : float, optional
            What was measured; None where it could not be.
        reason : str
            Why it could not be.

        Returns
        -------
        dict
            ``value``, ``target``, ``met`` and ``how``.
        """
        target = self.least if self.least is not None else self.most
        met = None
        if value is not None and target is not None:
            met = value >= target if self.least is not None else value <= target
        if value is None or not math.isfinite(value):
            return {
                "value": None,
                "target": target,
                "met": None if target is None else False,
                "how": f"{self.how}; not available: {reason}",
            }
        return {"value": value, "target": target, "met": met, "how": self.how}


_ONE_CHANNEL: Final = "published filter, 6 states, one channel: its time over the core's in float"
_DEFAULT: Final = "default ripple filter, 15 states, float, one channel: its time over the core's"


def targets(best_level: str) -> dict[str, Target]:
    """List all targets.

    Parameters
    ----------
    best_level : str
        Vector level of this machine, ``v2``, ``v3`` or ``v4``: less is asked of narrower vectors.

    Returns
    -------
    dict of Target
        By the name under which the result stands in latest.json.
    """
    batch_least = {"v4": 35.0, "v3": 20.0}.get(best_level)
    return {
        "published_single_vs_eigen": Target(f"{_ONE_CHANNEL}; Eigen, fixed size, float", 5.0),
        "published_single_vs_filterpy": Target(f"{_ONE_CHANNEL}; filterpy", 1000.0),
        "published_single_vs_statsmodels": Target(f"{_ONE_CHANNEL}; statsmodels", 90.0),
        "published_single_vs_pykalman": Target(f"{_ONE_CHANNEL}; pykalman"),
        "published_single_vs_simdkalman": Target(f"{_ONE_CHANNEL}; simdkalman's primitives"),
        "published_single_vs_numba": Target(f"{_ONE_CHANNEL}; numba, dense, float"),
        "published_single_vs_jax": Target(f"{_ONE_CHANNEL}; JAX scan on the processor, float"),
        "published_single_vs_minikalman": Target(f"{_ONE_CHANNEL}; minikalman, float"),
        "published_single_vs_numpy": Target(f"{_ONE_CHANNEL}; plain numpy, double"),
        "published_batch_vs_eigen": Target(
            "published filter, float, 64 channels on one core, by channel-sample: Eigen's time one "
            "by one over the batch's at the best vector level",
            batch_least,
        ),
        "batch_share_of_issue_bound": Target(
            "published filter, float, 64 channels on one core: time that its flops take at the "
            "measured rate of products and sums, over the time taken",
            0.5,
        ),
        "batch_two_cores_vs_one": Target(
            "published filter, float, 64 channels: time of one thread over that of two", 1.8
        ),
        "default_single_vs_eigen": Target(f"{_DEFAULT}; Eigen, dense, fixed size, float", 3.0),
        "default_single_vs_numba": Target(f"{_DEFAULT}; numba, dense, float", 10.0),
        "default_batch_vs_numba": Target(
            "default ripple filter, 15 states, float, 64 channels on one core, by channel-sample: "
            "dense numba's time over the batch's",
            60.0,
        ),
        "default_batch_share_of_issue_bound": Target(
            "default ripple filter, 15 states, float, 64 channels on one core: time that its flops "
            "take at the measured rate of products and sums, over the time taken",
            0.4,
        ),
        "long_log_vs_sequential": Target(
            "published filter, float, one log: time in sequence over the time in chunks on two "
            "cores",
            4.0,
        ),
        "long_log_share_of_bandwidth": Target(
            "published filter, float, one log in chunks on two cores: time to copy its 12 bytes a "
            "sample at the measured bandwidth, over the time taken",
            0.25,
        ),
        "default_long_log_vs_sequential": Target(
            "default ripple filter, 15 states, float, one log: time in sequence over the time in "
            "chunks on two cores",
            3.0,
        ),
        "long_log_difference_rms_Nm": Target(
            "published filter, float, one log: ripple in chunks less ripple in sequence, rms, Nm",
            most=1e-4,
        ),
        "step_vs_empty_bound_function": Target(
            "OscillatorFilter.step(float, float) called from Python, over an empty bound "
            "function of the same signature",
            most=3.0,
        ),
        "filter_command_vs_polars": Target(
            "`strainwave filter` on a Parquet log, over polars reading and writing the same file, "
            "whole processes",
            most=2.0,
        ),
        "filter_command_peak_memory_bytes": Target(
            "peak memory of `strainwave filter` on that log", most=1e9
        ),
    }
