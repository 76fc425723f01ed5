"""Real torque ripple: what the meshing teeth do to the transmitted torque.

Taghirad & Belanger 1999, section V: most of the ripple is "a real torque oscillation which can be
observed in the end effector motions", twice per motor turn because the teeth mesh in two zones.
Here it is a transmission error of the gear: an angle by which the output leads, periodic in the
motor angle.  It is entered as the torque that it would make with motor and output held.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strainwave.simulate.checks import require_number
from strainwave.simulate.trajectories import FloatArray

LARGEST_GROWTH = 4.0
"""Load over rated torque, and speed over the reference, at which a line's growth ends: a ripple
that grew on with a load beyond any gear's would drive the motion to infinity."""


@dataclass(frozen=True)
class RippleOrder:
    """One line of the mesh ripple.

    Its amplitude is amplitude_Nm (1 + load_growth |torque| / rated + speed_growth |speed| /
    reference speed), neither of them counting beyond `LARGEST_GROWTH`.

    Parameters
    ----------
    order : float
        Cycles per motor turn, above 0: 2 m and 4 m where the flexspline's teeth make it, 2 and 4
        where those of a fixed circular spline do.
    amplitude_Nm : float
        Amplitude without load at standstill, at the output side, at least 0.
    phase_rad : float
        Phase at motor angle 0, sine form.
    load_growth : float
        Relative growth at rated torque, at least 0.
    speed_growth : float
        Relative growth at the reference speed, at least 0.
    """

    order: float
    amplitude_Nm: float
    phase_rad: float = 0.0
    load_growth: float = 0.0
    speed_growth: float = 0.0

    def __post_init__(self) -> None:
        require_number("order", self.order, "cycles per motor turn", above=0.0)
        require_number("amplitude_Nm", self.amplitude_Nm, "Nm", minimum=0.0)
        require_number("phase_rad", self.phase_rad, "rad")
        require_number("load_growth", self.load_growth, "", minimum=0.0)
        require_number("speed_growth", self.speed_growth, "", minimum=0.0)


@dataclass(frozen=True)
class MeshRipple:
    """All lines of the mesh ripple.

    Parameters
    ----------
    orders : tuple of RippleOrder
        The lines; none is a gear without ripple.
    rated_torque_Nm : float
        Torque to which load_growth refers, above 0.
    reference_speed_rad_s : float
        Motor speed to which speed_growth refers, above 0.
    """

    orders: tuple[RippleOrder, ...] = ()
    rated_torque_Nm: float = 40.0
    reference_speed_rad_s: float = 100.0

    def __post_init__(self) -> None:
        require_number("rated_torque_Nm", self.rated_torque_Nm, "Nm", above=0.0)
        require_number("reference_speed_rad_s", self.reference_speed_rad_s, "rad/s", above=0.0)

    def torque_Nm(
        self, motor_angle_rad: FloatArray, motor_speed_rad_s: FloatArray, load_Nm: FloatArray
    ) -> FloatArray:
        """Return the ripple torque with motor and output held.

        Parameters
        ----------
        motor_angle_rad : ndarray, shape (n,)
            Motor angle, rad.
        motor_speed_rad_s : ndarray, shape (n,)
            Motor speed, rad/s.
        load_Nm : ndarray, shape (n,)
            Transmitted torque without ripple, Nm.

        Returns
        -------
        ndarray, shape (n,)
            Ripple torque at the output side, Nm.
        """
        load = np.minimum(np.abs(load_Nm) / self.rated_torque_Nm, LARGEST_GROWTH)
        speed = np.abs(motor_speed_rad_s) / self.reference_speed_rad_s
        speed = np.minimum(speed, LARGEST_GROWTH)
        total = np.zeros(np.shape(motor_angle_rad))
        for line in self.orders:
            growth = 1.0 + line.load_growth * load + line.speed_growth * speed
            wave = np.sin(line.order * motor_angle_rad + line.phase_rad)
            total = total + line.amplitude_Nm * growth * wave
        return total
