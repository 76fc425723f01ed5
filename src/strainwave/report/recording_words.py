"""The sentences at the head of a recording's page, and how its numbers are written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from strainwave.evidence.flags import NOT_USED_BECAUSE
from strainwave.fidelity.verdict import STEP_ERROR_LIMIT, SWALLOWS
from strainwave.report.style import true_minus

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strainwave.evidence import Evidence
    from strainwave.records import FilteredLog

#: Between a number and its unit.
NO_BREAK: Final = "\N{NO-BREAK SPACE}"
#: The share below which its figure is not written, percent.
_NOTHING_PERCENT: Final = 0.01
#: An amplitude less than this many times what noise reads is no finding.
_NEAR_NOISE: Final = 1.5


def torque_text(torque_Nm: float) -> str:
    """Write a torque with three digits and its unit.

    Parameters
    ----------
    torque_Nm : float
        Torque, Nm.

    Returns
    -------
    str
        Such as ``0.93 Nm``.
    """
    return f"{number_text(torque_Nm)}{NO_BREAK}Nm"


def number_text(value: float) -> str:
    """Write a number with three digits, without an exponent where it can be read so.

    Parameters
    ----------
    value : float
        The number.

    Returns
    -------
    str
        Such as ``0.0213`` or ``12000``.
    """
    plain = f"{float(f'{value:.3g}'):.6f}".rstrip("0").rstrip(".")
    readable = value == 0 or 1e-4 <= abs(value) < 1e7
    return true_minus(plain if readable else f"{value:.3g}")


def share_text(share: float | None) -> str:
    """Write a share of a whole, such as a relative error, in percent with two digits.

    Parameters
    ----------
    share : float or None
        The share, 1 for all.

    Returns
    -------
    str
        Such as ``1.9 %``; a dash for None.
    """
    if share is None:
        return "\N{EN DASH}"
    percent = 100.0 * share
    if percent < _NOTHING_PERCENT:
        return f"less than {_NOTHING_PERCENT:g}{NO_BREAK}%"
    return f"{number_text(float(f'{percent:.2g}'))}{NO_BREAK}%"


def change_text(change_dB: float | None) -> str:
    """Write a change of amplitude in dB.

    Parameters
    ----------
    change_dB : float or None
        The change.

    Returns
    -------
    str
        Such as ``−18.2 dB``; a dash for None.
    """
    if change_dB is None:
        return "\N{EN DASH}"
    # Rounded first, so that nothing has no sign.
    rounded_dB = round(change_dB, 1) or 0.0
    return f"{true_minus(f'{rounded_dB:.1f}')}{NO_BREAK}dB"


def with_plus_minus(text: str) -> str:
    """Put the sign between a value and its uncertainty that a terminal may not have.

    Parameters
    ----------
    text : str
        Text with `` +- ``.

    Returns
    -------
    str
        The same with plus-minus signs.
    """
    return text.replace(" +- ", f"{NO_BREAK}\N{PLUS-MINUS SIGN}{NO_BREAK}")


def sentence(text: str) -> str:
    """End a text with a full stop, where it does not end otherwise.

    Parameters
    ----------
    text : str
        The text.

    Returns
    -------
    str
        A sentence that begins as the text does.
    """
    text = with_plus_minus(text)
    return text if text.endswith(("?", ".", "!")) else f"{text}."


def sentences(texts: Sequence[str]) -> tuple[str, ...]:
    """Make sentences of warnings.

    Parameters
    ----------
    texts : sequence of str
        Warnings.

    Returns
    -------
    tuple of str
        Each with a capital and a full stop.
    """
    return tuple(sentence(f"{each[:1].upper()}{each[1:]}") for each in texts)


def rows_text(count: int) -> str:
    """Write a number of rows.

    Parameters
    ----------
    count : int
        How many.

    Returns
    -------
    str
        Such as ``1 row`` or ``12000 rows``.
    """
    return "1 row" if count == 1 else f"{count} rows"


def head_sentences(log: FilteredLog, evidence: Evidence) -> tuple[str, str, str]:
    """Say in three sentences what became of a recording.

    Parameters
    ----------
    log : FilteredLog
        What was done.
    evidence : Evidence
        What is known of it.

    Returns
    -------
    tuple of str
        On the ripple, on true torque, and on the rows.
    """
    return _on_ripple(log, evidence), _on_torque(evidence), _on_rows(evidence)


def _on_ripple(log: FilteredLog, evidence: Evidence) -> str:
    if evidence.lines and not evidence.removed:
        return "No ripple is removed: the orders that are followed are kept, as real torque."
    if not evidence.removed:
        return (
            f"The motor makes {number_text(evidence.motor_turns)} turns here, too few in one "
            "direction to say what became of the ripple."
        )
    line = evidence.removed[0]
    change = (
        f"went from {torque_text(line.before_rms_Nm)} to {torque_text(line.after_rms_Nm)} "
        f"({change_text(line.change_dB)})"
    )
    place = f"{line.order:.5g} cycles per motor turn"
    if not line.is_told:
        return f"Method {log.method} follows no order; the torque at {place} {change}."
    if line.before_rms_Nm < _NEAR_NOISE * line.noise_Nm:
        return f"There is hardly any ripple here: at {place} the torque {change}, which is noise."
    if len(evidence.removed) == 1:
        return f"The ripple at {place} {change}."
    return f"The ripple is strongest at {place}, where it {change}."


def _on_torque(evidence: Evidence) -> str:
    contacts = evidence.contacts
    if not contacts:
        return (
            "No contact could be added to this recording, because it has no motion or rest long "
            "enough; what the tuning does to true torque is said by strainwave fidelity."
        )
    later = [each.error_at_20_ms for each in contacts if each.error_at_20_ms is not None]
    where = "one moment" if len(contacts) == 1 else f"{len(contacts)} moments"
    after = f", and of {share_text(max(later))} after 20{NO_BREAK}ms" if later else ""
    return (
        f"A contact of {torque_text(contacts[0].height_Nm)} that was added to this very recording at "
        f"{where} came through with an error of at most {_largest_errors(evidence)}{after}."
    )


def _largest_errors(evidence: Evidence) -> str:
    """Largest error of all contacts; apart from it that of a push which no such filter can pass."""
    near = [each.largest_error for each in evidence.contacts if each.is_near_order]
    others = [each.largest_error for each in evidence.contacts if not each.is_near_order]
    if not near or not others:
        return share_text(max([*near, *others]))
    return f"{share_text(max(others))} ({share_text(max(near))} for a slow push that turns like the ripple)"


def _on_rows(evidence: Evidence) -> str:
    repeated = ""
    if evidence.repeated_rows:
        repeated = f" {rows_text(evidence.repeated_rows)} only repeat the row before."
    if not evidence.rejected_rows:
        return f"All {evidence.rows} rows could be used.{repeated}"
    reasons = [
        f"{each.rows} {NOT_USED_BECAUSE[each.name]}"
        for each in evidence.flags
        if each.name in NOT_USED_BECAUSE
    ]
    return (
        f"{evidence.rejected_rows} of {rows_text(evidence.rows)} could not be used: "
        f"{', '.join(reasons)}.{repeated}"
    )


def verdict(log: FilteredLog, evidence: Evidence) -> tuple[str, bool]:
    """Judge whether true torque comes through, from the contacts and the warnings.

    Parameters
    ----------
    log : FilteredLog
        What was done.
    evidence : Evidence
        What is known of it.

    Returns
    -------
    tuple of str and bool
        The sentence, empty where nothing can be said, and whether it is good.
    """
    limit = f"{100 * STEP_ERROR_LIMIT:g}{NO_BREAK}%"
    warned = [each for each in log.warnings if SWALLOWS in each]
    swallowed = [each for each in evidence.contacts if each.is_swallowed]
    if swallowed:
        worst = max(swallowed, key=lambda each: each.error_at_20_ms or 0.0)
        return (
            f"Do not take this torque for a contact: method {log.method} swallows true torque here. "
            f"20 ms after a contact its output is still wrong by {share_text(worst.error_at_20_ms)} of "
            f"it, more than the {limit} that strainwave fidelity allows.",
            False,
        )
    if warned:
        return f"Beware: {sentence(warned[0])}", False
    if any(each.error_at_20_ms is not None for each in evidence.contacts):
        return (
            f"True torque comes through: every contact within the limit of {limit} after 20 ms.",
            True,
        )
    return "", True


def fidelity_beside(evidence: Evidence) -> str:
    """Say what came through of contacts, to stand beside every attenuation.

    Parameters
    ----------
    evidence : Evidence
        What is known of the recording.

    Returns
    -------
    str
        A sentence.
    """
    if not evidence.contacts:
        return "What came through of true torque could not be measured on this recording."
    return (
        "The same run passed added contacts of "
        f"{torque_text(evidence.contacts[0].height_Nm)} with an error of at most "
        f"{_largest_errors(evidence)}."
    )
