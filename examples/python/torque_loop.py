"""A PI torque controller with the sensor in its loop: raw torque against clean torque.

A joint presses against a spring whose far end moves, so that the motor turns while torque is held.
What is simulated: motor with inertia and friction, speed loop in the drive at 8 kHz, one spring for
gear and environment, torque controller at 1 kHz. The sensor's ripple is an artefact of the sensor:
the true torque has none, until a controller chases it. Everything is judged by the true torque.
"""

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import strainwave as sw
from strainwave.report.figure_file import write_figure
from strainwave.report.style import BLUE, GREY, ORANGE, figure_style, new_figure
from strainwave.simulate.mechanics import Friction

PERIOD_S = 1e-3
DRIVE_STEPS = 8  # of the speed loop in a period of the torque loop
RATIO = 100.0
STIFFNESS_NM_PER_RAD = 500.0  # gear and environment in series
MOTOR_INERTIA_KG_M2 = 2e-5
LARGEST_MOTOR_TORQUE_NM = 1.0
FRICTION = Friction(coulomb_Nm=0.02, viscous_Nm_s_per_rad=5e-5, stribeck_Nm=0.01, load_share=0.1)
SPEED_LOOP_HZ = 100.0
RATED_TORQUE_NM = 40.0
#: Order, amplitude in Nm, phase. The last two make order 2 change by a fifth over an output turn,
#: of which the filter is told nothing.
RIPPLE = ((2, 1.6, 0.3), (4, 0.6, 1.1), (6, 0.08, 2.0), (2.01, 0.16, 0.7), (1.99, 0.16, -0.4))
RIPPLE_GROWTH = 0.3  # at rated torque
NOISE_NM = 0.04
BANDWIDTH_HZ = 15.0
#: The integral takes over below this share of the bandwidth.
CORNER_SHARE = 0.2
DURATION_S = 40.0

Array = NDArray[np.float64]
Profile = Callable[[Array], Array]


def whole_run_speed(time_s: Array) -> Array:
    """Speed of the motor that the moving environment asks for, rad/s: rests, speeds, a reversal."""
    times = (0.0, 1, 2, 8, 9, 14, 17, 21, 28, 31, 33, 36, 37, 40)
    speeds = (0.0, 0, 30, 30, 60, 60, 150, 150, -60, -60, 10, 10, 0, 0)
    return np.interp(time_s, times, speeds)


def wanted_torque(time_s: Array) -> Array:
    """Torque that the joint shall transmit, Nm."""
    return 10.0 + 4.0 * np.sin(2 * math.pi * 0.4 * time_s)


def learning_speed(bandwidth_Hz: float) -> float:
    """Motor speed below which a filter in this loop must not learn order 2, rad/s.

    The loop answers ripple that is not removed by S = 1 / (1 + L). The filter learns what S leaves
    of it, and gets nearer to the ripple only where the real part of S is above 0: with
    L = w_c (s + z) / s^2 that is above sqrt(w_c z). A quarter is added for the speed loop's lag.
    """
    return 1.25 * 2 * math.pi * bandwidth_Hz * math.sqrt(CORNER_SHARE) / 2


def ripple_filter(
    minimum_speed_rad_s: float, learned: sw.LearnedRipple | None = None
) -> sw.RippleFilter:
    """Make the default filter for three orders; it learns above this speed."""
    config = sw.RippleFilterConfig(
        orders=[2, 4, 6],
        torque_noise_Nm=NOISE_NM,
        rated_torque_Nm=RATED_TORQUE_NM,
        minimum_speed_rad_s=minimum_speed_rad_s,
    )
    return sw.RippleFilter(config, learned=learned)


