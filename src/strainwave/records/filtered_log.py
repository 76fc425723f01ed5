"""What was found in a recording and done with it, for people and for `--json`."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from strainwave.records.mapping import format_mapping

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave._core import Rational
    from strainwave.identify.ripple_settings import RippleSettings
    from strainwave.methods.time_chunks import TimeChunks
    from strainwave.records.gauge_watch import WatchedGauges
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey


@dataclass(frozen=True)
class FilteredLog:
    """What was done.

    Attributes
    ----------
    path : Path
        The recording.
    out : Path or None
        The file of cleaned torque; None where none was asked for.
    layout : Layout
        How the recording was read.
    survey : Survey
        What it holds.
    method : str
        Name of the method.
    rated_torque_Nm : float
        Full scale, Nm.
    warnings : tuple of str
        What a person should know.
    wave_factor : float
        The gear's factor m that was used where orders follow it.
    wave_factor_source : str
        "joint file", "recording" or "assumed".
    ripple_settings : RippleSettings or None
        What the ripple filter was told or chose; None for other methods.
    misalignment_terms : int
        Terms of the joint file's misalignment that were removed.
    rows_by_flag : dict
        Rows by the name of the status flag that they bear.
    torque_before_rms_Nm, torque_after_rms_Nm, ripple_rms_Nm : float or None
        Over the rows without a fault, Nm; None where every row has one.
    gauges : WatchedGauges or None
        What the watch over the gauges found; None where there was none.
    time_chunks : TimeChunks or None
        How the recording was cut to be filtered side by side; None where it was filtered in
        sequence.
    """

    path: Path
    out: Path | None
    layout: Layout
    survey: Survey
    method: str
    rated_torque_Nm: float
    warnings: tuple[str, ...]
    wave_factor: float = 1.0
    wave_factor_source: str = "assumed"
    ripple_settings: RippleSettings | None = None
    misalignment_terms: int = 0
    rows_by_flag: dict[str, int] = field(default_factory=dict)
    torque_before_rms_Nm: float | None = None
    torque_after_rms_Nm: float | None = None
    ripple_rms_Nm: float | None = None
    gauges: WatchedGauges | None = None
    time_chunks: TimeChunks | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            Nothing but texts, finite numbers, lists, dictionaries and None.
        """
        survey, layout = self.survey, self.layout
        return {
            "input": str(self.path),
            "output": None if self.out is None else str(self.out),
            "rows": survey.rows,
            "rate_Hz": survey.timing.rate_Hz,
            "method": self.method,
            "settings": {
                "map": format_mapping(layout.columns),
                "angle_side": layout.angle_side,
                "ratio": None if layout.ratio is None else float(layout.ratio),
                "sample_period_s": survey.timing.median_interval_s,
                "load_inertia_kg_m2": layout.load_inertia_kg_m2,
                "wave_factor": self.wave_factor,
                "wave_factor_source": self.wave_factor_source,
                "misalignment_terms": self.misalignment_terms,
                **self._of_the_ripple_filter(),
            },
            "rated_torque_Nm": self.rated_torque_Nm,
            "rated_torque_source": layout.rated_torque_source,
            "rows_by_flag": self.rows_by_flag,
            "torque_before_rms_Nm": self.torque_before_rms_Nm,
            "torque_after_rms_Nm": self.torque_after_rms_Nm,
            "ripple_rms_Nm": self.ripple_rms_Nm,
            "time_chunks": None if self.time_chunks is None else asdict(self.time_chunks),
            "gauge_watch": None if self.gauges is None else self.gauges.as_dict(),
            "warnings": list(self.warnings),
            "survey": {
                **asdict(survey.timing),
                **asdict(survey.moving),
                "angle_is_wrapped": survey.angle_is_wrapped,
                "angle_looks_like_degrees": survey.angle_looks_like_degrees,
                "angle_lowest_rad": survey.angle_lowest_rad,
                "angle_highest_rad": survey.angle_highest_rad,
                "torque_lowest_Nm": survey.torque_lowest_Nm,
                "torque_highest_Nm": survey.torque_highest_Nm,
                "missing_by_key": survey.missing_by_key,
                "share_at_rest": survey.share_at_rest,
                "share_repeated": survey.share_repeated,
            },
        }

    def _of_the_ripple_filter(self) -> dict[str, Any]:
        settings = self.ripple_settings
        if settings is None:
            return {}
        config = settings.config
        return {
            "orders": [_value(each.order) for each in config.orders],
            "load_orders": [_value(each.order) for each in config.orders if each.with_load],
            "speed_orders": [_value(each.order) for each in config.orders if each.with_speed],
            "direction_orders": [
                _value(each.order) for each in config.orders if each.with_direction
            ],
            "memory_turns": config.memory_turns,
            "angle_to_torque_delay_s": config.angle_to_torque_delay_s,
            "chosen_by_likelihood": settings.is_chosen,
        }


def _value(order: Rational) -> float:
    return order.numerator / order.denominator
