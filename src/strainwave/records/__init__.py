"""Recordings of joints: read in chunks whatever their length, surveyed, filtered and written."""

from strainwave.records.filtered_log import FilteredLog
from strainwave.records.filtering import filter_log
from strainwave.records.layout import Layout
from strainwave.records.mapping import MappedColumn, format_mapping, parse_mapping
from strainwave.records.opening import open_recording
from strainwave.records.options import Options, parse_ratio
from strainwave.records.survey import Survey

__all__ = [
    "FilteredLog",
    "Layout",
    "MappedColumn",
    "Options",
    "Survey",
    "filter_log",
    "format_mapping",
    "open_recording",
    "parse_mapping",
    "parse_ratio",
]
