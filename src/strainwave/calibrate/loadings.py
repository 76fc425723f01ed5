"""Loading experiments as arrays: known torques, sensor volts, and how each load was reached."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

#: Loads nearer to each other than this share of the largest one count as the same load.
SAME_LOAD: Final = 2e-3


@dataclass(frozen=True)
class Loadings:
    """Rows of all experiments, in the order of loading.

    Attributes
    ----------
    names : tuple of str
        Names of the experiments, in the order of their first row.
    experiment : numpy.ndarray
        Which experiment a row belongs to, an index into `names`, shape (rows,).
    load_Nm : numpy.ndarray
        Known torque, shape (rows,), Nm.
    voltage_V : numpy.ndarray
        Sensor output, shape (rows,), V.
    path : numpy.ndarray
        1 where the load was reached from below, -1 from above, 0 where that is not known, as at the
        first reading; shape (rows,). Below and above are meant with sign: weights put on against the
        positive direction lead down.
    position_rad : numpy.ndarray or None
        Wave-generator angle of each experiment, shape (experiments,), rad.
    temperature_degC : numpy.ndarray or None
        Mean temperature of each experiment, shape (experiments,), degrees Celsius.
    mounting : tuple of str or None
        Mounting of each experiment.
    side_loads : mapping
        Side loads by name, each of shape (rows,), N or Nm.
    """

    names: tuple[str, ...]
    experiment: NDArray[np.intp]
    load_Nm: NDArray[np.float64]
    voltage_V: NDArray[np.float64]
    path: NDArray[np.int8]
    position_rad: NDArray[np.float64] | None = None
    temperature_degC: NDArray[np.float64] | None = None
    mounting: tuple[str, ...] | None = None
    side_loads: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.load_Nm)

    @property
    def largest_load_Nm(self) -> float:
        """Largest torque as a magnitude, Nm."""
        return float(np.max(np.abs(self.load_Nm)))

    def rows(self) -> Iterator[NDArray[np.intp]]:
        """Walk through the experiments.

        Yields
        ------
        numpy.ndarray
            Indices of an experiment's rows, in the order of loading.
        """
        for index in range(len(self.names)):
            yield np.flatnonzero(self.experiment == index)

    def levels(self) -> NDArray[np.intp]:
        """Give rows of the same load the same number.

        Returns
        -------
        numpy.ndarray
            For every row the number of its load, counted from the lowest; loads within `SAME_LOAD`
            of the largest are one. Shape (rows,).
        """
        order = np.argsort(self.load_Nm, kind="stable")
        ordered = self.load_Nm[order]
        width = SAME_LOAD * self.largest_load_Nm
        numbers = np.empty(len(self), np.intp)
        begin = level = 0
        # Counted from the first of each level: loads of a slow sweep would hang together else.
        while begin < len(ordered):
            end = int(np.searchsorted(ordered, ordered[begin] + width, "right"))
            numbers[order[begin:end]] = level
            begin, level = end, level + 1
        return numbers

    def with_voltage(self, voltage_V: NDArray[np.float64]) -> Loadings:
        """Take other volts for the same loads.

        Parameters
        ----------
        voltage_V : numpy.ndarray
            Sensor output, shape (rows,), V.

        Returns
        -------
        Loadings
            The same experiments with these volts.
        """
        return replace(self, voltage_V=voltage_V)

    def only(self, kept: NDArray[np.bool_]) -> Loadings:
        """Leave experiments out.

        Parameters
        ----------
        kept : numpy.ndarray
            Which experiments stay, shape (experiments,).

        Returns
        -------
        Loadings
            Their rows.
        """
        number = np.cumsum(kept) - 1
        rows = kept[self.experiment]
        return Loadings(
            tuple(name for name, stays in zip(self.names, kept, strict=True) if stays),
            number[self.experiment[rows]],
            self.load_Nm[rows],
            self.voltage_V[rows],
            self.path[rows],
            None if self.position_rad is None else self.position_rad[kept],
            None if self.temperature_degC is None else self.temperature_degC[kept],
            None
            if self.mounting is None
            else tuple(name for name, stays in zip(self.mounting, kept, strict=True) if stays),
            {name: values[rows] for name, values in self.side_loads.items()},
        )


def paths(
    load_Nm: NDArray[np.float64], increasing: NDArray[np.int8] | None = None
) -> NDArray[np.int8]:
    """Tell from which side each load of one experiment was reached.

    Parameters
    ----------
    load_Nm : numpy.ndarray
        Loads in the order of loading, shape (rows,), Nm.
    increasing : numpy.ndarray, optional
        What is known of each row: 1 where the magnitude increased, -1 where it decreased, 0 where
        nothing is known; shape (rows,). Without it the order tells.

    Returns
    -------
    numpy.ndarray
        1 from below, -1 from above, 0 not known; shape (rows,).
    """
    smallest = SAME_LOAD * float(np.max(np.abs(load_Nm), initial=0.0))
    if increasing is None:
        return _paths_by_order(load_Nm, smallest)
    found = np.zeros(len(load_Nm), np.int8)
    sense = 0
    for row, (load, told) in enumerate(zip(load_Nm, increasing, strict=True)):
        if abs(load) > smallest:
            sense = int(np.sign(load))
            found[row] = told * sense
        elif told < 0:
            # A zero reading after weights of one direction were taken off.
            found[row] = -sense
    return found


def _paths_by_order(load_Nm: NDArray[np.float64], smallest: float) -> NDArray[np.int8]:
    found = np.zeros(len(load_Nm), np.int8)
    path, farthest = 0, load_Nm[0]
    for row, load in enumerate(load_Nm):
        # A turn counts once it is larger than what is the same load; a slow sweep turns too.
        if abs(load - farthest) > smallest:
            path = 1 if load > farthest else -1
            farthest = load
        elif path * (load - farthest) > 0:
            farthest = load
        found[row] = path
    return found


def require_loads(loadings: Loadings, *, intercept: bool) -> None:
    """Refuse experiments whose loads determine no gain.

    Parameters
    ----------
    loadings : Loadings
        The experiments.
    intercept : bool
        Whether the line has a zero of its own.

    Raises
    ------
    InputError
        If an experiment has too few different loads.
    """
    for name, rows in zip(loadings.names, loadings.rows(), strict=True):
        loads = loadings.load_Nm[rows]
        if intercept and np.ptp(loads) <= SAME_LOAD * np.max(np.abs(loads), initial=0.0):
            raise InputError(
                f"experiment {name}: all of its {len(rows)} loads are {loads[0]:g} Nm; expected at "
                "least two different loads, zero among them, so add readings or leave it out"
            )
        if not np.any(loads):
            raise InputError(
                f"experiment {name}: none of its {len(rows)} loads differs from 0; expected at "
                "least one load, so add readings or leave it out"
            )
