"""What a method is built from: options over joint file, and what only the recording can say."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.wave_factor import find_wave_factor
from strainwave.methods.registry import DEFAULT_METHOD
from strainwave.samples import Samples

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from strainwave.joint import Joint
    from strainwave.records.options import Options
    from strainwave.records.signals import Rows


#: Rows of a recording on which choices are made.
MOST_ROWS: Final = 100_000


@dataclass(frozen=True)
class WaveFactorChoice:
    """The gear's factor m, and where it comes from.

    Attributes
    ----------
    factor : fractions.Fraction
        Turns of the wave against the sensing elements per motor turn.
    source : str
        "joint file", "recording", or "assumed" where neither says it.
    """

    factor: Fraction
    source: str


def method_name(asked: str | None, joint: Joint | None) -> str:
    """Choose the method: what was asked for, else the joint file's, else the default.

    Parameters
    ----------
    asked : str or None
        The option.
    joint : Joint or None
        The joint file.

    Returns
    -------
    str
        A name for `strainwave.methods.registry.build_method`.
    """
    if asked is not None:
        return asked
    if joint is not None and joint.ripple_filter is not None:
        return joint.ripple_filter.method
    return DEFAULT_METHOD


def joint_as_asked(joint: Joint | None, options: Options) -> Joint | None:
    """Put ratio and rated torque of the options in the place of the joint file's.

    Parameters
    ----------
    joint : Joint or None
        The joint file.
    options : Options
        What was asked for.

    Returns
    -------
    Joint or None
        A joint whose orders ("n/R", "nm") follow the ratio that is used.
    """
    if joint is None or joint.gear is None:
        return joint
    changes: dict[str, float | None] = {}
    if options.ratio is not None:
        changes |= {
            "ratio": float(options.ratio),
            "flexspline_teeth": None,
            "circular_spline_teeth": None,
        }
    if options.rated_torque_Nm is not None:
        changes["rated_torque_Nm"] = options.rated_torque_Nm
    return joint.model_copy(update={"gear": joint.gear.model_copy(update=changes)})


def read_excerpt(rows: Iterator[Rows], most_rows: int = MOST_ROWS) -> Samples:
    """Read the start of a recording, for choices that are made on it.

    Parameters
    ----------
    rows : iterator of Rows
        The recording; no more of it is read than is needed.
    most_rows : int
        How many rows.

    Returns
    -------
    Samples
        At most so many rows.
    """
    parts, count = [], 0
    for part in rows:
        parts.append(part.samples)
        count += len(part)
        if count >= most_rows:
            break

    def together(name: str) -> NDArray[np.float64]:
        arrays = [np.empty(0), *(getattr(part, name) for part in parts)]
        return np.concatenate(arrays)[:most_rows]

    return Samples(
        together("time_s"),
        together("motor_angle_rad"),
        together("torque_Nm"),
        together("expected_torque_Nm"),
    )


def choose_wave_factor(
    joint: Joint | None, ratio: Fraction | None, excerpt: Samples
) -> WaveFactorChoice:
    """Take the factor m from the joint file, or else find it in the recording.

    Parameters
    ----------
    joint : Joint or None
        The joint file.
    ratio : fractions.Fraction or None
        Motor turns per output turn.
    excerpt : Samples
        Rows of the recording.

    Returns
    -------
    WaveFactorChoice
        The factor and its source.
    """
    if joint is not None and joint.gear is not None:
        return WaveFactorChoice(joint.gear.exact_factor_m, "joint file")
    found = find_wave_factor(excerpt.motor_angle_rad, excerpt.torque_Nm, ratio)
    return WaveFactorChoice(found.factor, "recording" if found.is_decided else "assumed")


def remarks_on(choice: WaveFactorChoice) -> tuple[str, ...]:
    """Say in a sentence what was found out about the factor m.

    Parameters
    ----------
    choice : WaveFactorChoice
        From `choose_wave_factor`.

    Returns
    -------
    tuple of str
        Nothing where the recording did not have to decide against the plain factor 1.
    """
    if choice.source == "recording" and choice.factor != 1:
        return (
            f"the ripple turns with the wave and not with the motor: {2 * float(choice.factor):.6g} "
            "cycles per motor turn instead of 2; name the gear's configuration in a joint file to "
            "settle it",
        )
    return ()
