"""The joint file: the one place where what is known of a joint is kept."""

from strainwave.joint.canonical import (
    canonical_form,
    canonical_hash,
    canonical_json,
    section_hash,
)
from strainwave.joint.document import JointFile
from strainwave.joint.file import (
    build_section,
    new_joint,
    parse_joint,
    read_joint,
    write_joint,
)
from strainwave.joint.gains import Gains, GainsWithoutGauge, GaugeSignal
from strainwave.joint.gauges import Gauges, Rosette
from strainwave.joint.gear import Gear
from strainwave.joint.history import HistoryEntry
from strainwave.joint.migrations import SCHEMA_VERSION
from strainwave.joint.misalignment import Misalignment, MisalignmentTerm
from strainwave.joint.model import SECTION_MODELS, SECTION_NAMES, Identity, Joint
from strainwave.joint.orders import order_value
from strainwave.joint.oscillator_filter import OscillatorFilter
from strainwave.joint.provenance import Provenance, Section
from strainwave.joint.ripple_filter import RippleFilter
from strainwave.joint.signals import (
    AngleColumn,
    Column,
    Signals,
    SpeedColumn,
    TemperatureColumn,
    TimeColumn,
    TorqueColumn,
    VoltageColumn,
)
from strainwave.joint.temperature import Temperature
from strainwave.joint.torque_calibration import TorqueCalibration
from strainwave.units import Conversion, conversion

__all__ = [
    "SCHEMA_VERSION",
    "SECTION_MODELS",
    "SECTION_NAMES",
    "AngleColumn",
    "Column",
    "Conversion",
    "Gains",
    "GainsWithoutGauge",
    "GaugeSignal",
    "Gauges",
    "Gear",
    "HistoryEntry",
    "Identity",
    "Joint",
    "JointFile",
    "Misalignment",
    "MisalignmentTerm",
    "OscillatorFilter",
    "Provenance",
    "RippleFilter",
    "Rosette",
    "Section",
    "Signals",
    "SpeedColumn",
    "Temperature",
    "TemperatureColumn",
    "TimeColumn",
    "TorqueCalibration",
    "TorqueColumn",
    "VoltageColumn",
    "build_section",
    "canonical_form",
    "canonical_hash",
    "canonical_json",
    "conversion",
    "new_joint",
    "order_value",
    "parse_joint",
    "read_joint",
    "section_hash",
    "write_joint",
]
