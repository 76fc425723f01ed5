"""The picture of before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.report.style import BLUE, GREY, ORANGE, figure_style, new_figure, true_minus
from strainwave.reproduce.overview import CONTACT_FROM_S, CONTACT_NM, CONTACT_TO_S

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.reproduce.overview import Overview


def before_and_after_figure(result: Overview) -> Figure:
    """Draw torque before and after, with a contact that must stay.

    Parameters
    ----------
    result : Overview
        One run.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels, about the contact and its beginning, with what they show in figures beneath.
    """
    with figure_style():
        figure = new_figure(3.7)
        wide, near = figure.subplots(1, 2, sharey=True, width_ratios=(1.5, 1))
        for axes, from_s, to_s in (
            (wide, CONTACT_FROM_S - 0.4, CONTACT_TO_S + 0.4),
            (near, CONTACT_FROM_S - 0.05, CONTACT_FROM_S + 0.15),
        ):
            shown = (result.time_s >= from_s) & (result.time_s <= to_s)
            time_s = result.time_s[shown]
            axes.plot(
                time_s, result.measured_Nm[shown], color=GREY, linewidth=0.8, label="measured"
            )
            axes.plot(time_s, result.clean_Nm[shown], color=BLUE, label="ripple removed")
            axes.plot(
                time_s,
                result.true_Nm[shown],
                color=ORANGE,
                linewidth=1,
                linestyle=(0, (4, 2)),
                label="true torque",
            )
            axes.set(xlabel="time (s)", xlim=(from_s, to_s))
        wide.set(ylabel="torque (Nm)", title="Simulated joint, touched while it turns")
        near.set(title="The touch begins")
        figure.supxlabel(summary(result), fontsize=8.5, x=0.02, horizontalalignment="left")
        figure.legend(*wide.get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure


def summary(result: Overview) -> str:
    """Say what the picture shows in figures.

    Parameters
    ----------
    result : Overview
        One run.

    Returns
    -------
    str
        Attenuation, fidelity and what comes back, in two lines.
    """
    return (
        f"Ripple before the touch: {true_minus(f'{result.ripple_dB:.0f}')} dB. Touch of "
        f"{CONTACT_NM:g} Nm: its mean is read within {abs(result.contact_error_percent):.1f} % in the "
        f"second half.\nThe ripple changes under the touch: up to {result.returned_Nm:.1f} Nm of it "
        "comes back while the filter learns it anew."
    )
