"""The demo's part on Godler et al. 2000: words, figures and tables from results."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.report import figures_godler as figures
from strainwave.report.page import Item, Part, PlainTable

if TYPE_CHECKING:
    from strainwave.reproduce.comparison import Comparison
    from strainwave.reproduce.godler2000 import Compensation, Godler2000

#: What the simulated stations do, which the paper does not claim.
_LINEARITY = (
    "In the simulated gears they were put in. Hysteresis, of which the same share passes by the "
    "gauges in every build, makes ±0.5 %FS in each. The rest is what load does to the strain "
    "around the flexspline: two gauges leave its second harmonic, three the third, four neither. "
    "How large these effects are, and the angle at which the wave generator stands, were chosen "
    "to match the figures; at other angles two gauges have ±0.8 to ±2.0 %FS. The agreement is no "
    "evidence for the causes."
)
_SCALES = (
    "The two panels have different scales; the dashed line on the left is the sum on the scale of "
    "the gauges."
)


def godler_part(result: Godler2000, comparisons: dict[str, tuple[Comparison, ...]]) -> Part:
    """Write the part on the second paper.

    Parameters
    ----------
    result : Godler2000
        What was run.
    comparisons : dict
        Published numbers beside ours, by figure.

    Returns
    -------
    Part
        A section of the page.
    """
    return Part(
        anchor="godler",
        title="Godler et al. 2000: gains that cancel the fluctuation",
        paragraphs=(
            "A gear of 100 Nm in three builds: two and four gauges with the circular spline fixed "
            "(ratio 50), three gauges at 60° with the flexspline fixed (ratio 51). Each gauge has "
            "a channel of its own. Signals are in %FS of the sum of all gauges. What follows was "
            "run on simulations of these builds.",
        ),
        items=(
            Item(
                title="Figure 3: two gauges at 90°",
                paragraphs=(
                    "The basic frequency cancels; the double frequency, which has the same phase "
                    "on both gauges, adds up.",
                ),
                figure=figures.fluctuation_figure(result.two, 6.0),
                caption="Simulated, one turn of the input shaft without load. " + _SCALES,
                alternative="Two opposite sines of 40 percent, and their sum of 4 percent at four "
                "cycles a turn.",
                comparisons=comparisons["fig3"],
            ),
            Item(
                title="Figure 6: four gauges at 45°",
                paragraphs=(
                    "Now the double frequency cancels as well, and the basic one is left as far as "
                    "the gauges differ.",
                ),
                figure=figures.fluctuation_figure(result.four, 3.0),
                caption="Simulated, one turn of the input shaft without load. " + _SCALES,
                alternative="Four sines of 20 percent, and their sum of 1 percent at two cycles a "
                "turn.",
                comparisons=comparisons["fig6"],
            ),
            Item(
                title="Figure 9: three gauges at 60°, bonded without much care",
                figure=figures.fluctuation_figure(result.three, 4.0),
                caption="Simulated with the amplitudes and phase errors that the paper gives; the table "
                "shows the fit reading them back. " + _SCALES,
                alternative="Three sines of about 20 percent, and their sum of 2 percent at two "
                "cycles a turn.",
                comparisons=comparisons["fig9"],
            ),
            Item(
                title="Gains from equation (9), and figure 10",
                paragraphs=(
                    "The paper tuned by hand and does not print its gains; they follow from the "
                    "amplitudes and phases it gives. The run's own gains come from a fit to the "
                    "run; they are tried on another turn. The basic frequency vanishes there; the "
                    "higher ones stay.",
                ),
                figure=figures.compensation_figure(result.three, result.three_compensated),
                caption="Simulated. The gains were fitted on the turn with equal gains and are shown "
                "on another one. With its noise the sum stays within "
                f"±{100 * result.three_compensated.fluctuation_FS:.2f} %FS; the table compares its "
                "harmonics, as the paper's words do.",
                alternative="A fluctuation of 2 percent before and 0.2 percent after.",
                table=_gains_table(result.compensation),
                comparisons=comparisons["gains"] + comparisons["fig10"],
            ),
            Item(
                title="Figure 8 and M ≥ 2N + 1: how many gauges it takes",
                paragraphs=(
                    "Each gauge's fluctuation is a vector, and a gain changes its length only. Two "
                    "vectors close only if they lie on a line; three can unless all lie on one.",
                ),
                figure=figures.vector_figure(result),
                caption="Computed from the paper's amplitudes and phases: vectors of the basic "
                "frequency end to end, with the gains that leave the least.",
                alternative="Two vectors that do not quite close, and three that form a triangle.",
                table=PlainTable(
                    ("Harmonics N", "Gauges M", "M ≥ 2N + 1", "Independent solutions of eq. (9)"),
                    tuple(
                        (
                            str(count.harmonics),
                            str(count.gauges),
                            "yes" if count.enough else "no",
                            str(count.solutions) if count.solutions else "none but all gains zero",
                        )
                        for count in result.gauge_counts
                    ),
                ),
            ),
            Item(
                title="Figures 4, 7 and 11: linearity at standstill",
                paragraphs=(
                    "Weights up and down in both directions; the distance from the straight line, "
                    "hysteresis included. The paper reports the errors and names no cause. "
                    f"{_LINEARITY}",
                ),
                figure=figures.linearity_figure(
                    [
                        ("Two gauges (fig. 4)", result.two),
                        ("Four gauges (fig. 7)", result.four),
                        ("Three with gains (fig. 11)", result.three_compensated),
                    ]
                ),
                caption="Simulated, all with one scale. Hysteresis and what load does to the strain "
                "were chosen so that the paper's three errors come out.",
                alternative="Loops of linearity error: about 2 percent for two gauges, 0.5 for "
                "four, 1.5 for three.",
                comparisons=comparisons["fig4"] + comparisons["fig7"] + comparisons["fig11"],
            ),
        ),
    )


def _gains_table(compensation: Compensation) -> PlainTable:
    def row(name: str, values: tuple[str, ...]) -> tuple[str, ...]:
        return (name, *values)

    def cells(which: str) -> tuple[str, ...]:
        gains = getattr(compensation, which)
        return (
            *(f"{gain:.4f}" for gain in gains.gains),
            f"{gains.noise_factor:.4f}",
            f"{gains.condition:.3f}",
        )

    return PlainTable(
        ("Gains, sum 3", "Gauge 1", "Gauge 2", "Gauge 3", "Noise factor", "Condition"),
        (
            row("from the paper's amplitudes and phases", cells("from_paper")),
            row("from the simulated run", cells("from_run")),
        ),
    )
