"""The picture of the main job: torque before and after, with touches that must stay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.report.style import (
    BLUE,
    GREY,
    ORANGE,
    figure_style,
    new_figure,
    separate,
    true_minus,
)
from strainwave.walkthrough.main_job import MEASURED, OURS
from strainwave.walkthrough.recordings import TOUCH_IN_MOTION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from strainwave.walkthrough.main_job import MainJob

#: What the lower panels show, s.
_TOUCH_FROM_S, _TOUCH_TO_S = TOUCH_IN_MOTION.from_s - 0.15, TOUCH_IN_MOTION.from_s + 0.25
_REVERSAL_FROM_S, _REVERSAL_TO_S = 8.4, 9.6


def main_job_figure(job: MainJob) -> Figure:
    """Draw torque before and after.

    Parameters
    ----------
    job : MainJob
        One joint, from its recording to clean torque.

    Returns
    -------
    matplotlib.figure.Figure
        The whole recording, a touch and the reversal, with what they show in figures beneath.
    """
    with figure_style():
        figure = new_figure(5.2)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.1, 1))
        whole = figure.add_subplot(grid[0, :])
        _draw(whole, job, 0.0, float(job.time_s[-1]))
        whole.set(title="A simulated joint at work: turning, touched, reversing, touched at rest")
        for place, title, from_s, to_s in (
            (0, "The first touch begins", _TOUCH_FROM_S, _TOUCH_TO_S),
            (1, "Through the reversal", _REVERSAL_FROM_S, _REVERSAL_TO_S),
        ):
            axes = figure.add_subplot(grid[1, place])
            _draw(axes, job, from_s, to_s)
            axes.set(title=title)
        figure.legend(*whole.get_legend_handles_labels(), loc="outside upper center", ncols=3)
        figure.supxlabel(summary(job), fontsize=8.5, x=0.02, horizontalalignment="left")
        separate(figure)
        return figure


#: Pieces of a curve that are drawn by their lowest and highest value.
_MOST_PIECES: Final = 600


def _outline(
    time_s: NDArray[np.float64], torque_Nm: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Keep of every piece the lowest and the highest value: no peak is lost, the file stays small."""
    size = len(time_s) // _MOST_PIECES
    if size < 3:
        return time_s, torque_Nm
    rows = np.arange(len(time_s) // size * size).reshape(-1, size)
    extremes = np.stack([torque_Nm[rows].argmin(axis=1), torque_Nm[rows].argmax(axis=1)], axis=1)
    kept = (rows[:, :1] + np.sort(extremes, axis=1)).ravel()
    return time_s[kept], torque_Nm[kept]


def _draw(axes: Axes, job: MainJob, from_s: float, to_s: float) -> None:
    shown = (job.time_s >= from_s) & (job.time_s <= to_s)
    dashed = (0, (4, 2))
    for torque_Nm, label, look in (
        (job.torque_Nm[MEASURED], "recorded", {"color": GREY, "linewidth": 0.7}),
        (job.torque_Nm[OURS], "ripple removed", {"color": BLUE}),
        (job.true_Nm, "true torque", {"color": ORANGE, "linewidth": 1, "linestyle": dashed}),
    ):
        outline = _outline(job.time_s[shown], torque_Nm[shown])
        axes.plot(*outline, label=label, **look)
    axes.set(xlabel="time (s)", ylabel="torque (Nm)", xlim=(from_s, to_s))


def summary(job: MainJob) -> str:
    """Say what the picture shows in figures.

    Parameters
    ----------
    job : MainJob
        One joint, from its recording to clean torque.

    Returns
    -------
    str
        What is left of the ripple, and what becomes of the touches, in two lines.
    """
    before, after = job.score(MEASURED), job.score(OURS)
    return true_minus(
        f"Distance from the true torque: {before.error_rms_Nm:.2f} Nm rms as recorded, "
        f"{after.error_rms_Nm:.2f} Nm after.\nA touch of 10 Nm reads "
        f"{after.touch_in_motion_Nm:.2f} Nm after 20 ms in motion, {after.touch_at_rest_Nm:.2f} Nm "
        "at rest."
    )
