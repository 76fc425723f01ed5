"""The whole chain over recordings: converter codes in, torque with the ripple removed out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous, optional_contiguous, precision
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
    """

    torque_measured_Nm: NDArray[Any]
    torque_Nm: NDArray[Any]
    ripple_Nm: NDArray[Any]
    status: NDArray[np.uint32]


class TorqueSensor:
    """Converter codes to volts, gains, calibration and ripple filter: the core's chain.

    Parameters
    ----------
    config : TorqueSensorConfig
        Converter, gains, calibration, filter.
    dtype : dtype_like
        float64, or float32 as on a microcontroller.
    """

    def __init__(self, config: _core.TorqueSensorConfig, *, dtype: DTypeLike = np.float64) -> None:
        if not isinstance(config, _core.TorqueSensorConfig):
            raise InputError(
                f"config = {config!r}: expected a TorqueSensorConfig; make one, or take that of a "
                "joint file from strainwave.configuration.sensor_of(joint)"
            )
        self._dtype = precision(dtype)
        self._sensor = _core.TorqueSensor(config, single_precision=self._dtype is np.float32)

    @property
    def config(self) -> _core.TorqueSensorConfig:
        """The configuration, which does not change."""
        return self._sensor.config

    @property
    def counters(self) -> dict[str, int]:
        """How many samples there were, and how often each status flag was raised."""
        return dict(self._sensor.counters)

    def process(
        self,
        codes: ArrayLike,
        *,
        motor_speed_rad_s: ArrayLike | None = None,
        motor_angle_rad: ArrayLike | None = None,
        expected_torque_Nm: ArrayLike | None = None,
        temperature_degC: ArrayLike | None = None,
        sequence: ArrayLike | None = None,
    ) -> SensorResult:
        """Run samples through the chain; the state goes on to the next call.

        Parameters
        ----------
        codes : array_like
            Converter codes, shape (samples, channels), whole numbers.
        motor_speed_rad_s : array_like, optional
            Motor speed, rad/s; needed where the filter turns by speed.
        motor_angle_rad : array_like, optional
            Motor angle, rad, not wrapped; needed where the filter turns by angle.
        expected_torque_Nm : array_like, optional
            Expected torque, Nm; 0 without.
        temperature_degC : array_like, optional
            Temperature, degrees Celsius; the calibration's reference without.
        sequence : array_like, optional
            Sample numbers, modulo 2^32: the same again is a repeated sample, a larger step a gap.
            Counted up by one without.

        Returns
        -------
        SensorResult
            Torque before and after, ripple and status of every sample.

        Raises
        ------
        InputError
            If an array is missing or of another length or kind.
        """
        dtype = self._dtype
        run: Any = (
            self._sensor.process_float32 if dtype is np.float32 else self._sensor.process_float64
        )
        return SensorResult(
            *run(
                contiguous("codes", codes, np.int32, dimensions=2),
                optional_contiguous("motor_speed_rad_s", motor_speed_rad_s, dtype),
                optional_contiguous("motor_angle_rad", motor_angle_rad, np.float64),
                optional_contiguous("expected_torque_Nm", expected_torque_Nm, dtype),
                optional_contiguous("temperature_degC", temperature_degC, dtype),
                optional_contiguous("sequence", sequence, np.uint32),
            )
        )

    def reset(self) -> None:
        """Go back to the state at power-up."""
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
