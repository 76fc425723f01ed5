"""From a joint file to the core's configuration: what the file knows, checked by the core."""

from strainwave.configuration.filters import (
    frozen_terms_of,
    learned_of,
    oscillator_filter_of,
    ripple_filter_of,
)
from strainwave.configuration.gauge_monitor import (
    ConsistencySettings,
    consistency_settings_of,
    gauge_monitor_of,
)
from strainwave.configuration.gear import gear_of
from strainwave.configuration.sensor import (
    calibration_of,
    converter_of,
    gains_of,
    sensor_of,
    verify,
)

__all__ = [
    "ConsistencySettings",
    "calibration_of",
    "consistency_settings_of",
    "converter_of",
    "frozen_terms_of",
    "gains_of",
    "gauge_monitor_of",
    "gear_of",
    "learned_of",
    "oscillator_filter_of",
    "ripple_filter_of",
    "sensor_of",
    "verify",
]
