"""Arrays in, arrays out: the ripple filter as published, over recordings and chunk by chunk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import _core
from strainwave.arrays import arrays_of, contiguous, optional_contiguous, precision
from strainwave.errors import InputError

if TYPE_CHECKING:
    import numbers

    from numpy.typing import ArrayLike, DTypeLike, NDArray

#: Names of the published configurations.
PRESETS = ("taghirad1999", "taghirad1999-4")


@dataclass(frozen=True)
class FilterResult:
    """What a filter makes of a recording, sample by sample.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        Measured torque minus predicted ripple, shape (samples,), Nm. A rejected sample holds the
        last good value.
    ripple_Nm : numpy.ndarray
        Ripple as predicted from the samples before, shape (samples,), Nm.
    status : numpy.ndarray
        Bits of `strainwave.StatusFlag`, shape (samples,), uint32.
    """

    torque_Nm: NDArray[Any]
    ripple_Nm: NDArray[Any]
    status: NDArray[np.uint32]


def oscillator_preset(
    name: str, ratio: float | numbers.Rational | _core.Rational = 100
) -> _core.OscillatorFilterConfig:
    """Look up a published configuration by its name.

    Parameters
    ----------
    name : str
        ``"taghirad1999"`` (orders 2, 4 and 1/ratio) or ``"taghirad1999-4"`` (orders 2 and 4):
        Taghirad & Belanger 1999, sections VI and V.
    ratio : float or fractions.Fraction or Rational
        Motor turns per output turn, a magnitude; used by ``"taghirad1999"``.

    Returns
    -------
    OscillatorFilterConfig
        Q = 1e3 I, R = 1, P(0) = 1e3 I, 1 ms, no protection: the paper and nothing else.

    Raises
    ------
    InputError
        If there is no preset of that name.
    """
    if name == "taghirad1999":
        return _core.OscillatorFilterConfig.taghirad1999(ratio)
    if name == "taghirad1999-4":
        return _core.OscillatorFilterConfig.taghirad1999_4()
    raise InputError(
        f"preset = {name!r} is unknown: expected one of {', '.join(PRESETS)}; check the spelling"
    )


class OscillatorFilter:
    """Kalman filter on harmonic oscillators. Taghirad & Belanger 1999, eq. (9) to (14).

    Parameters
    ----------
    config : OscillatorFilterConfig
        Orders, noise variances, protection; see `oscillator_preset` for the published ones.
    dtype : dtype_like
        float64, or float32 as on a microcontroller.
    least_capacity : int
        Orders the compiled filter must at least have room for. The result does not depend on it.

    Attributes
    ----------
    step : callable
        ``step(torque_Nm, motion)`` takes one sample and returns its torque without ripple, Nm;
        ``motion`` is the motor's speed, rad/s, or its angle, rad, whichever the configuration turns
        by. It is the core's own method, without anything of Python's around it.
    """

    def __init__(
        self,
        config: _core.OscillatorFilterConfig,
        *,
        dtype: DTypeLike = np.float64,
        least_capacity: int = 1,
    ) -> None:
        if not isinstance(config, _core.OscillatorFilterConfig):
            raise InputError(
                f"config = {config!r}: expected an OscillatorFilterConfig; make one, or take a "
                "published one from oscillator_preset(name)"
            )
        self._dtype = precision(dtype)
        self._filter = _core.OscillatorFilter(
            config,
            single_precision=self._dtype is np.float32,
            least_capacity=least_capacity,
        )
        self.step = self._filter.step

    @property
    def config(self) -> _core.OscillatorFilterConfig:
        """The configuration, which does not change."""
        return self._filter.config

    @property
    def capacity(self) -> int:
        """Orders the compiled filter has room for."""
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
        torque_Nm: ArrayLike,
        *,
        motor_speed_rad_s: ArrayLike | None = None,
        motor_angle_rad: ArrayLike | None = None,
        expected_torque_Nm: ArrayLike | None = None,
        out: FilterResult | None = None,
    ) -> FilterResult:
        """Remove the ripple from samples; the state goes on to the next call.

        Chunks of a recording give the same as one call to the last bit. Contiguous arrays of the
        filter's precision (angles: float64) are read where they are, read-only ones too; others are
        copied once. Other threads of Python go on meanwhile.

        Parameters
        ----------
        torque_Nm : array_like
            Measured torque, shape (samples,), Nm.
        motor_speed_rad_s : array_like, optional
            Motor speed, rad/s; needed where the configuration turns by speed.
        motor_angle_rad : array_like, optional
            Motor angle, rad, not wrapped; needed where the configuration turns by angle.
        expected_torque_Nm : array_like, optional
            T_exp of section V, for example load inertia times acceleration; 0 without.
        out : FilterResult, optional
            An earlier result for as many samples, whose arrays are written over; new ones without.

        Returns
        -------
        FilterResult
            Torque, ripple and status of every sample; `out` where it is given.

        Raises
        ------
        InputError
            If an array is missing or of another length or kind.
        """
        torque = contiguous("torque_Nm", torque_Nm, self._dtype)
        speed = optional_contiguous("motor_speed_rad_s", motor_speed_rad_s, self._dtype)
        angle = optional_contiguous("motor_angle_rad", motor_angle_rad, np.float64)
        expected = optional_contiguous("expected_torque_Nm", expected_torque_Nm, self._dtype)
        run: Any = (
            self._filter.process_float32
            if self._dtype is np.float32
            else self._filter.process_float64
        )
        arrays = arrays_of(out, len(torque), self._dtype, (torque, speed, angle, expected))
        results = run(torque, speed, angle, expected, arrays)
        return FilterResult(*results) if out is None else out

    def predicted_state(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """State and covariance predicted for the next sample.

        Returns
        -------
        states_Nm : numpy.ndarray
            x(k+1), shape (2 orders,), Nm.
        covariance_Nm2 : numpy.ndarray
            P(k+1), shape (2 orders, 2 orders), Nm^2.
        """
        states, covariance = self._filter.predicted_state()
        return states, covariance

    def reset(self) -> None:
        """Go back to x(0) and P(0)."""
        self._filter.reset()

    def copy(self) -> OscillatorFilter:
        """Make an independent filter in the same state.

        Returns
        -------
        OscillatorFilter
            The copy.
        """
        twin = object.__new__(type(self))
        twin.__dict__.update(self.__dict__)
        twin._filter = self._filter.copy()
        twin.step = twin._filter.step
        return twin

    def __copy__(self) -> OscillatorFilter:
        """Copy like `copy`: two objects never share a state."""
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> OscillatorFilter:
        """Copy like `copy`."""
        return self.copy()