@dataclass
class Joint:
    """Motor, drive and spring; all at the motor's side but the torque."""

    angle_rad: float = 0.0
    speed_rad_s: float = 0.0
    speed_integral_Nm: float = 0.0
    torque_Nm: float = 0.0

    def advance(self, speed_command_rad_s: float, environment_rad: Array) -> None:
        """One period of the torque loop, in steps of the drive."""
        step_s = PERIOD_S / DRIVE_STEPS
        gain = MOTOR_INERTIA_KG_M2 * 2 * math.pi * SPEED_LOOP_HZ
        for there_rad in environment_rad:
            error_rad_s = speed_command_rad_s - self.speed_rad_s
            self.speed_integral_Nm += gain * 2 * math.pi * SPEED_LOOP_HZ / 5 * error_rad_s * step_s
            motor_Nm = gain * error_rad_s + self.speed_integral_Nm
            motor_Nm = min(max(motor_Nm, -LARGEST_MOTOR_TORQUE_NM), LARGEST_MOTOR_TORQUE_NM)
            load_Nm = self.torque_Nm / RATIO
            friction_Nm = FRICTION.scalar_torque_Nm(self.speed_rad_s, load_Nm)
            self.speed_rad_s += (motor_Nm - load_Nm - friction_Nm) / MOTOR_INERTIA_KG_M2 * step_s
            self.angle_rad += self.speed_rad_s * step_s
            self.torque_Nm = STIFFNESS_NM_PER_RAD * (self.angle_rad - float(there_rad)) / RATIO


def artefact(joint: Joint) -> float:
    """Return what the sensor reads besides true torque and noise, Nm."""
    growth = 1 + RIPPLE_GROWTH * abs(joint.torque_Nm) / RATED_TORQUE_NM
    return growth * sum(a * math.cos(n * joint.angle_rad - phase) for n, a, phase in RIPPLE)


@dataclass(frozen=True)
class Run:
    """True torque and what was wanted, every period."""

    time_s: Array
    wanted_Nm: Array
    true_Nm: Array
    sensed_Nm: Array
    used_Nm: Array

    def error_rms(self, start_s: float = 0.0, end_s: float = math.inf) -> float:
        """Root mean square of true minus wanted torque, Nm."""
        rows = (self.time_s >= start_s) & (self.time_s < end_s)
        return float(np.sqrt(np.mean((self.true_Nm - self.wanted_Nm)[rows] ** 2)))


def run_loop(
    speed: Profile,
    duration_s: float,
    bandwidth_Hz: float = BANDWIDTH_HZ,
    clean: sw.RippleFilter | None = None,
    *,
    with_ripple: bool = True,
    seed: int = 1,
) -> Run:
    """Close the loop sample by sample: sensor, filter or none, PI, drive."""
    count = round(duration_s / PERIOD_S)
    time_s: Array = np.arange(count, dtype=np.float64) * PERIOD_S
    wanted_Nm = wanted_torque(time_s)
    fine_s = np.arange(1, count * DRIVE_STEPS + 1) * PERIOD_S / DRIVE_STEPS
    environment_rad = np.cumsum(speed(fine_s)) * PERIOD_S / DRIVE_STEPS
    noise_Nm = np.random.default_rng(seed).normal(0.0, NOISE_NM, count)
    # The spring makes an integrator of the motor's speed: a gain of w_c R / K crosses over at w_c.
    gain = 2 * math.pi * bandwidth_Hz * RATIO / STIFFNESS_NM_PER_RAD
    integral_rad_s = 0.0
    joint = Joint(angle_rad=float(wanted_Nm[0]) * RATIO / STIFFNESS_NM_PER_RAD)
    joint.torque_Nm = float(wanted_Nm[0])
    true_Nm, sensed_Nm, used_Nm = np.empty(count), np.empty(count), np.empty(count)
    command_rad_s = 0.0
    for k in range(count):
        true_Nm[k] = joint.torque_Nm
        sensed_Nm[k] = joint.torque_Nm + noise_Nm[k] + (artefact(joint) if with_ripple else 0.0)
        used_Nm[k] = sensed_Nm[k]
        if clean is not None:
            used_Nm[k] = clean.step(time_s[k], joint.angle_rad, sensed_Nm[k])
        # The command takes effect a period after the sample: computing takes its time.
        joint.advance(command_rad_s, environment_rad[k * DRIVE_STEPS : (k + 1) * DRIVE_STEPS])
        error_Nm = wanted_Nm[k] - used_Nm[k]
        integral_rad_s += 2 * math.pi * bandwidth_Hz * CORNER_SHARE * gain * error_Nm * PERIOD_S
        command_rad_s = gain * error_Nm + integral_rad_s
    return Run(time_s, wanted_Nm, true_Nm, sensed_Nm, used_Nm)


