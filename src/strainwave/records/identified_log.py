"""What `strainwave identify` found, as plain values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.identify.orders import FoundOrder
    from strainwave.identify.recording import Ripple
    from strainwave.identify.ripple_settings import RippleSettings
    from strainwave.identify.torque_or_artefact import TorqueOrArtefact
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey


def measured_text(value: float, standard_uncertainty: float) -> str:
    """Write a value with the digits that its uncertainty leaves it.

    Parameters
    ----------
    value, standard_uncertainty : float
        The value and its standard uncertainty, in the same unit.

    Returns
    -------
    str
        Such as ``160.04 +- 0.17``.
    """
    if not 0.0 < standard_uncertainty < math.inf:
        return f"{value:.7g}"
    digits = max(0, 1 - math.floor(math.log10(standard_uncertainty)))
    return f"{value:.{digits}f} +- {standard_uncertainty:.{digits}f}"


@dataclass(frozen=True)
class Gearing:
    """Ratio and factor m, and where they come from.

    Attributes
    ----------
    ratio : fractions.Fraction or None
        Motor turns per output turn.
    ratio_standard_uncertainty : float or None
        None where the ratio was not measured.
    factor : fractions.Fraction
        Turns of the wave per motor turn, m.
    source : str
        "line", "angles", "told" or "unknown".
    output_direction : int
        1 or -1; 0 where not known.
    says : tuple of str
        Sentences for a person.
    """

    ratio: Fraction | None
    ratio_standard_uncertainty: float | None
    factor: Fraction
    source: str
    output_direction: int = 0
    says: tuple[str, ...] = ()


@dataclass(frozen=True)
class IdentifiedLog:
    """What was found in a recording.

    Attributes
    ----------
    path, out : Path
        The recording, and the joint file that was written.
    layout : Layout
        How the recording was read.
    survey : Survey
        What it holds.
    rated_torque_Nm : float
        Full scale, Nm.
    gearing : Gearing
        Ratio and factor m.
    ripple : Ripple
        Orders, delay, noise, memory, terms.
    judged : TorqueOrArtefact
        Which orders are torque, and which are artefacts of sensing.
    sections : tuple of str
        Sections of the joint file that were filled.
    warnings : tuple of str
        What a person should know, and what the recording does not tell.
    """

    path: Path
    out: Path
    layout: Layout
    survey: Survey
    rated_torque_Nm: float
    gearing: Gearing
    ripple: Ripple
    judged: TorqueOrArtefact
    sections: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def has_time(self) -> bool:
        """Whether the rate follows from time stamps; else it was given."""
        return "time" in self.layout.columns

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            Nothing but texts, finite numbers, lists, dictionaries and None.
        """
        gearing, ripple, survey = self.gearing, self.ripple, self.survey
        settings, delay = ripple.settings, ripple.delay
        return {
            "input": str(self.path),
            "output": str(self.out),
            "ratio": None if gearing.ratio is None else float(gearing.ratio),
            "ratio_standard_uncertainty": gearing.ratio_standard_uncertainty,
            "ratio_source": gearing.source,
            "factor_m": float(gearing.factor),
            "output_direction": gearing.output_direction or None,
            "delay_s": None if delay is None else delay.delay_s,
            "delay_standard_uncertainty_s": (
                None if delay is None else delay.standard_uncertainty_s
            ),
            "memory_turns": None if settings is None else settings.config.memory_turns,
            "memory_interval_turns": _listed(settings),
            "noise_Nm": ripple.noise_Nm,
            "noise_standard_uncertainty_Nm": ripple.noise.standard_uncertainty_Nm,
            "noise_source": ripple.noise.source,
            "orders": [self._order_as_dict(order) for order in ripple.present],
            "reference": self._reference_as_dict(),
            "cycles_per_output_turn": [
                {
                    "cycles": each.cycles,
                    "amplitude_Nm": each.amplitude_Nm,
                    "amplitude_standard_uncertainty_Nm": each.amplitude_standard_uncertainty_Nm,
                    "evidence": each.evidence,
                }
                for each in ripple.output_cycles
            ],
            "terms": {
                "load": settings is not None and settings.terms.load,
                "speed": settings is not None and settings.terms.speed,
                "direction": settings is not None and settings.terms.direction,
                "is_chosen": settings is not None and settings.is_chosen,
            },
            "rated_torque_Nm": self.rated_torque_Nm,
            "rated_torque_source": self.layout.rated_torque_source,
            "rate_Hz": survey.timing.rate_Hz,
            "rate_standard_uncertainty_Hz": (
                survey.timing.rate_standard_uncertainty_Hz if self.has_time else None
            ),
            "rows": survey.rows,
            "share_repeated": survey.share_repeated,
            "shortest_interval_s": survey.timing.smallest_interval_s,
            "longest_interval_s": survey.timing.largest_interval_s,
            "motor_turns": ripple.motor_turns,
            "sections": list(self.sections),
            "warnings": list(self.warnings),
        }

    def _order_as_dict(self, order: FoundOrder) -> dict[str, Any]:
        verdict = self.judged.of(order.order)
        share = verdict.share
        return {
            "order": order.order,
            "amplitude_Nm": order.amplitude_Nm,
            "phase_rad": order.phase_rad,
            "amplitude_standard_uncertainty_Nm": order.amplitude_standard_uncertainty_Nm,
            "is_steady": order.is_steady,
            "evidence": order.evidence,
            "decision": verdict.decision,
            "torque_share": None if share is None else share.value,
            "torque_share_standard_uncertainty": (
                None if share is None else share.standard_uncertainty
            ),
            "torque_Nm": verdict.torque_Nm,
            "torque_standard_uncertainty_Nm": verdict.torque_standard_uncertainty_Nm,
            "artefact_Nm": verdict.artefact_Nm,
            "artefact_standard_uncertainty_Nm": verdict.artefact_standard_uncertainty_Nm,
            "basis": verdict.basis,
            "why_undecidable": verdict.reason or None,
        }

    def _reference_as_dict(self) -> dict[str, Any] | None:
        found = self.judged.agreement
        if found is None:
            return None
        return {
            "gain": found.gain,
            "gain_standard_uncertainty": found.gain_standard_uncertainty,
            "delay_s": found.delay_s,
            "delay_standard_uncertainty_s": found.delay_standard_uncertainty_s,
            "lag_square_s2": found.lag_square_s2,
            "lag_square_standard_uncertainty_s2": found.lag_square_standard_uncertainty_s2,
        }


def _listed(settings: RippleSettings | None) -> list[float] | None:
    interval = None if settings is None else settings.memory_interval_turns
    return None if interval is None else list(interval)
