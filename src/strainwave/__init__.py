"""strainwave: clean joint torque from the strain gauges inside a strain wave gear.

The arithmetic is the C++ core's, the same headers that run on a microcontroller; this package
drives it with arrays. Angles are mechanical and in rad, torque is in Nm on the output side.
"""

from typing import TYPE_CHECKING

from strainwave._core import (
    Amplifier,
    ConsistencyCheck,
    Converter,
    EncoderCounter,
    FrozenTerm,
    Gains,
    GainsWithoutGauge,
    GaugeFault,
    GaugeFluctuation,
    GaugeMonitorConfig,
    Gear,
    GearConfiguration,
    LearnedRipple,
    OscillatorFilterConfig,
    Phase,
    Rational,
    RippleFilterConfig,
    RippleOrder,
    Rosette,
    RotationSource,
    StatusFlag,
    TornGaugeRail,
    TorqueCalibration,
    TorqueSensorConfig,
    equally_spaced_position_rad,
    full_bridge_V,
    nominal_ratio,
    signed_reduction_ratio,
)
from strainwave.errors import ConfigurationError, InputError, StrainwaveError
from strainwave.filter import FilterResult, OscillatorFilter, oscillator_preset
from strainwave.ripple_filter import RippleFilter, RippleResult
from strainwave.sensor import SensorResult, TorqueSensor

if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name: str) -> str:
        if name != "__version__":
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        # Who does not ask for it does not wait for what reads it.
        from importlib.metadata import version  # noqa: PLC0415

        return version("strainwave")


__all__ = [
    "Amplifier",
    "ConfigurationError",
    "ConsistencyCheck",
    "Converter",
    "EncoderCounter",
    "FilterResult",
    "FrozenTerm",
    "Gains",
    "GainsWithoutGauge",
    "GaugeFault",
    "GaugeFluctuation",
    "GaugeMonitorConfig",
    "Gear",
    "GearConfiguration",
    "InputError",
    "LearnedRipple",
    "OscillatorFilter",
    "OscillatorFilterConfig",
    "Phase",
    "Rational",
    "RippleFilter",
    "RippleFilterConfig",
    "RippleOrder",
    "RippleResult",
    "Rosette",
    "RotationSource",
    "SensorResult",
    "StatusFlag",
    "StrainwaveError",
    "TornGaugeRail",
    "TorqueCalibration",
    "TorqueSensor",
    "TorqueSensorConfig",
    "__version__",
    "equally_spaced_position_rad",
    "full_bridge_V",
    "nominal_ratio",
    "oscillator_preset",
    "signed_reduction_ratio",
]
