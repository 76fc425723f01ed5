"""What is measured: a method of removing ripple, built anew for every run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.errors import InputError
from strainwave.methods.interface import joined

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from strainwave.methods.interface import Method
    from strainwave.samples import Samples


@dataclass(frozen=True)
class Subject:
    """A method under test, and what its synthetic recordings are made from.

    Attributes
    ----------
    name : str
        Name of the method.
    build : callable
        Gives the method in its state before the first row.
    sample_period_s : float
        Time from one row to the next, s.
    rated_torque_Nm : float
        Full scale, Nm.
    noise_Nm : float
        Standard deviation of the noise of one sample, Nm.
    removed_orders : tuple of float
        What the method takes out, cycles per motor turn.
    ripple_orders : tuple of float
        What the recordings' ripple consists of, cycles per motor turn.
    memory_turns : float
        Memory of the ripple filter, motor turns; 0 for other methods.
    assumptions : tuple of str
        What nobody said and was taken to be so, a sentence each.
    """

    name: str
    build: Callable[[], Method]
    sample_period_s: float
    rated_torque_Nm: float
    noise_Nm: float
    removed_orders: tuple[float, ...]
    ripple_orders: tuple[float, ...]
    memory_turns: float = 0.0
    assumptions: tuple[str, ...] = ()

    def run(self, samples: Samples) -> NDArray[np.float64]:
        """Run the method from its start over a recording.

        Parameters
        ----------
        samples : Samples
            The recording.

        Returns
        -------
        numpy.ndarray
            Torque without ripple, shape (rows,), Nm.

        Raises
        ------
        InputError
            If what comes out is not one finite torque a row.
        """
        method = self.build()
        torque_Nm = joined([method.process(samples), method.finish()]).torque_Nm
        if len(torque_Nm) != len(samples) or not np.all(np.isfinite(torque_Nm)):
            raise InputError(
                f"method {self.name} gave {np.count_nonzero(np.isfinite(torque_Nm))} finite torques "
                f"for {len(samples)} rows: expected one for each; correct its tuning"
            )
        return torque_Nm