def predicted_raw_error(speed_rad_s: float, bandwidth_Hz: float) -> float:
    """Send the ripple through the closed loop of raw torque, Nm rms.

    L = w_c (s + z) / s^2 with a period and a half of dead time and the drive's speed loop,
    (w_d s + w_d^2 / 5) / (s^2 + w_d s + w_d^2 / 5).
    """
    crossover_rad_s = 2 * math.pi * bandwidth_Hz
    drive_rad_s = 2 * math.pi * SPEED_LOOP_HZ
    growth = 1 + RIPPLE_GROWTH * 10.0 / RATED_TORQUE_NM
    power_Nm2 = 0.0
    for order, amplitude_Nm, _ in RIPPLE:
        s = 1j * order * speed_rad_s
        loop = crossover_rad_s * (s + CORNER_SHARE * crossover_rad_s) / s**2
        of_drive = drive_rad_s * s + drive_rad_s**2 / 5
        loop *= np.exp(-1.5 * PERIOD_S * s) * of_drive / (s**2 + of_drive)
        power_Nm2 += (growth * amplitude_Nm * abs(loop / (1 + loop))) ** 2 / 2
    return math.sqrt(power_Nm2)


def predicted_over(speed: Profile, duration_s: float, bandwidth_Hz: float) -> float:
    """Do the same over a motion, as if every speed were held, Nm rms."""
    speeds = np.abs(speed(np.arange(0.0, duration_s, 0.05)))
    each = [predicted_raw_error(max(float(v), 1e-3), bandwidth_Hz) for v in speeds]
    return math.sqrt(float(np.mean(np.square(each))))


def commissioned() -> sw.LearnedRipple:
    """Coefficients to keep: learned in a loop of 1 Hz, which hardly answers the ripple."""

    def speed(time_s: Array) -> Array:
        return np.interp(time_s, (0.0, 1.0), (0.0, 60.0))

    learner = ripple_filter(learning_speed(1.0))
    run_loop(speed, 6.0, 1.0, learner, seed=2)
    return learner.learned()


def steady_errors(
    speed_rad_s: float, bandwidth_Hz: float, kept: sw.LearnedRipple
) -> tuple[float, float, float]:
    """RMS errors with raw and clean torque and without ripple at one speed, Nm, from 4 to 9 s."""

    def speed(time_s: Array) -> Array:
        return np.interp(time_s, (0.0, 2.0), (0.0, speed_rad_s))

    clean = ripple_filter(learning_speed(bandwidth_Hz), kept)
    runs = (
        run_loop(speed, 9.0, bandwidth_Hz),
        run_loop(speed, 9.0, bandwidth_Hz, clean),
        run_loop(speed, 9.0, bandwidth_Hz, with_ripple=False),
    )
    raw, filtered, ideal = (run.error_rms(4.0) for run in runs)
    return raw, filtered, ideal


def slow_errors(kept: sw.LearnedRipple) -> tuple[float, float, float]:
    """Return errors at 8 rad/s, of 10 to 20 s: raw, learning from nothing, kept and frozen, Nm."""

    def speed(time_s: Array) -> Array:
        return np.interp(time_s, (0.0, 1.0), (0.0, 8.0))

    filters = (None, ripple_filter(2.0), ripple_filter(learning_speed(BANDWIDTH_HZ), kept))
    raw, learning, frozen = (run_loop(speed, 20.0, clean=each).error_rms(10.0) for each in filters)
    return raw, learning, frozen


