"""The demo's part on what the published tuning does to true torque."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.figures_tuning import contact_figure, pass_through_figure
from strainwave.report.page import Item, Part, PlainTable
from strainwave.reproduce.tuning import FOUR_STATES, FOUR_STATES_SLOW, SETTLING_S, SIX_STATES

if TYPE_CHECKING:
    from strainwave.reproduce.tuning import TuningStudy


def tuning_part(study: TuningStudy) -> Part:
    """Say in plain words what Q = 1e3 I, R = 1 does to torque that was not expected.

    Parameters
    ----------
    study : TuningStudy
        Responses of the tunings.

    Returns
    -------
    Part
        A section of the page.
    """
    four = study.by_name(FOUR_STATES)
    six = study.by_name(SIX_STATES)
    slow = study.by_name(FOUR_STATES_SLOW)

    def gain_dB(response: object, frequency_Hz: float) -> float:
        measured = response.pass_through  # type: ignore[attr-defined]
        return float(np.interp(frequency_Hz, measured.frequency_Hz, measured.gain_dB))

    through = 100 * 10 ** (gain_dB(four, 1.0) / 20)
    height_Nm = six.contact.contact_torque_Nm
    return Part(
        anchor="tuning",
        title="What the published tuning does to true torque",
        paragraphs=(
            "The filter subtracts everything it can predict. With Q = 1000 I and R = 1 it trusts "
            "its oscillators a thousand times more readily to change than it trusts the torque "
            "signal to be noisy, so it bends them until they explain nearly all that was measured. "
            "Ripple goes, and so does every torque that the expected torque does not contain: a "
            "hand on the arm, a payload, gravity.",
            f"At 156 rad/s, of a true torque that changes once a second {through:.0f} % reaches "
            f"the output of the filter with four states ({gain_dB(four, 1.0):.1f} dB); at 50 rad/s "
            f"it is {gain_dB(slow, 1.0):.0f} dB, and with six states {gain_dB(six, 1.0):.0f} dB. "
            f"A contact of {height_Nm:g} Nm reads {six.contact.at(0.02):.2f} Nm after 20 ms with "
            "six states. In free motion none of this shows, because there the expected torque is "
            "nearly the whole torque: figures 9 and 11 cannot warn of it.",
        ),
        warning="The published tuning swallows true torque. It is kept here for comparison and "
        "study, and is no default of strainwave.",
        items=(
            Item(
                title="Pass-through of true torque",
                paragraphs=(
                    "A sine of true torque goes in, at constant speed and without any ripple, and "
                    "is not expected; 0 dB and 0 ms would be a filter that touches ripple alone.",
                ),
                figure=pass_through_figure(study),
                caption="Computed by running the filters. The notches are orders 2 and 4. With "
                "Q/R = 1e-5 the same filter leaves true torque alone outside narrow notches, and "
                f"follows a change of the ripple with a time constant of {SETTLING_S:.2f} s "
                "(T_s over the root of Q/2R).",
                alternative="Gain of true torque: minus 5.5 decibels with four states, falling to "
                "minus 60 with six; zero with a small tuning except at two notches.",
                table=_table(study),
            ),
            Item(
                title="A contact",
                figure=contact_figure(study),
                caption="Computed by running the filters on a step of true torque that is not "
                "expected.",
                alternative="A step of 10 newton metres: 5 are left with four states, none with "
                "six, all with a small tuning.",
            ),
        ),
    )


def _table(study: TuningStudy) -> PlainTable:
    rows = []
    for response in study.responses:
        measured = response.pass_through
        gain_dB = np.interp([1.0, 5.0], measured.frequency_Hz, measured.gain_dB)
        delay_ms = 1e3 * np.interp(5.0, measured.frequency_Hz, measured.delay_s)
        rows.append(
            (
                response.name,
                f"{gain_dB[0]:.1f} dB",
                f"{gain_dB[1]:.1f} dB",
                f"{delay_ms:.1f} ms",
                f"{response.contact.at(0.02):.2f} Nm",
            )
        )
    return PlainTable(
        (
            "Tuning",
            "Gain at 1 Hz",
            "Gain at 5 Hz",
            "Delay at 5 Hz",
            "10 Nm contact after 20 ms",
        ),
        tuple(rows),
    )
