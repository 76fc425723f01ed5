"""What loading series show beside the gain: linearity, hysteresis, repeatability, zero return.

Everything is in Nm by the gain of the experiment it belongs to. The names are those of torque
calibration practice, the formulas those written here: no standard's classes are claimed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.loadings import Loadings
    from strainwave.calibrate.torque import SensorGain


@dataclass(frozen=True)
class SeriesErrors:
    """Errors of each experiment, and of the experiments among each other; Nm, NaN where not told.

    Attributes
    ----------
    linearity_Nm : numpy.ndarray
        Largest distance of the mean reading at a load from the experiment's own straight line,
        where readings from below and from above count alike; shape (experiments,).
    hysteresis_Nm : numpy.ndarray
        Largest difference of readings at the same load reached from below and from above; at zero
        after weights of either direction. Shape (experiments,).
    reversibility_Nm : numpy.ndarray
        Mean of these differences as magnitudes over the loads other than zero, shape (experiments,).
    zero_return_Nm : numpy.ndarray
        Last zero reading less the first, shape (experiments,).
    repeatability_Nm : float
        Largest spread of readings at the same load and side, less their zeros, among series at the
        same position and mounting.
    reproducibility_Nm : float
        Largest spread, over positions and mountings, of the means of such readings.
    """

    linearity_Nm: NDArray[np.float64]
    hysteresis_Nm: NDArray[np.float64]
    reversibility_Nm: NDArray[np.float64]
    zero_return_Nm: NDArray[np.float64]
    repeatability_Nm: float
    reproducibility_Nm: float


def series_errors(loadings: Loadings, lines: Sequence[SensorGain]) -> SeriesErrors:
    """Find the errors of loading series.

    Parameters
    ----------
    loadings : Loadings
        The experiments.
    lines : sequence of SensorGain
        Straight line of each.

    Returns
    -------
    SeriesErrors
        Their errors.
    """
    levels = loadings.levels()
    linearity, hysteresis, reversibility, zero_return = [], [], [], []
    for rows, line in zip(loadings.rows(), lines, strict=True):
        load, path = loadings.load_Nm[rows], loadings.path[rows]
        read_Nm = line.gain_Nm_per_V * (loadings.voltage_V[rows] - line.zero_V)
        linearity.append(_linearity(load, read_Nm, path, levels[rows]))
        widths = _loop_widths(load, read_Nm, path, levels[rows])
        hysteresis.append(max((abs(width) for _, width in widths), default=np.nan))
        loaded = [abs(width) for is_zero, width in widths if not is_zero]
        reversibility.append(float(np.mean(loaded)) if loaded else np.nan)
        at_zero = np.flatnonzero(_near_zero(load))
        zero_return.append(
            read_Nm[at_zero[-1]] - read_Nm[at_zero[0]] if len(at_zero) > 1 else np.nan
        )
    repeatability, reproducibility = _spreads(loadings, lines, levels)
    return SeriesErrors(
        np.array(linearity),
        np.array(hysteresis),
        np.array(reversibility),
        np.array(zero_return),
        repeatability,
        reproducibility,
    )


def _near_zero(load: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(np.abs(load) <= 2e-3 * np.max(np.abs(load)), np.bool_)


def _means(
    values: NDArray[np.float64], numbers: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Numbers that occur, and the mean of the values of each."""
    present, place = np.unique(numbers, return_inverse=True)
    return present, np.bincount(place, values) / np.bincount(place)


def _linearity(
    load: NDArray[np.float64],
    read_Nm: NDArray[np.float64],
    path: NDArray[np.int8],
    levels: NDArray[np.intp],
) -> float:
    if len(np.unique(levels)) < 3:
        return float("nan")
    # First the mean of each side, then of both, so that neither counts more for more readings.
    sides, residuals = _means(read_Nm - load, 3 * levels + path + 1)
    _, of_level = _means(residuals, sides // 3)
    return float(np.max(np.abs(of_level)))


def _loop_widths(
    load: NDArray[np.float64],
    read_Nm: NDArray[np.float64],
    path: NDArray[np.int8],
    levels: NDArray[np.intp],
) -> list[tuple[bool, float]]:
    """Width of the loop at every load that was read on one side and lies within the other's."""
    sides = []
    for side in (1, -1):
        chosen = path == side
        if not chosen.any():
            return []
        _, at = _means(load[chosen], levels[chosen])
        _, residual = _means((read_Nm - load)[chosen], levels[chosen])
        sides.append((at, residual))
    (up, of_up), (down, of_down) = sides
    # Weights of either direction make two branches; zero parts them.
    widths = []
    tolerance = 2e-3 * float(np.max(np.abs(load)))
    for at in np.union1d(up, down):
        lower = _interpolated(at, up, of_up, tolerance)
        upper = _interpolated(at, down, of_down, tolerance)
        if lower is not None and upper is not None:
            widths.append((abs(at) <= tolerance, upper - lower))
    return widths


def _interpolated(
    at: float, loads: NDArray[np.float64], values: NDArray[np.float64], tolerance: float
) -> float | None:
    """Value between neighbours on the same side of zero; None where there are none."""
    nearest = int(np.argmin(np.abs(loads - at)))
    if abs(loads[nearest] - at) <= tolerance:
        return float(values[nearest])
    after = int(np.searchsorted(loads, at))
    if after in (0, len(loads)) or loads[after - 1] * loads[after] < 0:
        return None
    return float(np.interp(at, loads[after - 1 : after + 1], values[after - 1 : after + 1]))


def _spreads(
    loadings: Loadings, lines: Sequence[SensorGain], levels: NDArray[np.intp]
) -> tuple[float, float]:
    gain = float(np.mean([line.gain_Nm_per_V for line in lines]))
    zero_V = np.array([line.zero_V for line in lines])
    read_Nm = gain * (loadings.voltage_V - zero_V[loadings.experiment])
    groups = setups(loadings)[loadings.experiment]
    keys = np.stack([levels, loadings.path, groups], axis=1)
    present, place = np.unique(keys, axis=0, return_inverse=True)
    place = place.reshape(-1)
    counts = np.bincount(place)
    spreads = [float(np.ptp(read_Nm[place == number])) for number in np.flatnonzero(counts >= 2)]
    means = np.bincount(place, read_Nm) / counts
    between = []
    for key in np.unique(present[:, :2], axis=0):
        same = np.all(present[:, :2] == key, axis=1)
        if np.count_nonzero(same) >= 2:
            between.append(float(np.ptp(means[same])))
    return max(spreads, default=np.nan), max(between, default=np.nan)


def setups(loadings: Loadings) -> NDArray[np.intp]:
    """Give experiments at one position in one mounting the same number.

    Parameters
    ----------
    loadings : Loadings
        The experiments.

    Returns
    -------
    numpy.ndarray
        Shape (experiments,). Experiments of which neither is told are all of one setup.
    """
    keys: list[tuple[object, object]] = []
    for index in range(len(loadings.names)):
        position = None if loadings.position_rad is None else loadings.position_rad[index]
        mounting = None if loadings.mounting is None else loadings.mounting[index]
        keys.append((None if position is None else round(float(position), 3), mounting))
    order = {key: number for number, key in enumerate(dict.fromkeys(keys))}
    return np.array([order[key] for key in keys], np.intp)
