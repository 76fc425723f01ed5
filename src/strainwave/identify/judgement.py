"""Which way torque or artefact is decided: a reference where there is one, else the load sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.identify.load_sweep import decide_by_load_sweep
from strainwave.identify.moving_rows import moving_rows
from strainwave.identify.recording import CANDIDATES
from strainwave.identify.reference_share import decide_by_reference
from strainwave.identify.torque_or_artefact import TorqueOrArtefact

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from strainwave.identify.recording import Ripple
    from strainwave.samples import Samples


def judge_ripple(
    excerpt: Samples,
    reference_Nm: NDArray[np.float64] | None,
    ripple: Ripple,
    factor: float,
    rated_torque_Nm: float,
) -> TorqueOrArtefact:
    """Decide for each order that is there whether it is torque or an artefact.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording, with the motor's angle.
    reference_Nm : numpy.ndarray or None
        Torque of a reference sensor in the same rows, shape (rows,), Nm.
    ripple : Ripple
        What was found of the ripple.
    factor : float
        Turns of the wave per motor turn, m.
    rated_torque_Nm : float
        Full scale, Nm.

    Returns
    -------
    TorqueOrArtefact
        A verdict on each order; none where no order is there.
    """
    orders = [each.order for each in ripple.present]
    delay_s = None if ripple.delay is None else ripple.delay.delay_s
    if not orders:
        return TorqueOrArtefact()
    if reference_Nm is not None:
        return decide_by_reference(
            excerpt, reference_Nm, orders, CANDIDATES, factor, delay_s or 0.0
        )
    rows = moving_rows(excerpt.time_s, excerpt.motor_angle_rad, excerpt.torque_Nm)
    return decide_by_load_sweep(rows, orders, CANDIDATES, factor, delay_s, rated_torque_Nm)
