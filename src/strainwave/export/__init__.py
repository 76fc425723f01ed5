"""From a joint file to C++ and C: a header with the configuration as constants, and its proof."""

from strainwave.export.agreement import Agreement, check_header
from strainwave.export.names import joint_identifier
from strainwave.export.source import ExportedJoint, ExportedSource, exported, rendered
from strainwave.export.writing import write_source

__all__ = [
    "Agreement",
    "ExportedJoint",
    "ExportedSource",
    "check_header",
    "exported",
    "joint_identifier",
    "rendered",
    "write_source",
]
