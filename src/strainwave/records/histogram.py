"""A histogram of positive values over many decades: quantiles of a log of any length, in one pass."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LOWEST_DECADE: Final = -10
_DECADES: Final = 20
_BINS_PER_DECADE: Final = 1000


class LogHistogram:
    """Counts and sums in bins of 0.23 percent, from 1e-10 to 1e10.

    A quantile is the mean of the values in its bin: exact where a log is regular, and within 0.23
    percent otherwise. What lies outside counts with the nearest bin.
    """

    def __init__(self) -> None:
        self._counts = np.zeros(_DECADES * _BINS_PER_DECADE, np.int64)
        self._sums = np.zeros(_DECADES * _BINS_PER_DECADE)
        self.smallest = np.inf
        self.largest = -np.inf

    def add(self, values: NDArray[np.float64]) -> None:
        """Count values.

        Parameters
        ----------
        values : numpy.ndarray
            Finite values above 0.
        """
        if not len(values):
            return
        places = np.log10(values)
        places -= _LOWEST_DECADE
        places *= _BINS_PER_DECADE
        bins = places.astype(np.int64)
        first, last = int(bins.min()), int(bins.max())
        if first < 0 or last >= len(self._counts):
            np.clip(bins, 0, len(self._counts) - 1, out=bins)
            first, last = int(bins.min()), int(bins.max())
        # Most values lie in few bins, and the others need not be gone through.
        bins -= first
        found = slice(first, last + 1)
        self._counts[found] += np.bincount(bins)
        self._sums[found] += np.bincount(bins, weights=values)
        self.smallest = min(self.smallest, float(values.min()))
        self.largest = max(self.largest, float(values.max()))

    @property
    def count(self) -> int:
        """How many values were added."""
        return int(self._counts.sum())

    def quantile(self, share: float) -> float | None:
        """Return the value below which a share of all values lies.

        Parameters
        ----------
        share : float
            0 to 1.

        Returns
        -------
        float or None
            The quantile; None where nothing was added.
        """
        count = self.count
        if count == 0:
            return None
        place = int(np.searchsorted(np.cumsum(self._counts), min(count, share * count + 0.5)))
        place = min(place, int(np.flatnonzero(self._counts)[-1]))
        mean = self._sums[place] / self._counts[place]
        return float(np.clip(mean, self.smallest, self.largest))

    def count_above(self, value: float) -> int:
        """Count the values above a limit, to within a bin.

        Parameters
        ----------
        value : float
            The limit, above 0.

        Returns
        -------
        int
            How many values lie above.
        """
        filled = np.flatnonzero(self._counts)
        means = self._sums[filled] / self._counts[filled]
        return int(self._counts[filled][means > value].sum())
