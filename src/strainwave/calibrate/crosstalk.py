"""Crosstalk: what axial force, radial force and tilting moment add to the sensor's volts.

voltage = zero of the experiment + load / gain of the experiment + sum over k of kappa_k F_k
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.loadings import SAME_LOAD
from strainwave.calibrate.torque import least_squares
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.calibrate.loadings import Loadings

#: A side load has to keep this share of its size beside what load and zeros explain of it.
LEAST_INDEPENDENT_SHARE: Final = 0.02


@dataclass(frozen=True)
class Crosstalk:
    """Sensitivity to one side load.

    Attributes
    ----------
    name : str
        Which one: "axial-force", "radial-force" or "tilting-moment".
    sensitivity_V : float
        kappa, V per N or per Nm.
    standard_error_V : float
        Its standard error.
    largest : float
        Largest side load applied, as a magnitude, N or Nm.
    """

    name: str
    sensitivity_V: float
    standard_error_V: float
    largest: float


def crosstalk(loadings: Loadings) -> tuple[Crosstalk, ...]:
    """Find the sensitivities to the side loads that were recorded.

    Parameters
    ----------
    loadings : Loadings
        The experiments, with their side loads. An experiment without torque tells of them too.

    Returns
    -------
    tuple of Crosstalk
        For every side load.

    Raises
    ------
    InputError
        If a side load never changes, or only together with the torque or with another one.
    """
    names = list(loadings.side_loads)
    side = np.column_stack([loadings.side_loads[name] for name in names])
    base = _lines_matrix(loadings)
    for place, name in enumerate(names):
        _require_apart(name, side[:, place], base)
    matrix = np.column_stack([side, base])
    if np.linalg.matrix_rank(matrix / np.linalg.norm(matrix, axis=0)) < matrix.shape[1]:
        raise InputError(
            f"{' and '.join(names)} change together only; expected readings in which each of them "
            "changes by itself, so record these or map fewer side loads"
        )
    fit = least_squares(matrix, loadings.voltage_V)
    return tuple(
        Crosstalk(
            name,
            float(fit.parameters[place]),
            float(fit.standard_errors[place]),
            float(np.max(np.abs(side[:, place]))),
        )
        for place, name in enumerate(names)
    )


def without_crosstalk(loadings: Loadings, found: tuple[Crosstalk, ...]) -> Loadings:
    """Take the volts of side loads out.

    Parameters
    ----------
    loadings : Loadings
        The experiments.
    found : tuple of Crosstalk
        Sensitivities, from `crosstalk`.

    Returns
    -------
    Loadings
        The same experiments as they would read without side loads.
    """
    volts = loadings.voltage_V.copy()
    for each in found:
        volts -= each.sensitivity_V * loadings.side_loads[each.name]
    return loadings.with_voltage(volts)


def has_torque(loadings: Loadings) -> NDArray[np.bool_]:
    """Tell which experiments have torque, and which side loads alone.

    Parameters
    ----------
    loadings : Loadings
        The experiments.

    Returns
    -------
    numpy.ndarray
        True where loads differ, shape (experiments,).
    """
    smallest = SAME_LOAD * loadings.largest_load_Nm
    return np.array([np.ptp(loadings.load_Nm[rows]) > smallest for rows in loadings.rows()])


def _lines_matrix(loadings: Loadings) -> NDArray[np.float64]:
    """Zero of every experiment, and sensitivity of every one with torque."""
    columns = []
    for index, with_torque in enumerate(has_torque(loadings)):
        mine = (loadings.experiment == index).astype(np.float64)
        columns.append(mine)
        if with_torque:
            columns.append(mine * loadings.load_Nm)
    return np.column_stack(columns)


def _require_apart(name: str, side: NDArray[np.float64], base: NDArray[np.float64]) -> None:
    explained = base @ np.linalg.lstsq(base, side, rcond=None)[0]
    size = float(np.linalg.norm(side))
    if float(np.linalg.norm(side - explained)) <= LEAST_INDEPENDENT_SHARE * size:
        raise InputError(
            f"{name} changes with the torque of each experiment only, or not at all within one, so "
            "that its effect cannot be told from gain and zero; expected readings at one torque "
            "with different side loads, so record these or leave the side load out of --map"
        )
