"""Figures of each order over time and load, and of contacts that were added."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.report.style import (
    BLUE,
    GREY,
    NARROW_WIDTH_IN,
    figure_style,
    new_figure,
    separate,
    true_minus,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from strainwave.evidence import Contact, OrderLine

#: Orders that are drawn; the strongest ones.
MOST_ORDERS: Final = 6


def orders_figure(
    lines: tuple[OrderLine, ...], origin_s: float, time_label: str, width_in: float
) -> Figure:
    """Draw each order's amplitude over time and against load.

    Parameters
    ----------
    lines : tuple of OrderLine
        The orders; the first `MOST_ORDERS` are drawn.
    origin_s : float
        Time that is shown as 0, s.
    time_label : str
        Label of the axis of time.
    width_in : float
        Width, inches.

    Returns
    -------
    matplotlib.figure.Figure
        A row of panels an order; on a narrow screen time and load beneath each other.
    """
    lines = lines[:MOST_ORDERS]
    wide = width_in > NARROW_WIDTH_IN
    with figure_style():
        height_in = 0.7 + (1.75 if wide else 3.6) * len(lines)
        figure = new_figure(height_in, width_in)
        shape = (len(lines), 2) if wide else (2 * len(lines), 1)
        panels = figure.subplots(*shape, squeeze=False).reshape(-1, 2)
        separate(figure)
        for (over_time, over_load), line in zip(panels, lines, strict=True):
            for axes, place in ((over_time, line.time_s - origin_s), (over_load, line.load_Nm)):
                axes.plot(place, line.before_Nm, "o", color=GREY, markersize=3, label="as recorded")
                axes.plot(
                    place, line.after_Nm, "o", color=BLUE, markersize=3, label="ripple removed"
                )
                axes.set_ylim(0, 1.12 * float(max(line.before_Nm.max(), line.after_Nm.max(), 1e-9)))
                axes.set_ylabel("amplitude (Nm)")
            kept = ", kept: real torque" if line.is_kept else ""
            over_time.set_title(f"Order {line.order:.5g}{kept}: over time")
            over_load.set_title(f"Order {line.order:.5g}: against load")
            _label_last(over_time, time_label, wide=wide, is_last=line is lines[-1])
            _label_last(
                over_load, "torque without ripple (Nm)", wide=wide, is_last=line is lines[-1]
            )
        figure.legend(
            *panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2
        )
        return figure


def _label_last(axes: Axes, label: str, *, wide: bool, is_last: bool) -> None:
    if is_last or not wide:
        axes.set_xlabel(label)


def contacts_figure(contacts: tuple[Contact, ...], width_in: float) -> Figure:
    """Draw what was added to the recording, and what came through.

    Parameters
    ----------
    contacts : tuple of Contact
        One panel each.
    width_in : float
        Width, inches.

    Returns
    -------
    matplotlib.figure.Figure
        Panels with one scale of torque.
    """
    wide = width_in > NARROW_WIDTH_IN
    columns = min(len(contacts), 3) if wide else 1
    rows = -(-len(contacts) // columns)
    with figure_style():
        figure = new_figure(0.5 + (2.1 if wide else 1.9) * rows, width_in)
        panels = figure.subplots(rows, columns, squeeze=False, sharey=True).ravel()
        separate(figure)
        for axes, contact in zip(panels, contacts, strict=False):
            known = np.isfinite(contact.through_Nm)
            axes.plot(
                contact.time_s,
                contact.added_Nm,
                color=GREY,
                linewidth=3.5,
                alpha=0.45,
                label="added",
            )
            axes.plot(
                contact.time_s[known], contact.through_Nm[known], color=BLUE, label="came through"
            )
            axes.set_title(contact_title(contact))
            axes.margins(x=0)
        for n, axes in enumerate(panels):
            if n >= len(contacts):
                axes.set_visible(False)
            if n + columns >= len(contacts):
                axes.set_xlabel("time since it began (s)")
                axes.tick_params(labelbottom=True)
            if n % columns == 0:
                axes.set_ylabel("torque (Nm)")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
        return figure


def contact_title(contact: Contact) -> str:
    """Name a contact in a few words.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        Its kind and the motor's speed.
    """
    speed = true_minus(f"{contact.motor_speed_rad_s:.3g}")
    if contact.frequency_Hz is not None:
        return f"Push of {contact.frequency_Hz:g} Hz, {speed} rad/s"
    return "Step at rest" if contact.name == "step at rest" else f"Step, {speed} rad/s"
