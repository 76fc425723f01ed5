"""Ratio and factor m of a recording, whichever angle it has, in numbers and in sentences."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from strainwave.errors import InputError
from strainwave.identify.moving_rows import moving_rows
from strainwave.identify.ratio import (
    HIGHEST_CYCLES,
    LOWEST_CYCLES,
    FoundRatio,
    output_line,
    ratio_of_angles,
    ratio_of_line,
    ratio_of_motor_line,
)
from strainwave.identify.wave_factor import find_wave_factor
from strainwave.records.identified_log import Gearing, measured_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from strainwave.samples import Samples


def gearing_of_output(source: str, samples: Samples, told: Fraction | None) -> Gearing:
    """Find the gearing from the output's angle alone.

    Parameters
    ----------
    source : str
        Name of the recording, for messages.
    samples : Samples
        Its rows, with the output's angle in the place of the motor's.
    told : fractions.Fraction or None
        The ratio that was given.

    Returns
    -------
    Gearing
        What was found; the ratio that was given where nothing stands out.

    Raises
    ------
    InputError
        If no ratio is given and none can be found.
    """
    rows = moving_rows(samples.time_s, samples.motor_angle_rad, samples.torque_Nm)
    line = output_line(rows, told)
    if line is None and told is None:
        raise InputError(
            f"{source}: no line of the ripple stands out against the output's angle; expected order "
            f"2 at {LOWEST_CYCLES:g} to {HIGHEST_CYCLES:g} cycles per output turn, as ratios of "
            f"{LOWEST_CYCLES / 2:g} to {HIGHEST_CYCLES / 2:g} have it, so give the ratio with --ratio "
            "N, or record a longer motion"
        )
    if line is None:
        assert told is not None
        says = (
            "the ripple shows no clear line near the ratio that was given: "
            f"{float(told):g} is kept, and not measured, and m is taken as 1; check the ratio, or "
            "record a longer motion",
        )
        return Gearing(told, None, Fraction(1), "told", says=says)
    found = ratio_of_line(line, told)
    assert found.factor is not None
    product, deviation = line.cycles_per_turn / 2, line.standard_uncertainty / 2
    known = (
        "the output's angle shows only the product of ratio and factor m, "
        f"{measured_text(product, deviation)} (order 2 at "
        f"{measured_text(2 * product, 2 * deviation)} cycles per output turn)"
    )
    if told is None:
        says = (
            f"{known}: the ratio is taken as that with a fixed flexspline (m = 1); with a fixed "
            "circular spline it is 1 less, so give --ratio N if you know",
        )
    else:
        spline = "flexspline (m = 1)" if found.factor == 1 else "circular spline (m = (R + 1)/R)"
        verdict = "agrees with" if found.ratio == told else "replaces"
        says = (
            f"{known}: {_shown(found)} with a fixed {spline} {verdict} the ratio of "
            f"{float(told):g} that was given",
        )
    return Gearing(found.ratio, found.standard_uncertainty, found.factor, "line", says=says)


def gearing_of_motor(samples: Samples, told: Fraction | None) -> Gearing:
    """Find the gearing from the motor's angle alone.

    Parameters
    ----------
    samples : Samples
        Rows of the recording.
    told : fractions.Fraction or None
        The ratio that was given.

    Returns
    -------
    Gearing
        A ratio that is given is kept; an unknown one shows only where the ripple turns with the
        wave.
    """
    if told is not None:
        factor, says = _factor(samples, told)
        return Gearing(told, None, factor, "told", says=says)
    rows = moving_rows(samples.time_s, samples.motor_angle_rad, samples.torque_Nm)
    found = ratio_of_motor_line(rows)
    if found is None:
        return Gearing(
            None,
            None,
            Fraction(1),
            "unknown",
            says=(
                "the motor's angle alone does not show the ratio, and m is taken as 1: give "
                "--ratio N, or map the output's angle beside the motor's",
            ),
        )
    assert found.factor is not None
    says = (
        f"the ripple turns {float(found.factor):.7g} times per motor turn: the ratio is taken as "
        f"{_shown(found)} with a fixed circular spline, m = (R + 1)/R",
    )
    return Gearing(found.ratio, found.standard_uncertainty, found.factor, "line", says=says)


def gearing_of_both(
    source: str, samples: Samples, output_angle_rad: NDArray[np.float64], told: Fraction | None
) -> Gearing:
    """Find the gearing from both angles.

    Parameters
    ----------
    source : str
        Name of the recording, for messages.
    samples : Samples
        Its rows, with the motor's angle.
    output_angle_rad : numpy.ndarray
        The output's angle in the same rows, shape (rows,), rad.
    told : fractions.Fraction or None
        The ratio that was given.

    Returns
    -------
    Gearing
        What was found.

    Raises
    ------
    InputError
        If the two angles have no common slope, and no ratio is given.
    """
    found = ratio_of_angles(samples.motor_angle_rad, output_angle_rad, told)
    if found is None:
        if told is None:
            raise InputError(
                f"{source}: the output's angle does not follow the motor's; expected two angles of "
                "one joint in motion, so check the mapping and its units"
            )
        factor, says = _factor(samples, told)
        sentence = (
            "the output's angle does not follow the motor's, or hardly moves: the ratio of "
            f"{float(told):g} that was given is kept; check the mapping and its units"
        )
        return Gearing(told, None, factor, "told", says=(sentence, *says))
    factor, says = _factor(samples, found.ratio)
    if told is not None and found.ratio != told:
        says = (
            f"by the two angles' slope the ratio is {_shown(found)}, which replaces the ratio of "
            f"{float(told):g} that was given",
            *says,
        )
    return Gearing(found.ratio, found.standard_uncertainty, factor, "angles", found.direction, says)


def _factor(samples: Samples, ratio: Fraction) -> tuple[Fraction, tuple[str, ...]]:
    found = find_wave_factor(samples.motor_angle_rad, samples.torque_Nm, ratio)
    if found.is_decided:
        return found.factor, ()
    return Fraction(1), (
        "whether the ripple turns with the motor or with the wave does not show: m is taken as 1, "
        "a fixed flexspline; record at least a third of an output turn in one direction",
    )


def _shown(found: FoundRatio) -> str:
    return measured_text(float(found.ratio), found.standard_uncertainty)
