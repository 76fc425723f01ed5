"""Torsion and hysteresis torque of the flexspline where the torque is given.

Along a torque that only rises or only falls, Dahl's law has the closed solution
z = s F + (z0 - s F) exp(-s sigma (torsion - torsion0) / F), so each sample is one equation in the
torsion, solved by Newton's method kept inside a bracket.
"""

from __future__ import annotations

import math

import numpy as np

from strainwave.simulate.mechanics import Flexspline
from strainwave.simulate.trajectories import FloatArray


def _step_along_branch(
    flexspline: Flexspline, torque_Nm: float, torsion_rad: float, hysteresis_Nm: float
) -> tuple[float, float]:
    """Torsion and hysteresis torque after the torque changed to torque_Nm."""
    present_Nm = flexspline.elastic_torque_Nm(torsion_rad) + hysteresis_Nm
    change_Nm = torque_Nm - present_Nm
    if change_Nm == 0.0:
        return torsion_rad, hysteresis_Nm
    side = math.copysign(1.0, change_Nm)
    limit = flexspline.hysteresis_Nm
    rate = side * flexspline.hysteresis_stiffness_Nm_per_rad / limit
    # The spring alone, without the help of the hysteresis, would need more torsion than this.
    inner, outer = 0.0, change_Nm / flexspline.stiffness_Nm_per_rad
    moved = outer
    for _ in range(60):
        decay = math.exp(-rate * moved)
        z = side * limit + (hysteresis_Nm - side * limit) * decay
        torsion = torsion_rad + moved
        error = flexspline.elastic_torque_Nm(torsion) + z - torque_Nm
        if abs(error) <= 1e-12 * (1.0 + abs(torque_Nm)):
            break
        if error * side > 0:
            outer = moved
        else:
            inner = moved
        slope = (
            flexspline.stiffness_Nm_per_rad
            + 3 * flexspline.hardening_Nm_per_rad3 * torsion * torsion
            - rate * (hysteresis_Nm - side * limit) * decay
        )
        moved -= error / slope
        if not min(inner, outer) < moved < max(inner, outer):
            moved = (inner + outer) / 2
    return torsion, z


def torsion_under(torque_Nm: FloatArray, flexspline: Flexspline) -> tuple[FloatArray, FloatArray]:
    """Return torsion and hysteresis torque under a torque history, without inertia or damping.

    Parameters
    ----------
    torque_Nm : ndarray, shape (n,)
        Torque through the flexspline, Nm; before the first sample it was zero.
    flexspline : Flexspline
        The spring.

    Returns
    -------
    torsion_rad : ndarray, shape (n,)
        Torsion, rad at the output side.
    hysteresis_Nm : ndarray, shape (n,)
        Hysteresis torque, Nm.
    """
    torsions = np.empty(len(torque_Nm))
    hysteresis = np.zeros(len(torque_Nm))
    if flexspline.hysteresis_Nm == 0.0:
        return _torsion_of_spring(torque_Nm, flexspline), hysteresis
    torsion, z = 0.0, 0.0
    for k, torque in enumerate(torque_Nm.tolist()):
        torsion, z = _step_along_branch(flexspline, torque, torsion, z)
        torsions[k] = torsion
        hysteresis[k] = z
    return torsions, hysteresis


def _torsion_of_spring(torque_Nm: FloatArray, flexspline: Flexspline) -> FloatArray:
    """Inverse of the cubic spring, by Newton's method from the linear spring's torsion."""
    torsion = torque_Nm / flexspline.stiffness_Nm_per_rad
    cubic = flexspline.hardening_Nm_per_rad3
    if cubic == 0.0:
        return np.asarray(torsion)
    # Starting beyond the root of a convex branch, Newton's method runs down to it monotonically.
    for _ in range(60):
        error = flexspline.stiffness_Nm_per_rad * torsion + cubic * torsion**3 - torque_Nm
        move = error / (flexspline.stiffness_Nm_per_rad + 3 * cubic * torsion**2)
        torsion = torsion - move
        if np.all(np.abs(move) <= 1e-15 + 1e-13 * np.abs(torsion)):
            break
    return np.asarray(torsion)


def held_back_by_friction(applied_Nm: FloatArray, friction_Nm: float) -> FloatArray:
    """Return what arrives behind a dry bearing that holds back up to its friction.

    Parameters
    ----------
    applied_Nm : ndarray, shape (n,)
        Torque applied, Nm; before the first sample it was zero.
    friction_Nm : float
        Dry friction, Nm.

    Returns
    -------
    ndarray, shape (n,)
        Torque that arrives, Nm: it follows the applied one within +-friction_Nm.
    """
    if friction_Nm == 0.0:
        return applied_Nm
    arrived = np.empty(len(applied_Nm))
    now = 0.0
    for k, torque in enumerate(applied_Nm.tolist()):
        now = min(max(now, torque - friction_Nm), torque + friction_Nm)
        arrived[k] = now
    return arrived
