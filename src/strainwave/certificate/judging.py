"""Values held against stated limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strainwave.certificate.evidence import LoadEvidence
    from strainwave.certificate.session import Session
    from strainwave.joint import Joint

Verdict = Literal["pass", "fail", "not known", "not decided"]
Overall = Literal["pass", "fail", "incomplete", "no limits stated"]

#: Expanded uncertainty over standard uncertainty, for about 95 % of a normal distribution (GUM 6.3.3).
COVERAGE_FACTOR: Final = 2.0

_LABELS: Final = {
    "linearity_error_percent_of_rated_torque": ("Linearity error", "%FS"),
    "hysteresis_percent_of_rated_torque": ("Hysteresis", "%FS"),
    "consistency": ("Consistency measure", "1"),
    "gain_relative_standard_uncertainty": ("Standard uncertainty of the gain, relative", "1"),
    "residual_fluctuation_percent_of_rated_torque": ("Fluctuation left, root mean square", "%FS"),
    "noise_factor": ("Noise factor of the gains", "1"),
    "condition_number": ("Condition number of the gains", "1"),
    "zero_drift_percent_of_rated_torque_per_K": ("Drift of the zero", "%FS/K"),
    "gain_drift_per_K": ("Drift of the gain, relative", "1/K"),
    "largest_error_percent_of_rated_torque": ("Largest error of a reading", "%FS"),
}


@dataclass(frozen=True)
class Judgement:
    """A value beside its limit.

    Attributes
    ----------
    quantity : str
        Key of the limit in the session file, or of the instrument.
    label, unit : str
        What it is.
    limit : float
        Largest magnitude that passes.
    value : float or None
        Its magnitude; None where the joint file does not know it.
    expanded_uncertainty : float or None
        Of the value, 95 %; None where it is not known.
    verdict : {"pass", "fail", "not known", "not decided"}
        "not known" without a value, "not decided" where the rule needs an uncertainty and none is
        known.
    """

    quantity: str
    label: str
    unit: str
    limit: float
    value: float | None
    expanded_uncertainty: float | None
    verdict: Verdict


@dataclass(frozen=True)
class Check:
    """A condition that is no number: an instrument's own certificate.

    Attributes
    ----------
    what, found : str
        What was looked at, and what was found.
    verdict : {"pass", "fail", "not known", "not decided"}
        As for a value.
    """

    what: str
    found: str
    verdict: Verdict


def judgements(joint: Joint, session: Session, loads: LoadEvidence | None) -> tuple[Judgement, ...]:
    """Hold what is known of a joint against the limits of a session.

    Parameters
    ----------
    joint : Joint
        The joint.
    session : Session
        Its limits and the rule of decision.
    loads : LoadEvidence or None
        Readings under known loads, where a table of them was given.

    Returns
    -------
    tuple of Judgement
        One for each limit that is stated.
    """
    known = _known(joint, loads)
    limits = session.limits.model_dump(exclude_none=True)
    result = []
    for quantity, limit in limits.items():
        value, expanded = known.get(quantity, (None, None))
        label, unit = _LABELS[quantity]
        verdict = _verdict(value, expanded, limit, guarded=session.decision_rule == "guarded")
        result.append(Judgement(quantity, label, unit, limit, value, expanded, verdict))
    return tuple(result)


def _verdict(
    value: float | None, expanded: float | None, limit: float, *, guarded: bool
) -> Verdict:
    if value is None:
        return "not known"
    if value > limit:
        return "fail"
    if not guarded:
        return "pass"
    if expanded is None:
        return "not decided"
    return "pass" if value + expanded <= limit else "fail"


Known = dict[str, tuple[float | None, float | None]]


def _known(joint: Joint, loads: LoadEvidence | None) -> Known:
    known: Known = {}
    full_Nm = None if joint.gear is None else joint.gear.rated_torque_Nm
    calibration, gains, drift = joint.torque_calibration, joint.gains, joint.temperature
    if calibration is not None:
        known["linearity_error_percent_of_rated_torque"] = (
            calibration.linearity_error_percent_of_rated_torque,
            None,
        )
        known["hysteresis_percent_of_rated_torque"] = (
            calibration.hysteresis_percent_of_rated_torque,
            None,
        )
        spread = calibration.gain_standard_uncertainty_Nm_per_V
        share = None if spread is None else spread / abs(calibration.gain_Nm_per_V)
        count = calibration.experiment_count
        known["gain_relative_standard_uncertainty"] = (share, None)
        known["consistency"] = (
            calibration.consistency,
            _expanded_of_deviation(calibration.consistency, count),
        )
    if gains is not None:
        known["noise_factor"] = (gains.noise_factor, None)
        known["condition_number"] = (gains.condition_number, None)
    if calibration is not None and full_Nm is not None:
        percent_per_V = 100.0 * abs(calibration.gain_Nm_per_V) / full_Nm
        if gains is not None and gains.residual_fluctuation_V is not None:
            known["residual_fluctuation_percent_of_rated_torque"] = (
                gains.residual_fluctuation_V * percent_per_V,
                None,
            )
        if drift is not None:
            known["zero_drift_percent_of_rated_torque_per_K"] = (
                abs(drift.zero_drift_V_per_K) * percent_per_V,
                None,
            )
    if drift is not None:
        known["gain_drift_per_K"] = (abs(drift.gain_drift_per_K), None)
    if loads is not None:
        known["largest_error_percent_of_rated_torque"] = (loads.largest_error_percent, None)
    return known


def _expanded_of_deviation(deviation: float | None, count: int | None) -> float | None:
    """Give the expanded uncertainty of a standard deviation from `count` values.

    GUM, E.4.3.
    """
    if deviation is None or count is None or count < 2:
        return None
    return COVERAGE_FACTOR * deviation / math.sqrt(2.0 * (count - 1))


def instrument_checks(session: Session) -> tuple[Check, ...]:
    """Say of every instrument whether its own certificate held on the day of the calibration.

    Parameters
    ----------
    session : Session
        The instruments and the day.

    Returns
    -------
    tuple of Check
        One for each instrument.
    """
    checks = []
    for each in session.instruments:
        what = f"{each.name}, serial {each.serial}, certificate {each.certificate}"
        until = each.calibrated_until
        if until is None:
            checks.append(Check(what, "end of its calibration not stated", "not known"))
        elif until < session.day:
            checks.append(Check(what, f"calibrated until {until}, before {session.day}", "fail"))
        else:
            checks.append(Check(what, f"calibrated until {until}", "pass"))
    return tuple(checks)


def overall(judged: Sequence[Judgement], checks: Sequence[Check]) -> Overall:
    """Return the verdict on the whole.

    Parameters
    ----------
    judged : sequence of Judgement
        Values beside their limits.
    checks : sequence of Check
        The instruments.

    Returns
    -------
    {"pass", "fail", "incomplete", "no limits stated"}
        "fail" where anything fails; "incomplete" where anything is not known or not decided.
    """
    verdicts = {each.verdict for each in judged} | {each.verdict for each in checks}
    if "fail" in verdicts:
        return "fail"
    if not judged:
        return "no limits stated"
    return "pass" if verdicts == {"pass"} else "incomplete"
