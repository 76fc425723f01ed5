"""The picture of before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.report.style import BLUE, GREY, ORANGE, figure_style, new_figure
from strainwave.reproduce.overview import CONTACT_FROM_S, CONTACT_TO_S

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
        Two panels: about the contact, and its beginning.
    """
    with figure_style():
        figure = new_figure(3.0)
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
        figure.legend(*wide.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        return figure
