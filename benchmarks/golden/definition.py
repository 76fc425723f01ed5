"""What happens in the golden vectors, and what the chains are told: numbers, written once.

They go into ``tests/data/golden/golden.json`` and from there into the C++ side's header.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from benchmarks.golden.inputs import INFINITY_CODE, NAN_CODE
from strainwave.calibrate.fluctuation import compensation_conditions
from strainwave.calibrate.gains import compensating_gains
from strainwave.calibrate.gauge_watch import fluctuation_rms, signal_directions
from strainwave.calibrate.lost_gauge import gains_without_each

#: More than 1e5, a multiple of the distance between the samples that are kept.
SAMPLES: Final = 102_400
#: Every so many samples the answer is kept; checksums cover all of them.
EVERY: Final = 256
FULL_SCALE_NM: Final = 40.0

_RAIL: Final = 2**15 - 1
_ALL: Final = 10**6  # until the end

#: (kind, first sample, samples, value); see `benchmarks.golden.inputs`.
_EVENTS: Final = (
    ("torque", 2600, 1, NAN_CODE),
    ("torque", 2700, 2, INFINITY_CODE),
    ("expected", 2800, 3, NAN_CODE),
    ("speed", 2900, 2, NAN_CODE),
    ("temperature", 3000, 4, NAN_CODE),
    ("temperature", 3100, 3, 200 * 256),
    ("no_angle", 3300, 40, 0),
    ("all_gauges", 3600, 8, _RAIL),
    ("gauge_2", 3700, 1, _RAIL),
    ("repeated", 4000, 1, 0),
    ("repeated", 4010, 3, 0),
    ("gap", 4200, 1, 17),
    ("gap", 5000, 1, 300),
    ("time_back", 5200, 3, 5_000),
    ("time_back", 5400, 20, 50_000),
    ("sequence_back", 6000, 4, 100),
    ("sequence_back", 6200, 15, 1_000),
    ("torque", 8200, 300, 20 * 4096),  # the sensor sticks, with the motor under way
    ("torque", 13_100, 5, NAN_CODE),  # at rest
    ("no_angle", 13_300, 30, 0),
    ("gap", 25_700, 1, 100_000),  # 98 s of rest without a sample
    ("torque", 40_000, 64, NAN_CODE),
    ("speed", 40_200, 64, INFINITY_CODE),
    ("no_angle", 52_600, 100, 0),
    ("gauge_3", 60_000, _ALL, 1_234),  # stuck, and lost from then on
    ("gap", 70_000, 1, 3),
    ("gauge_1", 98_000, _ALL, -_RAIL - 1),  # a second one: the torque is invalid
)

#: Per gauge: zero, and (order, amplitude, phase) of its wave; codes and 2^-16 turn.
_GAUGES: Final[tuple[dict[str, Any], ...]] = (
    {"zero": 120, "wave": ((2, 3277, 0), (4, 100, 700))},
    {"zero": -310, "wave": ((2, 3506, 16111), (4, 90, 33_100))},
    {"zero": 45, "wave": ((2, 3768, 32_695), (4, 110, 1_900))},
    {"zero": 230, "wave": ((2, 3080, 49_480), (4, 95, 31_800))},
)
_CODES_A_VOLT: Final = 2**16 / 20


def _rounded(values: Any) -> Any:
    """Keep seven digits, so that every machine writes the same."""
    if isinstance(values, float):
        return float(f"{values:.7g}")
    return [_rounded(float(v)) if np.ndim(v) == 0 else _rounded(v) for v in values]


def _chain() -> dict[str, Any]:
    """Return gains, calibration and monitor of the four gauges, as commissioning solves them."""
    amplitudes = np.array([[gauge["wave"][0][1] / _CODES_A_VOLT for gauge in _GAUGES]])
    phases = np.array([[2 * math.pi * gauge["wave"][0][2] / 2**16 for gauge in _GAUGES]])
    conditions = compensation_conditions(amplitudes, phases, np.zeros(len(_GAUGES)))
    zeros = np.array([gauge["zero"] / _CODES_A_VOLT for gauge in _GAUGES])
    gains = np.array(_rounded(compensating_gains(conditions).gains))
    sets, _ = gains_without_each([conditions], np.ones(len(_GAUGES)))
    without = [_rounded(each.gains) for each in sets]
    return {
        "converter": {"bits": 16, "minimum_V": -10.0, "maximum_V": 10.0, "lowest_code": -(2**15)},
        "gains": gains.tolist(),
        "calibration": {
            "gain_Nm_per_V": 2.5,
            "zero_V": _rounded(float(gains @ zeros)),
            "full_scale_Nm": FULL_SCALE_NM,
            "linearisation": [0.002, -0.001, 0.0, 0.0],
            "zero_drift_V_per_K": 1e-4,
            "gain_drift_per_K": -2e-4,
        },
        "monitor": {
            "rail_samples": 10,
            "overload_V": 4.0,
            "stuck_samples": 60,
            "flat_travel_turns": 0.5,
            "flat_band_V": 0.01,
            "short_band_V": 0.01,
            "residual_fluctuation_V": round(fluctuation_rms(conditions, gains), 9),
        },
        "consistency": {"samples": 10, "limit_V": 0.12, "limit_per_V": 0.02},
        "directions": _rounded(signal_directions(np.ones(len(_GAUGES)))[0]),
        "gauge_zero_V": _rounded(zeros),
        "wave_V": _rounded(conditions),
        "gains_without": without,
        "zero_shift_V": [_rounded(float((np.array(each) - gains) @ zeros)) for each in without],
        "residual_without_V": [round(fluctuation_rms(conditions, each), 9) for each in without],
    }


def definition() -> dict[str, Any]:
    """Return all that the samples and the chains are made of.

    Returns
    -------
    dict
        As it is kept in ``golden.json``.
    """
    return {
        "samples": SAMPLES,
        "every": EVERY,
        "full_scale_Nm": FULL_SCALE_NM,
        "orders": [2, 4, 6],
        # 1/256 counts a sample: 400,000 are 153 rad/s, 2,500 below the slowest that is learned from.
        "segments": [
            [1500, 0],
            [3000, 400_000],
            [1500, 120_000],
            [2000, -300_000],
            [1200, 0],
            [1000, 2_500],
            [1000, 9_000],
            [1600, 400_000],
        ],
        "speed_step_a_sample": 400,
        # 50 turns before a signed 32-bit count wraps; the motor passes there three times.
        "encoder_start": 2**31 - 50 * 2**16,
        "sequence_start": 2**32 - 30_000,
        "loads_Nm": [0, 10, -12, 30, 5, -28, 0, 18],
        "ripple": [[2, 6554, 3000], [4, 2458, 9000], [6, 328, 0]],
        "codes_a_torque_step_2e16": 5243,
        "gauges": [
            {"zero": gauge["zero"], "wave": [list(each) for each in gauge["wave"]]}
            for gauge in _GAUGES
        ],
        "events": [list(event) for event in _EVENTS],
        "chain": _chain(),
    }
