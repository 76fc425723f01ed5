"""The parts of the drive: motor, friction, flexspline, load. What each does, not how they move."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from strainwave.errors import ConfigurationError
from strainwave.simulate.checks import require_number
from strainwave.simulate.trajectories import FloatArray

SMALLEST_HYSTERESIS_NM = 1e-6
"""Below it the hysteresis is as stiff as rounding is coarse."""


@dataclass(frozen=True)
class Friction:
    """Friction torque against the motor's rotation: Coulomb, viscous, Stribeck, with the load.

    Parameters
    ----------
    coulomb_Nm : float
        Friction at any speed, at the motor side, at least 0.
    viscous_Nm_s_per_rad : float
        Growth with speed, at least 0.
    stribeck_Nm : float
        What breakaway takes on top of the Coulomb friction, at least 0.
    stribeck_speed_rad_s : float
        Speed at which that excess has fallen to 1/e, above 0.
    load_share : float
        Share of the transmitted torque (at the motor side) lost in the mesh, at least 0.
    creep_speed_rad_s : float
        Speed below which friction falls to zero instead of holding, above 0: contacts creep.
    """

    coulomb_Nm: float = 0.0
    viscous_Nm_s_per_rad: float = 0.0
    stribeck_Nm: float = 0.0
    stribeck_speed_rad_s: float = 2.0
    load_share: float = 0.0
    creep_speed_rad_s: float = 0.5

    def __post_init__(self) -> None:
        require_number("coulomb_Nm", self.coulomb_Nm, "Nm", minimum=0.0)
        require_number("viscous_Nm_s_per_rad", self.viscous_Nm_s_per_rad, "Nm s/rad", minimum=0.0)
        require_number("stribeck_Nm", self.stribeck_Nm, "Nm", minimum=0.0)
        require_number("stribeck_speed_rad_s", self.stribeck_speed_rad_s, "rad/s", above=0.0)
        require_number("load_share", self.load_share, "", minimum=0.0)
        require_number("creep_speed_rad_s", self.creep_speed_rad_s, "rad/s", above=0.0)

    def torque_Nm(self, speed_rad_s: FloatArray, load_at_motor_Nm: FloatArray) -> FloatArray:
        """Return the friction torque, which opposes the speed.

        Parameters
        ----------
        speed_rad_s : ndarray, shape (n,)
            Motor speed, rad/s.
        load_at_motor_Nm : ndarray, shape (n,)
            Transmitted torque divided by the ratio, Nm.

        Returns
        -------
        ndarray, shape (n,)
            Friction torque at the motor side, Nm, with the sign of the speed.
        """
        excess = self.stribeck_Nm * np.exp(-((speed_rad_s / self.stribeck_speed_rad_s) ** 2))
        dry = self.coulomb_Nm + excess + self.load_share * np.abs(load_at_motor_Nm)
        direction = np.tanh(speed_rad_s / self.creep_speed_rad_s)
        return np.asarray(dry * direction + self.viscous_Nm_s_per_rad * speed_rad_s)

    def scalar_torque_Nm(self, speed_rad_s: float, load_at_motor_Nm: float) -> float:
        """Return the same for one instant, for the integration of the motion.

        Parameters
        ----------
        speed_rad_s : float
            Motor speed, rad/s.
        load_at_motor_Nm : float
            Transmitted torque divided by the ratio, Nm.

        Returns
        -------
        float
            Friction torque at the motor side, Nm.
        """
        relative = speed_rad_s / self.stribeck_speed_rad_s
        excess = self.stribeck_Nm * math.exp(-min(relative * relative, 700.0))
        dry = self.coulomb_Nm + excess + self.load_share * abs(load_at_motor_Nm)
        direction = math.tanh(speed_rad_s / self.creep_speed_rad_s)
        return dry * direction + self.viscous_Nm_s_per_rad * speed_rad_s

    def steepest_Nm_s_per_rad(self, largest_load_at_motor_Nm: float) -> float:
        """Return an upper bound of the friction's slope over speed.

        Parameters
        ----------
        largest_load_at_motor_Nm : float
            Largest load to reckon with, Nm at the motor side.

        Returns
        -------
        float
            Slope, Nm s/rad.
        """
        dry = self.coulomb_Nm + self.stribeck_Nm + self.load_share * largest_load_at_motor_Nm
        return dry / self.creep_speed_rad_s + self.viscous_Nm_s_per_rad


@dataclass(frozen=True)
class Motor:
    """A direct-current motor with the wave generator on its shaft.

    Parameters
    ----------
    torque_constant_Nm_per_A : float
        Torque per current, above 0.
    torque_limit_Nm : float
        Largest torque, above 0; the current is limited to what makes it.
    inertia_kg_m2 : float
        Rotor and wave generator, above 0.
    friction : Friction
        Friction at the motor side, the gear's own included.
    """

    torque_constant_Nm_per_A: float = 0.0543
    torque_limit_Nm: float = 0.15
    inertia_kg_m2: float = 1e-4
    friction: Friction = field(default_factory=Friction)

    def __post_init__(self) -> None:
        require_number("torque_constant_Nm_per_A", self.torque_constant_Nm_per_A, "Nm/A", above=0.0)
        require_number("torque_limit_Nm", self.torque_limit_Nm, "Nm", above=0.0)
        require_number("inertia_kg_m2", self.inertia_kg_m2, "kg m^2", above=0.0)

    @property
    def current_limit_A(self) -> float:
        """Largest current, A."""
        return self.torque_limit_Nm / self.torque_constant_Nm_per_A


@dataclass(frozen=True)
class Load:
    """What hangs on the output.

    Parameters
    ----------
    inertia_kg_m2 : float
        Moment of inertia about the output axis, above 0.
    viscous_Nm_s_per_rad : float
        Drag of the output, at least 0.
    gravity_Nm : float
        Gravity torque at output angle pi/2; it varies as the sine of the output angle.
    bearing_friction_Nm : float
        Dry friction of the output bearing, which hides that much of a weight hung on a standing
        output, at least 0.  Left out in motion, where viscous_Nm_s_per_rad stands for it.
    """

    inertia_kg_m2: float = 1.0
    viscous_Nm_s_per_rad: float = 0.0
    gravity_Nm: float = 0.0
    bearing_friction_Nm: float = 0.0

    def __post_init__(self) -> None:
        require_number("inertia_kg_m2", self.inertia_kg_m2, "kg m^2", above=0.0)
        require_number("viscous_Nm_s_per_rad", self.viscous_Nm_s_per_rad, "Nm s/rad", minimum=0.0)
        require_number("gravity_Nm", self.gravity_Nm, "Nm")
        require_number("bearing_friction_Nm", self.bearing_friction_Nm, "Nm", minimum=0.0)


@dataclass(frozen=True)
class Flexspline:
    """The gear's spring: torque over torsion at the output side.

    Torque = stiffness x torsion + hardening x torsion^3 + damping x torsion speed + hysteresis
    torque z, where dz/dtorsion = hysteresis_stiffness (1 - z sign(torsion speed) / hysteresis)
    (Dahl's friction in parallel with the spring).

    Parameters
    ----------
    stiffness_Nm_per_rad : float
        Stiffness of the spring, above 0.
    hardening_Nm_per_rad3 : float
        Cubic term, at least 0.
    damping_Nm_s_per_rad : float
        Material damping, at least 0.
    hysteresis_Nm : float
        Largest hysteresis torque; the loop is twice as high.  0 for none, or at least 1e-6.
    hysteresis_stiffness_Nm_per_rad : float
        Slope of the hysteresis torque just after a reversal, above 0.
    """

    stiffness_Nm_per_rad: float = 1e4
    hardening_Nm_per_rad3: float = 0.0
    damping_Nm_s_per_rad: float = 0.0
    hysteresis_Nm: float = 0.0
    hysteresis_stiffness_Nm_per_rad: float = 2e3

    def __post_init__(self) -> None:
        require_number("stiffness_Nm_per_rad", self.stiffness_Nm_per_rad, "Nm/rad", above=0.0)
        require_number("hardening_Nm_per_rad3", self.hardening_Nm_per_rad3, "Nm/rad^3", minimum=0.0)
        require_number("damping_Nm_s_per_rad", self.damping_Nm_s_per_rad, "Nm s/rad", minimum=0.0)
        require_number("hysteresis_Nm", self.hysteresis_Nm, "Nm", minimum=0.0)
        if 0.0 < self.hysteresis_Nm < SMALLEST_HYSTERESIS_NM:
            raise ConfigurationError(
                "hysteresis_Nm",
                self.hysteresis_Nm,
                "Nm",
                f"0 for none, or at least {SMALLEST_HYSTERESIS_NM:g}",
            )
        require_number(
            "hysteresis_stiffness_Nm_per_rad",
            self.hysteresis_stiffness_Nm_per_rad,
            "Nm/rad",
            above=0.0,
        )

    def elastic_torque_Nm(self, torsion_rad: float) -> float:
        """Return the torque of the spring alone, without damping and hysteresis.

        Parameters
        ----------
        torsion_rad : float
            Torsion, rad at the output side.

        Returns
        -------
        float
            Torque, Nm.
        """
        cubic = self.hardening_Nm_per_rad3 * torsion_rad * torsion_rad
        return (self.stiffness_Nm_per_rad + cubic) * torsion_rad
