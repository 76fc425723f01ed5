"""Sections of a joint that several tests build on."""

import math
from datetime import UTC, datetime
from typing import Any

from strainwave.joint import Gauges, Gear, Provenance, Rosette

PROVENANCE = Provenance(
    input="entered by hand", created=datetime(2026, 11, 1, tzinfo=UTC), version="0.1.0"
)
OSCILLATOR = {
    "method": "oscillator",
    "process_noise_variances_Nm2": [1e3],
    "measurement_noise_variance_Nm2": 1.0,
    "initial_variance_Nm2": 1.0,
    "sample_period_s": 1e-3,
}


def gauges(count: int, wiring: str = "half_bridge_each", **more: Any) -> Gauges:
    rosettes = tuple(
        Rosette(position_rad=math.pi * j / count, gauge_factor=2.0) for j in range(count)
    )
    return Gauges.model_validate(
        {
            "wiring": wiring,
            "bridge_supply_V": 10.0,
            "amplifier_gain": 1000.0,
            "rosettes": rosettes,
            "provenance": PROVENANCE,
            **more,
        }
    )


def gear(ratio: float = 100.0) -> Gear:
    return Gear(
        configuration="fixed_circular_spline",
        ratio=ratio,
        rated_torque_Nm=40.0,
        provenance=PROVENANCE,
    )
