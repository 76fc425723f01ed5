"""The whole chain over recordings: converter codes in, torque with the ripple removed out."""

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
class SensorResult:
    """What the sensor makes of a recording, sample by sample.

    Attributes
    ----------
    torque_measured_Nm : numpy.ndarray
        Calibrated torque with its ripple, shape (samples,), Nm.
    torque_Nm : numpy.ndarray
        Torque with the predicted ripple removed, shape (samples,), Nm.
    ripple_Nm : numpy.ndarray
        Predicted ripple, shape (samples,), Nm.
    status : numpy.ndarray
        Bits of `strainwave.StatusFlag`, shape (samples,), uint32.
    left_out_gauge : numpy.ndarray
        Number of the gauge that the torque was made without, from 1, 0 where all are used; shape
        (samples,), uint8. Without a monitor always 0.
    """

    torque_measured_Nm: NDArray[Any]
    torque_Nm: NDArray[Any]
    ripple_Nm: NDArray[Any]
    status: NDArray[np.uint32]
    left_out_gauge: NDArray[np.uint8]


class TorqueSensor:
    """Converter codes to volts, gains, calibration and ripple filter: the core's chain.

    Parameters
    ----------
    config : TorqueSensorConfig
        Converter, gains, calibration, and either filter: with a RippleFilterConfig the ripple
        filter, strainwave's default; with an OscillatorFilterConfig the published one.
    learned : LearnedRipple, optional
        Coefficients for the ripple filter to start with, from `learned` of an earlier run or
        `strainwave.configuration.learned_of`; sensible only where the angle counts from the same
        zero as then.
    dtype : dtype_like
        float64, or float32 as on a microcontroller.
    """

    def __init__(
        self,
        config: _core.TorqueSensorConfig,
        learned: _core.LearnedRipple | None = None,
        *,
        dtype: DTypeLike = np.float64,
    ) -> None:
        if not isinstance(config, _core.TorqueSensorConfig):
            raise InputError(
                f"config = {config!r}: expected a TorqueSensorConfig; make one, or take that of a "
                "joint file from strainwave.configuration.sensor_of(joint)"
            )
        if learned is not None and not isinstance(learned, _core.LearnedRipple):
            raise InputError(
                f"learned = {learned!r}: expected a LearnedRipple; take one from a sensor's "
                "learned()"
            )
        self._dtype = precision(dtype)
        self._sensor = _core.TorqueSensor(
            config, single_precision=self._dtype is np.float32, learned=learned
        )

    @property
    def config(self) -> _core.TorqueSensorConfig:
        """The configuration, which does not change."""
        return self._sensor.config

    @property
    def counters(self) -> dict[str, int]:
        """How many samples there were, and how often each status flag was raised."""
        return dict(self._sensor.counters)

    @property
    def lost_gauge(self) -> int:
        """Number of the gauge that the monitor found lost, from 1; 0 where none is."""
        number, _ = self._sensor.lost_gauge
        return number

    @property
    def gauge_fault(self) -> _core.GaugeFault:
        """What has become of the lost gauge."""
        _, fault = self._sensor.lost_gauge
        return fault

    @property
    def residual_fluctuation_Nm(self) -> float:
        """Root mean square of the fluctuation that the gains now in use leave, Nm.

        As the monitor was told; 0 without a monitor and before the first sample.
        """
        return self._sensor.residual_fluctuation_Nm

    def clear_lost_gauge(self) -> None:
        """Forget the loss of a gauge, after its repair; the monitor begins anew."""
        self._sensor.clear_lost_gauge()

    def process(
        self,
        codes: ArrayLike,
        *,
        motor_speed_rad_s: ArrayLike | None = None,
        motor_angle_rad: ArrayLike | None = None,
        expected_torque_Nm: ArrayLike | None = None,
        temperature_degC: ArrayLike | None = None,
        sequence: ArrayLike | None = None,
        time_s: ArrayLike | None = None,
        angle_referenced: bool = True,
        out: SensorResult | None = None,
    ) -> SensorResult:
        """Run samples through the chain; the state goes on to the next call.

        Parameters
        ----------
        codes : array_like
            Converter codes, shape (samples, channels), whole numbers.
        motor_speed_rad_s : array_like, optional
            Motor speed, rad/s; needed where the oscillator filter turns by speed.
        motor_angle_rad : array_like, optional
            Motor angle, rad, not wrapped; needed by the ripple filter, and where the oscillator
            filter turns by angle. NaN where it is not known.
        expected_torque_Nm : array_like, optional
            Expected torque, Nm; 0 without.
        temperature_degC : array_like, optional
            Temperature, degrees Celsius; the calibration's reference without.
        sequence : array_like, optional
            Sample numbers, modulo 2^32: the same again is a repeated sample, a larger step a gap.
            Counted up by one without.
        time_s : array_like, optional
            Time stamps as recorded, s, for the ripple filter. Jitter and gaps are taken as they
            are; a sample that is not later than the one before is rejected. Without, samples are
            `config.sample_period_s` apart. The oscillator filter goes by samples and does not use
            them.
        angle_referenced : bool
            False where the angle counts from an unknown zero: the ripple filter's frozen terms
            then wait.
        out : SensorResult, optional
            An earlier result for as many samples, whose arrays are written over; new ones without.

        Returns
        -------
        SensorResult
            Torque before and after, ripple, status and left-out gauge of every sample; `out` where
            it is given.

        Raises
        ------
        InputError
            If an array is missing or of another length or kind.
        """
        dtype = self._dtype
        run: Any = (
            self._sensor.process_float32 if dtype is np.float32 else self._sensor.process_float64
        )
        inputs = (
            contiguous("codes", codes, np.int32, dimensions=2),
            optional_contiguous("motor_speed_rad_s", motor_speed_rad_s, dtype),
            optional_contiguous("motor_angle_rad", motor_angle_rad, np.float64),
            optional_contiguous("expected_torque_Nm", expected_torque_Nm, dtype),
            optional_contiguous("temperature_degC", temperature_degC, dtype),
            optional_contiguous("sequence", sequence, np.uint32),
            optional_contiguous("time_s", time_s, np.float64),
        )
        arrays = arrays_of(out, len(inputs[0]), dtype, inputs)
        results = run(*inputs, bool(angle_referenced), arrays)
        return SensorResult(*results) if out is None else out

    def learned(self) -> _core.LearnedRipple:
        """Coefficients of the ripple filter as they are now, to keep over a power cycle.

        Returns
        -------
        LearnedRipple
            Coefficients against the motor's angle, with standard deviations.

        Raises
        ------
        InputError
            If the filter is the oscillator filter.
        """
        return self._sensor.learned()

    def reset(self) -> None:
        """Go back to the state at power-up, with the coefficients given there."""
        self._sensor.reset()

    def copy(self) -> TorqueSensor:
        """Make an independent sensor in the same state.

        Returns
        -------
        TorqueSensor
            The copy.
        """
        twin = object.__new__(type(self))
        twin.__dict__.update(self.__dict__)
        twin._sensor = self._sensor.copy()
        return twin

    def __copy__(self) -> TorqueSensor:
        """Copy like `copy`: two objects never share a state."""
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> TorqueSensor:
        """Copy like `copy`."""
        return self.copy()
