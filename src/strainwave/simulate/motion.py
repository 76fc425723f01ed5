"""Motion of a station: what happens between the motor's current and the load.

Two ways: `integrated_motion` solves the equations of motion of motor - gear - spring - load;
`prescribed_motion` takes the motor's rotation as given and the load as following it rigidly, which
is quick for runs of minutes and is also the standing, locked station.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strainwave.simulate.mechanics import Flexspline, Load, Motor
from strainwave.simulate.ripple import MeshRipple
from strainwave.simulate.statics import held_back_by_friction, torsion_under
from strainwave.simulate.trajectories import FloatArray, Profile


@dataclass(frozen=True)
class Drive:
    """A motor, a gear as ratio and spring, and a load.

    Everything is reckoned in the motor's sense of rotation: a positive torque drives the load the
    way a positive motor torque does.  The output's direction is the gear's and is applied by the
    station, at the output encoder.

    Parameters
    ----------
    motor : Motor
        The motor with its friction.
    ratio : float
        Motor turns per output turn, a magnitude.
    flexspline : Flexspline
        The gear's spring.
    load : Load
        The load.
    mesh : MeshRipple
        The real ripple of the mesh.
    """

    motor: Motor
    ratio: float
    flexspline: Flexspline
    load: Load
    mesh: MeshRipple


@dataclass(frozen=True)
class Motion:
    """What the mechanics did; every array has the shape (n,).

    Parameters
    ----------
    time_s : ndarray
        Time, s, equally spaced.
    motor_angle_rad, motor_speed_rad_s, motor_acceleration_rad_s2 : ndarray
        Motor.
    output_angle_rad, output_speed_rad_s : ndarray
        Output, in the motor's sense of rotation.
    motor_torque_Nm : ndarray
        Torque of the motor's current.
    torque_Nm : ndarray
        Transmitted torque at the output side, mesh ripple included.
    torque_without_ripple_Nm : ndarray
        The same without mesh ripple: all of it, hysteresis torque included.
    hysteresis_Nm : ndarray
        Hysteresis torque of the flexspline, a part of torque_without_ripple_Nm.
    torsion_rad : ndarray
        Torsion of the flexspline at the output side, without ripple.
    """

    time_s: FloatArray
    motor_angle_rad: FloatArray
    motor_speed_rad_s: FloatArray
    motor_acceleration_rad_s2: FloatArray
    output_angle_rad: FloatArray
    output_speed_rad_s: FloatArray
    motor_torque_Nm: FloatArray
    torque_Nm: FloatArray
    torque_without_ripple_Nm: FloatArray
    hysteresis_Nm: FloatArray
    torsion_rad: FloatArray


def prescribed_motion(
    drive: Drive,
    motor_speed: Profile,
    contact_torque: Profile,
    time_s: FloatArray,
    start_angle_rad: float = 0.0,
    *,
    locked: bool = False,
) -> Motion:
    """Return the torques that a given rotation needs: inverse dynamics with a rigid load.

    Parameters
    ----------
    drive : Drive
        Motor, gear and load.
    motor_speed : Profile
        Motor speed, rad/s.
    contact_torque : Profile
        Torque that the surroundings put on the output against the motor's sense, Nm.
    time_s : ndarray, shape (n,)
        Times, s, equally spaced.
    start_angle_rad : float
        Motor angle at time 0, rad.
    locked : bool
        Whether the wave generator is clamped: the output bearing's dry friction then hides part of
        the contact torque, and the motor carries nothing.

    Returns
    -------
    Motion
        The motion.
    """
    load = drive.load
    angle = start_angle_rad + motor_speed.integral(time_s)
    speed = motor_speed.value(time_s)
    acceleration = motor_speed.slope(time_s)
    contact = contact_torque.value(time_s)
    if locked:
        contact = held_back_by_friction(contact, load.bearing_friction_Nm)
    smooth = (
        load.inertia_kg_m2 * acceleration / drive.ratio
        + load.viscous_Nm_s_per_rad * speed / drive.ratio
        + load.gravity_Nm * np.sin(angle / drive.ratio)
        + contact
    )
    torsion, hysteresis = torsion_under(smooth, drive.flexspline)
    # A standing mesh does not ripple: what its teeth do with the load is in the static torque.
    ripple = 0.0 * smooth if locked else drive.mesh.torque_Nm(angle, speed, smooth)
    torque = smooth + ripple
    motor = drive.motor
    at_motor = torque / drive.ratio
    motor_torque = (
        motor.inertia_kg_m2 * acceleration + motor.friction.torque_Nm(speed, at_motor) + at_motor
    )
    return Motion(
        time_s=time_s,
        motor_angle_rad=angle,
        motor_speed_rad_s=speed,
        motor_acceleration_rad_s2=acceleration,
        output_angle_rad=angle / drive.ratio - torsion,
        output_speed_rad_s=speed / drive.ratio,
        motor_torque_Nm=0.0 * motor_torque if locked else motor_torque,
        torque_Nm=torque,
        torque_without_ripple_Nm=smooth,
        hysteresis_Nm=hysteresis,
        torsion_rad=torsion,
    )