def draw(raw: Run, clean: Run, path: Path) -> None:
    """Draw both runs' true torque and errors."""
    with figure_style():
        figure = new_figure(5.4)
        upper, middle, lower = figure.subplots(3, 1, height_ratios=(1.2, 1.2, 0.7))
        part = (raw.time_s >= 11.0) & (raw.time_s < 12.5)
        upper.plot(
            raw.time_s[part], raw.true_Nm[part], color=ORANGE, label="raw torque in the loop"
        )
        upper.plot(raw.time_s[part], clean.true_Nm[part], color=BLUE, label="clean torque")
        upper.plot(raw.time_s[part], raw.wanted_Nm[part], "--", color=GREY, label="wanted")
        upper.set(title="True torque, motor at 60 rad/s", ylabel="Nm", ylim=(2, 14))
        upper.legend(loc="lower left", ncols=3)
        for run, colour in ((raw, ORANGE), (clean, BLUE)):
            error_Nm = (run.true_Nm - run.wanted_Nm)[::4]
            middle.plot(run.time_s[::4], error_Nm, color=colour, linewidth=0.5)
        middle.set(
            title=f"Tracking error: {raw.error_rms():.2f} Nm rms raw, "
            f"{clean.error_rms():.2f} Nm rms clean",
            ylabel="Nm",
        )
        lower.plot(raw.time_s[::50], whole_run_speed(raw.time_s[::50]), color=GREY)
        lower.set(title="Motor speed, made by the environment", ylabel="rad/s", xlabel="s")
        write_figure(figure, path)


def print_table(kept: sw.LearnedRipple) -> None:
    """Print where clean torque pays, and where it does not."""
    print("bandwidth, Hz | motor, rad/s | raw predicted | raw | clean | no ripple | clean / raw")
    for bandwidth_Hz in (1.0, 5.0, 15.0, 25.0):
        for speed_rad_s in (10.0, 30.0, 60.0, 150.0):
            raw, clean, ideal = steady_errors(speed_rad_s, bandwidth_Hz, kept)
            predicted = predicted_raw_error(speed_rad_s, bandwidth_Hz)
            print(
                f"{bandwidth_Hz:g} | {speed_rad_s:g} | {predicted:.3f} | {raw:.3f} | {clean:.3f} | "
                f"{ideal:.3f} | {clean / raw:.2f}"
            )
    raw, learning, frozen = slow_errors(kept)
    print(f"at 8 rad/s: raw {raw:.3f}, learning {learning:.3f}, kept {frozen:.3f}")


def main() -> None:
    """Run the loops and print their errors; with --table speeds and bandwidths, too."""
    parser = argparse.ArgumentParser(description="PI torque control with raw and clean torque")
    parser.add_argument("--figure", type=Path, help="SVG to write")
    parser.add_argument("--table", action="store_true", help="speeds and bandwidths, half a minute")
    options = parser.parse_args()
    kept = commissioned()
    above_rad_s = learning_speed(BANDWIDTH_HZ)
    raw = run_loop(whole_run_speed, DURATION_S)
    clean = run_loop(whole_run_speed, DURATION_S, clean=ripple_filter(above_rad_s, kept))
    fresh = run_loop(whole_run_speed, DURATION_S, clean=ripple_filter(above_rad_s))
    ideal = run_loop(whole_run_speed, DURATION_S, with_ripple=False)
    predicted_Nm = predicted_over(whole_run_speed, DURATION_S, BANDWIDTH_HZ)
    print("rms error of the true torque, Nm")
    print(f"raw, predicted:         {predicted_Nm:.3f}")
    print(f"raw:                    {raw.error_rms():.3f}")
    print(f"clean:                  {clean.error_rms():.3f}")
    print(f"clean, nothing learned: {fresh.error_rms():.3f}")
    print(f"sensor without ripple:  {ideal.error_rms():.3f}")
    print(f"clean / raw: {clean.error_rms() / raw.error_rms():.2f}")
    if options.table:
        print_table(kept)
    if options.figure is not None:
        draw(raw, clean, options.figure)


if __name__ == "__main__":
    main()
