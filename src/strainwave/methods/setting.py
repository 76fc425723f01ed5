"""What every method of removing ripple is built from: the recording's rate, the gear, the joint."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from strainwave.identify.ripple_settings import RippleSettings
    from strainwave.joint import Joint
    from strainwave.samples import Samples


@dataclass(frozen=True)
class Setting:
    """What is known of a recording before its first row.

    Attributes
    ----------
    sample_period_s : float
        Time from one row to the next as a rule, s; rows may jitter around it.
    ratio : fractions.Fraction or None
        Motor turns per output turn; None where it is not known.
    rated_torque_Nm : float
        Full scale of the joint, Nm.
    joint : Joint or None
        The joint file, where there is one.
    wave_factor : fractions.Fraction
        Turns of the wave against the sensing elements per motor turn, the gear's factor m.
    excerpt : Samples or None
        Rows of the recording for a method that chooses its own tuning; None where there are none.
    ripple_settings : RippleSettings or None
        What the ripple filter has chosen before, to build the same again; None to choose.
    """

    sample_period_s: float
    ratio: Fraction | None
    rated_torque_Nm: float
    joint: Joint | None = None
    wave_factor: Fraction = Fraction(1)
    excerpt: Samples | None = None
    ripple_settings: RippleSettings | None = None
