"""The equations of motion of motor, gear, spring and load, solved by Runge and Kutta's method.

    motor:   J_m w'  = torque of the current - friction - reaction of the gear
    load:    J_l v'  = transmitted torque - drag - gravity - contact torque
    spring:  torque  = K x + K3 x^3 + z + D (w/R - v),  x = motor angle/R + e(motor angle) - output

e is the transmission error of the mesh (ripple.py).  The reaction on the motor is the derivative of
the spring's energy, spring torque x (1/R + e'), so that ripple neither makes nor eats energy.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from strainwave.errors import ConfigurationError
from strainwave.simulate.commands import Command, SpeedCommand
from strainwave.simulate.mechanics import Flexspline
from strainwave.simulate.motion import Drive, Motion
from strainwave.simulate.ripple import LARGEST_GROWTH, MeshRipple
from strainwave.simulate.trajectories import FloatArray, Profile

State = tuple[float, float, float, float, float]
"""Motor angle and speed, output angle and speed, integral of the speed error."""

Inputs = tuple[float, float, float]
"""Wanted speed (or 0), current set ahead, contact torque."""

Memory = tuple[float, float]
"""Torsion and hysteresis torque at the beginning of a substep."""

MOST_SUBSTEPS = 400


def _gains(command: Command) -> tuple[float, float]:
    if isinstance(command, SpeedCommand):
        return command.proportional_A_s_per_rad, command.integral_A_per_rad
    return 0.0, 0.0


def substeps_needed(
    drive: Drive, command: Command, step_s: float, largest_contact_Nm: float = 0.0
) -> int:
    """Return how many substeps the fastest part of the mechanics takes.

    Parameters
    ----------
    drive : Drive
        Motor, gear and load.
    command : Command
        What drives it; a stiff speed controller needs small steps as well.
    step_s : float
        Step between two instants of the result, s.
    largest_contact_Nm : float
        Largest contact torque, Nm: a hardening spring is stiffer under it.

    Returns
    -------
    int
        Substeps.  ConfigurationError where more than 400 would be needed.
    """
    flexspline, motor = drive.flexspline, drive.motor
    softness = 1 / drive.load.inertia_kg_m2 + 1 / (motor.inertia_kg_m2 * drive.ratio**2)
    stiffness = flexspline.stiffness_Nm_per_rad
    # A load put on at once swings to twice its static torsion.
    largest_Nm = 2 * (largest_contact_Nm + motor.torque_limit_Nm * drive.ratio)
    cubic = flexspline.hardening_Nm_per_rad3
    if cubic > 0:
        torsion = min(largest_Nm / stiffness, math.cbrt(largest_Nm / cubic))
        stiffness += 3 * cubic * torsion**2
    if flexspline.hysteresis_Nm > 0:
        stiffness += 2 * flexspline.hysteresis_stiffness_Nm_per_rad
    slope = motor.friction.steepest_Nm_s_per_rad(largest_Nm / drive.ratio)
    gains = _gains(command)
    rates = (
        math.sqrt(stiffness * softness),
        flexspline.damping_Nm_s_per_rad * softness,
        slope / motor.inertia_kg_m2,
        drive.load.viscous_Nm_s_per_rad / drive.load.inertia_kg_m2,
        gains[0] * motor.torque_constant_Nm_per_A / motor.inertia_kg_m2,
        math.sqrt(gains[1] * motor.torque_constant_Nm_per_A / motor.inertia_kg_m2),
    )
    substeps = step_s * sum(rates) / 0.5
    if substeps > MOST_SUBSTEPS:
        raise ConfigurationError(
            "substeps",
            round(substeps),
            "",
            f"at most {MOST_SUBSTEPS} between two instants, for this stiffness, damping, friction"
            " slope and inertia",
            "raise the inertia or the sampling rate, or prescribe the rotation",
        )
    return max(math.ceil(substeps), 1)


def _ripple_function(mesh: MeshRipple) -> Callable[[float, float, float], tuple[float, float]]:
    """Ripple torque with everything held and its slope over the motor angle, for one instant."""
    lines = [
        (line.order, line.amplitude_Nm, line.phase_rad, line.load_growth, line.speed_growth)
        for line in mesh.orders
        if line.amplitude_Nm > 0
    ]
    rated, reference = mesh.rated_torque_Nm, mesh.reference_speed_rad_s

    def ripple(angle: float, speed: float, load: float) -> tuple[float, float]:
        torque = slope = 0.0
        relative_load = min(abs(load) / rated, LARGEST_GROWTH)
        relative_speed = min(abs(speed) / reference, LARGEST_GROWTH)
        for order, amplitude, phase, load_growth, speed_growth in lines:
            size = amplitude * (1 + load_growth * relative_load + speed_growth * relative_speed)
            torque += size * math.sin(order * angle + phase)
            slope += size * order * math.cos(order * angle + phase)
        return torque, slope

    return ripple


def _hysteresis_function(spring: Flexspline) -> Callable[[float, Memory], float]:
    """Hysteresis torque at a torsion, by Dahl's law in closed form from the memory on.

    The closed form stays within its limits however quick the torsion; the law as a differential
    equation of its own would need steps shorter than the time to turn the loop over.
    """
    limit = spring.hysteresis_Nm
    if limit == 0.0:
        return lambda _torsion, _memory: 0.0
    rate = spring.hysteresis_stiffness_Nm_per_rad / limit

    def hysteresis(torsion: float, memory: Memory) -> float:
        moved = torsion - memory[0]
        end = math.copysign(limit, moved)
        return end + (memory[1] - end) * math.exp(-rate * abs(moved))

    return hysteresis


def _equations(
    drive: Drive, command: Command
) -> Callable[[State, Inputs, Memory], tuple[State, float, float]]:
    """Right-hand side: derivative of the state, transmitted torque, motor torque."""
    motor, spring, load, ratio = drive.motor, drive.flexspline, drive.load, drive.ratio
    inertia, load_inertia = motor.inertia_kg_m2, load.inertia_kg_m2
    stiffness, cubic = spring.stiffness_Nm_per_rad, spring.hardening_Nm_per_rad3
    damping, hysteresis = spring.damping_Nm_s_per_rad, _hysteresis_function(spring)
    friction = motor.friction.scalar_torque_Nm
    constant, limit_A = motor.torque_constant_Nm_per_A, motor.current_limit_A
    proportional, integral = _gains(command)
    controlled = isinstance(command, SpeedCommand)
    ripple = _ripple_function(drive.mesh)

    def derivative(state: State, inputs: Inputs, memory: Memory) -> tuple[State, float, float]:
        angle, speed, output, output_speed, error_sum = state
        wanted_speed, ahead_A, contact = inputs
        torsion = angle / ratio - output
        torsion_speed = speed / ratio - output_speed
        mesh_Nm, mesh_slope = ripple(angle, speed, stiffness * torsion)
        stretched = torsion + mesh_Nm / stiffness
        elastic = (stiffness + cubic * stretched * stretched) * stretched
        torque = elastic + hysteresis(torsion, memory) + damping * torsion_speed
        reaction = torque / ratio + elastic * mesh_slope / stiffness
        error = wanted_speed - speed if controlled else 0.0
        wanted = ahead_A + proportional * error + integral * error_sum
        current = min(max(wanted, -limit_A), limit_A)
        # The integral rests while the current is at its limit, or it would wind up.
        error_rate = error if current == wanted else 0.0
        driving = constant * current
        acceleration = (driving - friction(speed, torque / ratio) - reaction) / inertia
        resistance = load.viscous_Nm_s_per_rad * output_speed + contact
        if load.gravity_Nm:
            resistance += load.gravity_Nm * math.sin(output)
        output_acceleration = (torque - resistance) / load_inertia
        rates = (speed, acceleration, output_speed, output_acceleration, error_rate)
        return rates, torque, driving

    return derivative


def _moved(state: State, rate: State, step: float) -> State:
    return (
        state[0] + step * rate[0],
        state[1] + step * rate[1],
        state[2] + step * rate[2],
        state[3] + step * rate[3],
        state[4] + step * rate[4],
    )


def _inputs(command: Command, contact_torque: Profile, time_s: FloatArray) -> list[Inputs]:
    if isinstance(command, SpeedCommand):
        speed = command.motor_speed.value(time_s)
        ahead_A = command.feedforward_A_s2_per_rad * command.motor_speed.slope(time_s)
    else:
        speed, ahead_A = np.zeros(len(time_s)), command.current.value(time_s)
    contact = contact_torque.value(time_s)
    return list(zip(speed.tolist(), ahead_A.tolist(), contact.tolist(), strict=True))


def _solve(
    drive: Drive, command: Command, contact_torque: Profile, time_s: FloatArray, start: State
) -> FloatArray:
    """Rows of an instant: the state, motor acceleration, torque, motor torque, hysteresis."""
    step_s = float(time_s[1] - time_s[0])
    contact_Nm = float(np.max(np.abs(contact_torque.value(time_s))))
    count = substeps_needed(drive, command, step_s, contact_Nm)
    h = step_s / count
    # Inputs at the beginning, middle and end of every substep, all evaluated at once.
    fine_s = time_s[0] + h / 2 * np.arange(2 * count * (len(time_s) - 1) + 1)
    inputs = _inputs(command, contact_torque, fine_s)
    derivative = _equations(drive, command)
    hysteresis = _hysteresis_function(drive.flexspline)
    rows = np.empty((len(time_s), 9))
    state, j = start, 0
    memory: Memory = (start[0] / drive.ratio - start[2], 0.0)
    for k in range(len(time_s)):
        rate, torque, driving = derivative(state, inputs[j], memory)
        rows[k] = (*state, rate[1], torque, driving, memory[1])
        if k == len(time_s) - 1:
            break
        for substep in range(count):
            if substep:
                rate = derivative(state, inputs[j], memory)[0]
            rate_2 = derivative(_moved(state, rate, h / 2), inputs[j + 1], memory)[0]
            rate_3 = derivative(_moved(state, rate_2, h / 2), inputs[j + 1], memory)[0]
            rate_4 = derivative(_moved(state, rate_3, h), inputs[j + 2], memory)[0]
            state = _moved(state, rate, h / 6)
            state = _moved(state, rate_2, h / 3)
            state = _moved(state, rate_3, h / 3)
            state = _moved(state, rate_4, h / 6)
            torsion = state[0] / drive.ratio - state[2]
            memory = (torsion, hysteresis(torsion, memory))
            j += 2
    return rows


def integrated_motion(
    drive: Drive,
    command: Command,
    contact_torque: Profile,
    time_s: FloatArray,
    start_angle_rad: float = 0.0,
    start_torsion_rad: float = 0.0,
) -> Motion:
    """Return the motion of a drive from rest.

    The torque without ripple is that of the same drive under the same command with a perfect mesh,
    integrated beside it; the difference of the two is the mesh ripple as it is transmitted.

    Parameters
    ----------
    drive : Drive
        Motor, gear and load.
    command : CurrentCommand or SpeedCommand
        What drives the motor.
    contact_torque : Profile
        Torque that the surroundings put on the output against the motor's sense, Nm.
    time_s : ndarray, shape (n,)
        Times, s, equally spaced, at least two.
    start_angle_rad : float
        Motor angle at time 0, rad.
    start_torsion_rad : float
        Torsion of the flexspline at time 0, rad at the output side.

    Returns
    -------
    Motion
        The motion.
    """
    output_rad = start_angle_rad / drive.ratio - start_torsion_rad
    start: State = (start_angle_rad, 0.0, output_rad, 0.0, 0.0)
    rows = _solve(drive, command, contact_torque, time_s, start)
    perfect = replace(drive, mesh=replace(drive.mesh, orders=()))
    smooth = _solve(perfect, command, contact_torque, time_s, start) if drive.mesh.orders else rows
    return Motion(
        time_s=time_s,
        motor_angle_rad=rows[:, 0],
        motor_speed_rad_s=rows[:, 1],
        motor_acceleration_rad_s2=rows[:, 5],
        output_angle_rad=rows[:, 2],
        output_speed_rad_s=rows[:, 3],
        motor_torque_Nm=rows[:, 7],
        torque_Nm=rows[:, 6],
        torque_without_ripple_Nm=smooth[:, 6],
        hysteresis_Nm=smooth[:, 8],
        torsion_rad=smooth[:, 0] / drive.ratio - smooth[:, 2],
    )
