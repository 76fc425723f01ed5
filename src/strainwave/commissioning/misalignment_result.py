"""What was found of a misalignment: plain values, and what a person should know."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from strainwave.calibrate.free_motion import FreeMotion
    from strainwave.calibrate.misalignment import MapCheck, MisalignmentFit
    from strainwave.calibrate.misalignment_design import MapTerm
    from strainwave.joint import Joint
    from strainwave.records.layout import Layout

#: Less than this share of the misalignment gone elsewhere is worth a sentence.
SHARE_TO_REMOVE: Final = 0.9
#: Coefficients beyond so many standard uncertainties are taken to be there.
_CLEAR: Final = 3.0


@dataclass(frozen=True)
class CommissionedMisalignment:
    """What was found.

    Attributes
    ----------
    path, out : Path
        The recording, and the joint file that was written.
    fit : MisalignmentFit
        The map, and what was fitted beside.
    check : MapCheck or None
        What it removes elsewhere.
    checked_on : str or None
        Where.
    zero_angle_rad : float
        Output angle from which the map counts.
    gravity : str
        "told", "turned", "none" or "unknown".
    warnings : tuple of str
        What a person should know.
    """

    path: Path
    out: Path
    fit: MisalignmentFit
    check: MapCheck | None
    checked_on: str | None
    zero_angle_rad: float
    gravity: str
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            Nothing but texts, finite numbers, lists, dictionaries and None.
        """
        fit, check = self.fit, self.check
        return {
            "input": str(self.path),
            "output": str(self.out),
            "zero_of_output_angle_rad": self.zero_angle_rad,
            "terms": [_plain(term) for term in fit.terms],
            "once_a_turn": None if fit.once_a_turn is None else _plain(fit.once_a_turn),
            "gravity": self.gravity,
            "gravity_found": None if fit.gravity is None else _plain(fit.gravity),
            "lowest_output_angle_rad": fit.lowest_output_angle_rad,
            "highest_output_angle_rad": fit.highest_output_angle_rad,
            "output_turns": fit.output_turns,
            "condition_number": fit.condition,
            "residual_rms_Nm": fit.residual_rms_Nm,
            "effective_blocks": fit.effective_blocks,
            "fitted_beside": {
                name.removesuffix("#0"): {"value": float(value), "standard_uncertainty": float(u)}
                for name, (value, u) in fit.others.items()
            },
            "check": None
            if check is None
            else {
                "on": self.checked_on,
                "share_removed": check.share_removed,
                "terms": [asdict(term) for term in check.terms],
            },
            "warnings": list(self.warnings),
        }


def remarks_on(
    runs: Sequence[FreeMotion],
    fit: MisalignmentFit,
    check: MapCheck | None,
    layout: Layout,
    joint: Joint | None,
) -> tuple[str, ...]:
    """Say what a person should know of a map.

    Parameters
    ----------
    runs : sequence of FreeMotion
        What it was fitted to.
    fit : MisalignmentFit
        The map.
    check : MapCheck or None
        What it removes elsewhere.
    layout : Layout
        How the recording was read.
    joint : Joint or None
        The joint.

    Returns
    -------
    tuple of str
        Sentences, without an end mark.
    """
    return (*_on_the_fit(fit, layout, joint), *_on_size(runs, fit, check))


def _on_the_fit(fit: MisalignmentFit, layout: Layout, joint: Joint | None) -> tuple[str, ...]:
    says = list(fit.says)
    once = fit.once_a_turn
    if once is not None:
        says.append(
            f"one cycle per output turn ({once.amplitude_Nm:.3g} +- "
            f"{once.amplitude_standard_uncertainty_Nm:.2g} Nm) is left out: it may be gravity as well "
            "as misalignment; say --axis vertical, give --gravity-torque or --payload-mass with "
            "--horizontal-angle-deg, or a second run with the housing turned"
        )
    if fit.lowest_output_angle_rad is not None:
        assert fit.highest_output_angle_rad is not None
        says.append(
            f"the output turned from {math.degrees(fit.lowest_output_angle_rad):.4g} to "
            f"{math.degrees(fit.highest_output_angle_rad):.4g} deg: the map holds there and nowhere "
            "else, and the filter does not use it beyond"
        )
    inertia = fit.others.get("inertia_kg_m2")
    if inertia is not None and inertia[0] < -_CLEAR * inertia[1]:
        says.append(
            f"the inertia comes out negative ({inertia[0]:.3g} kg m^2): torque and angle count in "
            "opposite senses; gravity that was told has to count as the torque does"
        )
    weak = [
        str(term.cycles_per_output_turn)
        for term in fit.terms
        if term.amplitude_Nm < 2 * term.amplitude_standard_uncertainty_Nm
    ]
    if weak:
        says.append(
            f"cycles {', '.join(weak)} per output turn are no larger than twice their uncertainty; "
            "leave them out with --cycles"
        )
    if layout.angle_side == "motor":
        says.append(
            "the angle is the motor's: the map holds while its 0 stays at this angle of the output, "
            "and the filter wants --absolute-angle for it"
        )
    if joint is None or joint.gear is None:
        says.append(
            "the joint file has no [gear], which the filter needs to remove the misalignment"
        )
    return tuple(says)


def _on_size(
    runs: Sequence[FreeMotion], fit: MisalignmentFit, check: MapCheck | None
) -> tuple[str, ...]:
    span_Nm = max(float(np.ptp(np.quantile(run.torque_Nm, (0.01, 0.99)))) for run in runs)
    says = [
        f"cycle {term.cycles_per_output_turn} per output turn comes out larger "
        f"({2 * term.amplitude_Nm:.3g} Nm peak to peak) than all that the torque varies by "
        f"({span_Nm:.3g} Nm): terms cancel each other, or gravity is there after all; turn "
        "further, or name fewer cycles"
        for term in fit.terms
        if 2 * term.amplitude_Nm > span_Nm
    ]
    if check is not None and check.share_removed < SHARE_TO_REMOVE:
        says.append(
            f"the map removes {check.share_removed:.0%} of the misalignment where it was checked, and "
            f"{SHARE_TO_REMOVE:.0%} is expected: it does not repeat, or the run is too short or not free"
        )
    return tuple(says)


def _plain(term: MapTerm) -> dict[str, Any]:
    return {
        **asdict(term),
        "amplitude_Nm": term.amplitude_Nm,
        "amplitude_standard_uncertainty_Nm": term.amplitude_standard_uncertainty_Nm,
    }


def nothing_found(path: Path, fit: MisalignmentFit) -> str:
    """Say why there is no map to write.

    Parameters
    ----------
    path : Path
        The recording.
    fit : MisalignmentFit
        A fit without terms.

    Returns
    -------
    str
        The sentence.
    """
    once = fit.once_a_turn
    if once is None:
        return (
            f"{path}: no cycles per output turn stand out of what inertia, friction and gravity leave "
            f"({fit.residual_rms_Nm:.3g} Nm rms); nothing was written: there is no misalignment to "
            "remove, or name the cycles with --cycles"
        )
    return (
        f"{path}: beside one cycle per output turn ({once.amplitude_Nm:.3g} Nm), which may be gravity "
        "as well as misalignment, none stand out; expected gravity to be told, so say --axis vertical, "
        "give --gravity-torque or --payload-mass with --horizontal-angle-deg, or a second run with the "
        "housing turned; nothing was written"
    )
