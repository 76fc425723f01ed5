"""From columns of gauge voltages to torque, by the gains and the calibration of the joint file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.configuration import calibration_of, converter_of, gains_of
from strainwave.errors import InputError
from strainwave.records.mapping import is_gauge_key

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray

    from strainwave.joint import Joint

#: Beyond this no converter has a code.
_LARGEST_CODE: Final = 2.0**31 - 1


@dataclass(frozen=True)
class SensorChain:
    """Gains and calibration: Godler 2000, eq. (7); Taghirad & Belanger 1999, section IV.

    Parameters
    ----------
    joint : Joint
        A joint with ``[gear]`` and ``[torque_calibration]``; without ``[gains]`` they are all 1.
    """

    joint: Joint

    def volts(self, codes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert a column of converter codes.

        Parameters
        ----------
        codes : numpy.ndarray
            Codes, shape (rows,); NaN where there is none.

        Returns
        -------
        numpy.ndarray
            Volts, shape (rows,); NaN where there is none.

        Raises
        ------
        InputError
            If the joint file does not describe the converter.
        """
        usable = np.abs(codes) <= _LARGEST_CODE
        whole = np.where(usable, np.rint(codes), 0.0).astype(np.int32)
        return np.where(usable, converter_of(self.joint).to_volts(whole), np.nan)

    def torque_Nm(
        self, gauges_V: NDArray[np.float64], temperature_degC: NDArray[np.float64] | None
    ) -> NDArray[np.float64]:
        """Compute the torque, ripple included.

        Parameters
        ----------
        gauges_V : numpy.ndarray
            Voltage of every gauge, shape (rows, gauges), V.
        temperature_degC : numpy.ndarray or None
            Temperature of the flexspline, shape (rows,), degC; the reference temperature without.

        Returns
        -------
        numpy.ndarray
            Torque, shape (rows,), Nm; NaN where a voltage is missing.
        """
        calibration = calibration_of(self.joint)
        if temperature_degC is None:
            temperature_degC = np.full(len(gauges_V), calibration.reference_temperature_degC)
        # Without a temperature a row has none of the drift taken off, rather than no torque.
        known = np.isfinite(temperature_degC)
        filled = np.where(known, temperature_degC, calibration.reference_temperature_degC)
        weighted_V = self._gains().weighted_sum(np.ascontiguousarray(gauges_V))
        return np.asarray(calibration.torque_Nm(weighted_V, filled))

    def _gains(self) -> _core.Gains:
        if self.joint.gains is None and self.joint.gauges is None:
            return _core.Gains([1.0])
        return gains_of(self.joint)


def build_chain(joint: Joint | None, keys: Collection[str]) -> SensorChain:
    """Build the chain from gauges to torque, and make sure that everything for it is there.

    Parameters
    ----------
    joint : Joint or None
        What is known of the joint.
    keys : collection of str
        What is mapped.

    Returns
    -------
    SensorChain
        The chain.

    Raises
    ------
    InputError
        If there is no calibration, or another number of gauges than of gains.
    """
    if joint is None:
        raise InputError(
            "--map: gauges are mapped, and nothing says what torque their voltage is; expected a "
            "joint file with [gear] and [torque_calibration], so add --joint, or map torque instead"
        )
    name = f'joint "{joint.identity.name}"'
    for section, value, command in (
        ("gear", joint.gear, "strainwave joint new"),
        ("torque_calibration", joint.torque_calibration, "strainwave calibrate torque"),
    ):
        if value is None:
            raise InputError(
                f"{name}: it has no [{section}], which turns the voltage of the mapped gauges into "
                f"torque; expected it, so add it (`{command}`), or map torque instead"
            )
    gauges = sum(is_gauge_key(key) for key in keys)
    if joint.gains is None and joint.gauges is None:
        if gauges > 1:
            raise InputError(
                f"{name}: {gauges} gauges are mapped, and it has neither [gains] nor [gauges]; "
                "expected the gain of each gauge, so find them (`strainwave calibrate "
                "fluctuation`), or map the one voltage of a full bridge"
            )
        return SensorChain(joint)
    expected = len(gains_of(joint).values)
    if gauges != expected:
        raise InputError(
            f"--map: {gauges} gauges are mapped, and {name} has gains for {expected}; expected one "
            "column for each gain, in their order, so correct the mapping"
        )
    return SensorChain(joint)
