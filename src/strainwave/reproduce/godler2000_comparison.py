"""Godler et al. 2000 beside the simulated builds, figure by figure."""

from __future__ import annotations

from typing import Final

import numpy as np

from strainwave.reproduce import published
from strainwave.reproduce.comparison import Comparison, within
from strainwave.reproduce.godler2000 import Build, Godler2000, half_peak_to_peak

#: Half width of the band for a number that the paper calls "about" or "approximately".
ABOUT: Final = 0.3
ABOUT_WORDS: Final = "±30 % for “about” and for what is read from a figure"


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
    two, four, three = result.two, result.four, result.three
    return {
        "fig3": (
            _fluctuation("G fig. 3(b)", two, published.FLUCTUATION_TWO_GAUGES_FS, "about"),
            _cycles("G fig. 3(b)", two, 2, "double frequency (in words)"),
            *_two_gauges(two),
        ),
        "fig4": (_linearity("G fig. 4", two, published.LINEARITY_TWO_GAUGES_FS),),
        "fig6": (
            _fluctuation("G fig. 6", four, published.FLUCTUATION_FOUR_GAUGES_FS, "approximately"),
            _cycles("G fig. 6", four, 1, "basic frequency (in words)"),
        ),
        "fig7": (_linearity("G fig. 7", four, published.LINEARITY_FOUR_GAUGES_FS),),
        "fig9": (
            _fluctuation("G fig. 9(b)", three, published.FLUCTUATION_THREE_GAUGES_FS, "about"),
            *_amplitudes_and_phases(three),
        ),
        "gains": _gains(result),
        "fig10": _compensated(result),
        "fig11": (
            Comparison(
                source="G fig. 11",
                quantity="linearity error with hysteresis, 3 gauges with gains",
                published="less than 2 %FS, between four and two gauges",
                ours=100 * result.three_compensated.linearity_FS,
                unit="%FS",
                decimals=2,
                lowest=100 * published.LINEARITY_FOUR_GAUGES_FS,
                highest=100 * published.LINEARITY_THREE_GAUGES_FS,
                band="between the paper's own numbers for four and two gauges",
                kind="matched",
            ),
        ),
    }


def _about_FS(
    figure: str, quantity: str, words: str, ours_FS: float, expected_FS: float
) -> Comparison:
    return within(
        figure,
        quantity,
        f"{words} ±{100 * expected_FS:g} %FS",
        100 * ours_FS,
        unit="%FS",
        decimals=2,
        expected=100 * expected_FS,
        tolerance=ABOUT,
        band=ABOUT_WORDS,
        kind="matched",
    )


def _fluctuation(figure: str, build: Build, expected_FS: float, words: str) -> Comparison:
    quantity = f"fluctuation of the sum, {build.gauges} gauges"
    return _about_FS(figure, quantity, words, build.fluctuation_FS, expected_FS)


def _cycles(figure: str, build: Build, harmonic: int, words: str) -> Comparison:
    return within(
        figure,
        f"cycles per input turn that dominate it, {build.gauges} gauges",
        words,
        2 * build.dominant_harmonic,
        unit="",
        decimals=0,
        expected=2 * harmonic,
        tolerance=0.0,
        band="a whole number",
        kind="matched",
    )


def _linearity(figure: str, build: Build, expected_FS: float) -> Comparison:
    quantity = f"linearity error with hysteresis, {build.gauges} gauges"
    return _about_FS(figure, quantity, "about", build.linearity_FS, expected_FS)


def _two_gauges(two: Build) -> tuple[Comparison, ...]:
    alone = half_peak_to_peak(two.signals_FS[:, 0])
    ratio = two.fit.amplitudes[0].mean() / two.fit.amplitudes[1].mean()
    return (
        within(
            "G section II-A",
            "one gauge's fluctuation over that of the sum, 2 gauges",
            f"approximately {published.COMPENSATION_FACTOR_TWO_GAUGES:g}",
            alone / two.fluctuation_FS,
            unit="",
            decimals=1,
            expected=published.COMPENSATION_FACTOR_TWO_GAUGES,
            tolerance=ABOUT,
            band=ABOUT_WORDS,
            kind="matched",
        ),
        within(
            "G section II-B",
            "basic over double frequency, amplitudes, 2 gauges",
            f"about {published.HARMONICS_RATIO:g}",
            ratio,
            unit="",
            decimals=1,
            expected=published.HARMONICS_RATIO,
            tolerance=ABOUT,
            band=ABOUT_WORDS,
            kind="recovered",
        ),
    )


def _amplitudes_and_phases(three: Build) -> tuple[Comparison, ...]:
    """Amplitudes and phase errors as fitted to the run; the station has the paper's."""
    amplitudes = three.fit.amplitudes[0] / three.fit.amplitudes[0, 0]
    phases_deg = np.rad2deg(three.fit.phase_errors_rad[0] - three.fit.phase_errors_rad[0, 0])
    entries = []
    for j in (1, 2):
        amplitude = published.THREE_GAUGE_AMPLITUDES[j]
        phase_deg = published.THREE_GAUGE_PHASE_ERRORS_DEG[j]
        entries += [
            Comparison(
                source="G fig. 9(a)",
                quantity=f"amplitude of gauge {j + 1} over that of gauge 1",
                published=f"{amplitude:.2f}",
                ours=float(amplitudes[j]),
                unit="",
                decimals=3,
                lowest=amplitude - 0.005,
                highest=amplitude + 0.005,
                band="half of the paper's last digit",
                kind="recovered",
            ),
            Comparison(
                source="G fig. 9(a)",
                quantity=f"phase error of gauge {j + 1}",
                published=f"{phase_deg:.1f}°".replace("-", "\N{MINUS SIGN}"),
                ours=float(phases_deg[j]),
                unit="°",
                decimals=2,
                lowest=phase_deg - 0.05,
                highest=phase_deg + 0.05,
                band="half of the paper's last digit",
                kind="recovered",
            ),
        ]
    return tuple(entries)


def _gains(result: Godler2000) -> tuple[Comparison, ...]:
    gains = result.compensation
    return tuple(
        Comparison(
            source="G section IV",
            quantity=f"gain of gauge {j + 1}, gains adding up to 3, from the run's own fit",
            published=f"not printed; its data give {from_paper:.4f}",
            ours=float(from_run),
            unit="",
            decimals=4,
            lowest=float(from_paper) - 5e-4,
            highest=float(from_paper) + 5e-4,
            band="noise of the fit to one turn",
            kind="computed",
        )
        for j, (from_paper, from_run) in enumerate(
            zip(gains.from_paper.gains, gains.from_run.gains, strict=True)
        )
    )


def _compensated(result: Godler2000) -> tuple[Comparison, ...]:
    return (
        Comparison(
            source="G section IV",
            quantity="basic frequency left in the sum, gains adjusted",
            published="“perfectly compensated”",
            ours=100 * float(result.three_compensated.sum_harmonics_FS[0]),
            unit="%FS",
            decimals=3,
            lowest=0.0,
            highest=0.02,
            band="a tenth of what fig. 10 leaves",
            kind="found",
        ),
        _about_FS(
            "G fig. 10",
            "fluctuation of the sum, gains adjusted, its harmonics without noise",
            "about",
            half_peak_to_peak(result.three_compensated.periodic_FS),
            published.FLUCTUATION_COMPENSATED_FS,
        ),
    )
