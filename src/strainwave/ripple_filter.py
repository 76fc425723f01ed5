"""The ripple filter, strainwave's default: arrays in, arrays out, chunk by chunk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import _core
from strainwave.arrays import arrays_of, contiguous, optional_contiguous, precision
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray


@dataclass(frozen=True)
class RippleResult:
    """What the ripple filter makes of samples, one value for each.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        Measured torque minus ripple, shape (samples,), Nm; orders marked `keep` stay in it. A
        rejected sample holds the last good value.
    ripple_Nm : numpy.ndarray
        What was removed, predicted from the samples before, shape (samples,), Nm.
    torque_all_removed_Nm : numpy.ndarray
        Measured torque minus the ripple of every order, kept ones too, shape (samples,), Nm.
    torque_state_Nm : numpy.ndarray
        The filter's own estimate of true torque, shape (samples,), Nm: smoother, and later.
    innovation_Nm : numpy.ndarray
        Measurement minus prediction, shape (samples,), Nm; 0 where nothing was learned.
    innovation_variance_Nm2 : numpy.ndarray
        Variance that the filter expected of it, shape (samples,), Nm^2; 0 likewise.
    status : numpy.ndarray
        Bits of `strainwave.StatusFlag`, shape (samples,), uint32.
    """

    torque_Nm: NDArray[Any]
    ripple_Nm: NDArray[Any]
    torque_all_removed_Nm: NDArray[Any]
    torque_state_Nm: NDArray[Any]
    innovation_Nm: NDArray[Any]
    innovation_variance_Nm2: NDArray[Any]
    status: NDArray[np.uint32]


class RippleFilter:
    """Kalman filter on true torque and on ripple coefficients that belong to the motor's angle.

    Parameters
    ----------
    config : RippleFilterConfig
        Orders, memory, noise, delay.
    learned : LearnedRipple, optional
        Coefficients to start with, from `learned` of an earlier run; sensible only where the angle
        counts from the same zero as then.
    dtype : dtype_like
        float64, or float32 as on a microcontroller.
    least_capacity : int
        Pairs of coefficients the compiled filter must at least have room for. The result does not
        depend on it.

    Attributes
    ----------
    step : callable
        ``step(time_s, motor_angle_rad, torque_Nm)`` takes one sample and returns its torque without
        ripple, Nm. It is the core's own method, without anything of Python's around it.
    """

    def __init__(
        self,
        config: _core.RippleFilterConfig,
        *,
        learned: _core.LearnedRipple | None = None,
        dtype: DTypeLike = np.float64,
        least_capacity: int = 1,
    ) -> None:
        if not isinstance(config, _core.RippleFilterConfig):
            raise InputError(
                f"config = {config!r}: expected a RippleFilterConfig; make one, for example "
                "RippleFilterConfig(orders=[2, 4, 6])"
            )
        if learned is not None and not isinstance(learned, _core.LearnedRipple):
            raise InputError(
                f"learned = {learned!r}: expected a LearnedRipple; take one from a filter's "
                "learned()"
            )
        self._dtype = precision(dtype)
        self._filter = _core.RippleFilter(
            config,
            single_precision=self._dtype is np.float32,
            least_capacity=least_capacity,
            learned=learned,
        )
        self.step = self._filter.step

    @property
    def config(self) -> _core.RippleFilterConfig:
        """The configuration, which does not change."""
        return self._filter.config

    @property
    def capacity(self) -> int:
        """Pairs of coefficients the compiled filter has room for."""
        return self._filter.capacity

    @property
    def counters(self) -> dict[str, int]:
        """How many samples there were, and how often each status flag was raised."""
        return dict(self._filter.counters)

    @property
    def last_step(self) -> tuple[float, int]:
        """Ripple, Nm, and bits of `strainwave.StatusFlag` of the last `step`."""
        return self._filter.last_step

    def process(
        self,
        time_s: ArrayLike,
        motor_angle_rad: ArrayLike,
        torque_Nm: ArrayLike,
        *,
        expected_torque_Nm: ArrayLike | None = None,
        angle_referenced: bool = True,
        out: RippleResult | None = None,
    ) -> RippleResult:
        """Remove the ripple from samples; the state goes on to the next call.

        Chunks of a recording give the same as one call to the last bit. Contiguous arrays of the
        filter's precision (times and angles: float64) are read where they are, read-only ones too;
        others are copied once. Other threads of Python go on meanwhile.

        Parameters
        ----------
        time_s : array_like
            Time stamps as recorded, shape (samples,), s. Jitter and gaps are taken as they are; a
            sample that is not later than the one before is rejected.
        motor_angle_rad : array_like
            Motor angle, shape (samples,), rad, not wrapped; NaN where it is not known.
        torque_Nm : array_like
            Measured torque, shape (samples,), Nm.
        expected_torque_Nm : array_like, optional
            Part of the true torque that is known, for example load inertia times acceleration.
        angle_referenced : bool
            False where the angle counts from an unknown zero: frozen terms then wait.
        out : RippleResult, optional
            An earlier result for as many samples, whose arrays are written over; new ones without.

        Returns
        -------
        RippleResult
            Torque, ripple and status of every sample; `out` where it is given.

        Raises
        ------
        InputError
            If an array is of another length or kind.
        """
        time = contiguous("time_s", time_s, np.float64)
        angle = contiguous("motor_angle_rad", motor_angle_rad, np.float64)
        torque = contiguous("torque_Nm", torque_Nm, self._dtype)
        expected = optional_contiguous("expected_torque_Nm", expected_torque_Nm, self._dtype)
        run: Any = (
            self._filter.process_float32
            if self._dtype is np.float32
            else self._filter.process_float64
        )
        arrays = arrays_of(out, len(torque), self._dtype, (time, angle, torque, expected))
        results = run(time, angle, torque, expected, bool(angle_referenced), arrays)
        return RippleResult(*results) if out is None else out

    def learned(self) -> _core.LearnedRipple:
        """Coefficients as they are now, to keep over a power cycle.

        Returns
        -------
        LearnedRipple
            Coefficients against the motor's angle, with standard deviations.
        """
        return self._filter.learned()

    def order_ripple(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ripple of each order at the present load and speed.

        Returns
        -------
        amplitude_Nm : numpy.ndarray
            Shape (orders,), Nm, zero to peak.
        phase_rad : numpy.ndarray
            Shape (orders,), rad: the ripple is amplitude x cos(order x angle - phase).
        """
        amplitude, phase = self._filter.order_ripple()
        return amplitude, phase

    def state(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """State and covariance after the last sample.

        Returns
        -------
        states_Nm : numpy.ndarray
            [T; c], shape (1 + 2 pairs,), Nm.
        covariance_Nm2 : numpy.ndarray
            Shape (1 + 2 pairs, 1 + 2 pairs), Nm^2. It does not cover errors of the model: no
            uncertainty of the torque follows from it.
        """
        states, covariance = self._filter.state()
        return states, covariance

    def reset(self) -> None:
        """Go back to the start, with the coefficients given there."""
        self._filter.reset()

    def copy(self) -> RippleFilter:
        """Make an independent filter in the same state.

        Returns
        -------
        RippleFilter
            The copy.
        """
        twin = object.__new__(type(self))
        twin.__dict__.update(self.__dict__)
        twin._filter = self._filter.copy()
        twin.step = twin._filter.step
        return twin

    def __copy__(self) -> RippleFilter:
        """Copy like `copy`: two objects never share a state."""
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> RippleFilter:
        """Copy like `copy`."""
        return self.copy()
