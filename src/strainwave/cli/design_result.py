"""The result of `strainwave design layout` as plain values, for `--json`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from strainwave.design.comparison import Care, Comparison
    from strainwave.design.layout import Distribution, LayoutStudy


def as_dict(study: LayoutStudy, comparison: Comparison | None) -> dict[str, Any]:
    """Write a study as plain values.

    Parameters
    ----------
    study : LayoutStudy
        The study.
    comparison : Comparison, optional
        The comparison over the number of gauges.

    Returns
    -------
    dict
        As docs/reference/design-layout-command.md lists it.
    """
    from strainwave.design.case import assumptions, remarks
    from strainwave.design.sensitivity import sensitivities

    case = study.case
    lost = None
    if study.lost_tuned is not None and study.lost_untuned is not None:
        lost = _distribution(study.lost_tuned) | {"untuned": _distribution(study.lost_untuned)}
    return {
        "gauges": case.gauges,
        "harmonics": case.harmonics,
        "trials": study.trials,
        "seed": study.seed,
        "limit_FS": study.limit_FS,
        **_distribution(study.tuned),
        "untuned": _distribution(study.untuned),
        "lost_gauge": lost,
        "parts_FS": {name: _percentiles(values) for name, values in study.parts_FS.items()},
        "tolerances": case.tolerances.as_dict(),
        "wave_FS": list(case.wave.amplitudes_FS),
        "measurement_error_FS": case.measurement_error_FS,
        "quantise": None if case.circuit is None else case.circuit.name,
        "sensitivities": [
            {
                "error": each.error,
                "per": each.per,
                "gauge_torque_percent": each.gauge_torque_percent,
                "sum_torque_percent": each.sum_torque_percent,
                "ripple_FS": list(each.ripple_FS),
            }
            for each in sensitivities(case)
        ],
        "comparison": None if comparison is None else _comparison(comparison),
        "assumptions": list(assumptions(case)),
        "warnings": list(remarks(case)),
    }


def _comparison(comparison: Comparison) -> dict[str, Any]:
    return {
        "question": comparison.question,
        "verdict": comparison.verdict,
        "answers": list(comparison.answers),
        "careless": _studies(comparison.careless, comparison.careless_studies),
        "careful": _studies(comparison.careful, comparison.careful_studies),
    }


def _studies(care: Care, studies: tuple[LayoutStudy, ...]) -> dict[str, Any]:
    return {
        "position_tolerance_deg": care.position_deg,
        "amplitude_tolerance": care.amplitude,
        "layouts": [
            {
                "gauges": study.case.gauges,
                "harmonics": study.case.harmonics,
                "trials": study.trials,
                **_distribution(study.tuned),
                "untuned": _distribution(study.untuned),
            }
            for study in studies
        ],
    }


def _distribution(found: Distribution) -> dict[str, Any]:
    return {
        "residual_FS": _percentiles(found.residual_FS),
        "noise_factor": _percentiles(found.noise_factor),
        "negative_gain_share": found.negative_gain_share,
        "refused_share": found.refused_share,
        "yield": found.met_limit,
        "yield_standard_error": found.met_limit_error,
    }


def _percentiles(values: dict[int, float]) -> dict[str, float]:
    return {str(percentile): value for percentile, value in values.items()}
