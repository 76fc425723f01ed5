"""The demo's part on what the published tuning does to true torque."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.figures_tuning import contact_figure, pass_through_figure
from strainwave.report.page import Item, Part, PlainTable
from strainwave.report.style import true_minus
from strainwave.reproduce.tuning import (
    FOUR_STATES,
    FOUR_STATES_SLOW,
    FULL_SPEED_RAD_S,
    SETTLING_S,
    SIX_STATES,
    SLOW_SPEED_RAD_S,
)

if TYPE_CHECKING:
    from strainwave.reproduce.tuning import TuningResponse, TuningStudy


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

    def percent(response: TuningResponse) -> float:
        measured = response.pass_through
        return 100 * float(np.interp(1.0, measured.frequency_Hz, measured.gain))

    def gain_dB(response: TuningResponse, frequency_Hz: float) -> str:
        measured = response.pass_through
        return _decibels(float(np.interp(frequency_Hz, measured.frequency_Hz, measured.gain_dB)))

    height_Nm = six.contact.contact_torque_Nm
    return Part(
        anchor="tuning",
        title="What the published tuning does to true torque",
        paragraphs=(
            "The filter predicts the next sample from oscillators at the ripple's frequencies and "
            "subtracts the prediction. The ratio Q/R says how fast the oscillators may change. "
            "Q/R = 1000 lets them follow the signal within a sample or two, so they explain "
            "whatever is there, ripple or not. Ripple goes, and with it much of every torque that "
            "the expected torque does not contain: a hand on the arm, a payload, gravity. How "
            "much depends on speed and on the number of states.",
            f"At {FULL_SPEED_RAD_S:g} rad/s, of a true torque that changes once a second {percent(four):.0f} % reaches "
            f"the output of the filter with four states ({gain_dB(four, 1.0)}); at "
            f"{SLOW_SPEED_RAD_S:g} rad/s it is {percent(slow):.0f} % ({gain_dB(slow, 1.0)}), and "
            f"with six states {percent(six):.1f} % ({gain_dB(six, 1.0)}). "
            f"A contact of {height_Nm:g} Nm reads {true_minus(f'{six.contact.at(0.02):.2f}')} Nm after 20 ms with "
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
                "(T_s over the root of Q/2R). With six states the gain falls below the axis under "
                "0.3 Hz and the delay leaves it under 0.8 Hz. Delays are not drawn within "
                "3 Hz of a notch, where hardly anything passes.",
                alternative="Gain of true torque: about half with four states, falling towards "
                "nothing at low frequencies with six; zero with a small tuning except at two notches.",
                table=_table(study),
            ),
            Item(
                title="A contact",
                paragraphs=(
                    "The same filters when something pushes on the arm at constant speed. What a "
                    "controller would see depends on the tuning: half of the push, a seventh, a "
                    "kick that dies within milliseconds, or the push itself.",
                ),
                figure=contact_figure(study),
                caption="Computed by running the filters on a step of true torque that is not "
                "expected.",
                alternative="A step of 10 newton metres: half of it is left with four states, none with "
                "six, all with a small tuning.",
            ),
        ),
    )


def _decibels(gain_dB: float) -> str:
    # No "-0.0".
    return true_minus(f"{round(gain_dB, 1) + 0.0:.1f} dB")


def _table(study: TuningStudy) -> PlainTable:
    rows = []
    for response in study.responses:
        measured = response.pass_through
        gain_dB = np.interp([1.0, 5.0], measured.frequency_Hz, measured.gain_dB)
        delay_ms = 1e3 * np.interp(5.0, measured.frequency_Hz, measured.delay_s)
        rows.append(
            (
                response.name,
                _decibels(gain_dB[0]),
                _decibels(gain_dB[1]),
                true_minus(f"{delay_ms:.1f} ms"),
                true_minus(f"{response.contact.at(0.02):.2f} Nm"),
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
