"""Godler et al. 2000 beside the simulated builds, figure by figure."""

from __future__ import annotations

import numpy as np

from strainwave.reproduce import published
from strainwave.reproduce.comparison import Comparison, within
from strainwave.reproduce.godler2000 import Build, Godler2000, half_peak_to_peak


def _amplitudes_and_phases(three: Build) -> tuple[Comparison, ...]:
    """Amplitudes and phase errors as fitted to the run, beside those that the paper fitted."""
    amplitudes = three.fit.amplitudes[0] / three.fit.amplitudes[0, 0]
    phases_deg = np.rad2deg(three.fit.phase_errors_rad[0] - three.fit.phase_errors_rad[0, 0])
    entries = []
    for j in (1, 2):
        amplitude = published.THREE_GAUGE_AMPLITUDES[j]
        phase_deg = published.THREE_GAUGE_PHASE_ERRORS_DEG[j]
        entries += [
            Comparison(
                "G fig. 9(a)",
                f"amplitude of gauge {j + 1} over that of gauge 1, fitted",
                f"{amplitude:g}",
                float(amplitudes[j]),
                "",
                amplitude - 0.005,
                amplitude + 0.005,
                "simulated",
            ),
            Comparison(
                "G fig. 9(a)",
                f"phase error of gauge {j + 1}, fitted",
                f"{phase_deg:g}",
                float(phases_deg[j]),
                "°",
                phase_deg - 0.1,
                phase_deg + 0.1,
                "simulated",
            ),
        ]
    return tuple(entries)


def comparisons(result: Godler2000) -> dict[str, tuple[Comparison, ...]]:
    """Compare with the paper, figure by figure.

    Parameters
    ----------
    result : Godler2000
        What was run here.

    Returns
    -------
    dict
        Comparisons by figure: "fig3", "fig4", "fig6", "fig7", "fig9", "fig10", "fig11", "gains".
    """

    def fluctuation(figure: str, build: Build, expected: float, words: str) -> Comparison:
        return within(
            figure,
            f"fluctuation of the sum, {build.gauges} gauges",
            words,
            100 * build.fluctuation_FS,
            unit="%FS",
            expected=100 * expected,
            tolerance=0.3,
        )

    def cycles(figure: str, build: Build, harmonic: int) -> Comparison:
        return within(
            figure,
            "cycles per input turn that dominate it",
            str(2 * harmonic),
            2 * build.dominant_harmonic,
            unit="",
            expected=2 * harmonic,
            tolerance=0.0,
        )

    def linearity(figure: str, build: Build, expected: float, words: str) -> Comparison:
        return within(
            figure,
            f"linearity error with hysteresis, {build.gauges} gauges",
            words,
            100 * build.linearity_FS,
            unit="%FS",
            expected=100 * expected,
            tolerance=0.3,
        )

    paper = result.compensation.from_paper.gains
    expected_gains = ("1.0586", "0.9966", "0.9448")
    alone = half_peak_to_peak(result.two.signals_FS[:, 0])
    ratio = result.two.fit.amplitudes[0].mean() / result.two.fit.amplitudes[1].mean()
    return {
        "fig3": (
            fluctuation("G fig. 3(b)", result.two, published.FLUCTUATION_TWO_GAUGES_FS, "about ±4"),
            cycles("G fig. 3(b)", result.two, 2),
            within(
                "G section II-A",
                "one gauge's fluctuation over that of the sum",
                "approximately 10",
                alone / result.two.fluctuation_FS,
                unit="",
                expected=published.COMPENSATION_FACTOR_TWO_GAUGES,
                tolerance=0.3,
            ),
            within(
                "G section II-B",
                "basic over double frequency, amplitudes",
                "about 20",
                ratio,
                unit="",
                expected=published.HARMONICS_RATIO,
                tolerance=0.3,
            ),
        ),
        "fig4": (linearity("G fig. 4", result.two, published.LINEARITY_TWO_GAUGES_FS, "about ±2"),),
        "fig6": (
            fluctuation(
                "G fig. 6", result.four, published.FLUCTUATION_FOUR_GAUGES_FS, "approximately ±1"
            ),
            cycles("G fig. 6", result.four, 1),
        ),
        "fig7": (
            linearity("G fig. 7", result.four, published.LINEARITY_FOUR_GAUGES_FS, "about ±0.5"),
        ),
        "fig9": (
            fluctuation(
                "G fig. 9(b)", result.three, published.FLUCTUATION_THREE_GAUGES_FS, "about ±2"
            ),
            cycles("G fig. 9(b)", result.three, 1),
            *_amplitudes_and_phases(result.three),
        ),
        "gains": tuple(
            Comparison(
                "G section IV",
                f"gain of gauge {j + 1}, sum 3, from the paper's amplitudes and phases",
                f"{words}, not printed",
                float(paper[j]),
                "",
                float(words) - 5e-5,
                float(words) + 5e-5,
                "computed",
            )
            for j, words in enumerate(expected_gains)
        ),
        "fig10": (
            within(
                "G fig. 10",
                "fluctuation of the sum, gains adjusted",
                "about ±0.2",
                100 * half_peak_to_peak(result.compensation.sum_FS),
                unit="%FS",
                expected=100 * published.FLUCTUATION_COMPENSATED_FS,
                tolerance=0.3,
            ),
        ),
        "fig11": (
            Comparison(
                "G fig. 11",
                "linearity error with hysteresis, 3 gauges with gains",
                "less than 2, between 4 and 2 gauges",
                100 * result.three_compensated.linearity_FS,
                "%FS",
                100 * result.four.linearity_FS,
                min(
                    100 * published.LINEARITY_THREE_GAUGES_FS,
                    100 * result.two.linearity_FS,
                ),
                "simulated",
            ),
        ),
    }
