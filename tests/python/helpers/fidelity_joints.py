"""Joint files, and methods under test, for the tests of fidelity."""

from __future__ import annotations

from fractions import Fraction

from strainwave.fidelity import Subject, subject_of_joint, subject_of_setting
from strainwave.joint import parse_joint
from strainwave.methods.registry import Setting

PERIOD_S = 1e-3

MADE = 'input = "by hand"\ncreated = 2026-11-01T08:30:00Z\nversion = "0.1.0"\n'

GEAR = f"""[gear]
configuration = "fixed_flexspline"
ratio = 100
rated_torque_Nm = 80
[gear.provenance]
{MADE}"""


def signals(rate_Hz: float) -> str:
    """Section with a sampling rate."""
    return f"[signals]\nsampling_rate_Hz = {rate_Hz}\n[signals.provenance]\n{MADE}"


def oscillator(process_noise: float, orders: str = "[2, 4]", period_s: float = 1e-3) -> str:
    """Section of the oscillator filter with R = 1."""
    return (
        f'[ripple_filter]\nmethod = "oscillator"\norders = {orders}\n'
        f"process_noise_variances_Nm2 = [{process_noise}]\nmeasurement_noise_variance_Nm2 = 1.0\n"
        f"initial_variance_Nm2 = 1.0\nsample_period_s = {period_s}\n"
        f"[ripple_filter.provenance]\n{MADE}"
    )


def ripple(memory_turns: float, rest: str = "") -> str:
    """Section of the ripple filter."""
    return (
        f'[ripple_filter]\nmethod = "ripple"\norders = ["2m", "4m"]\n{rest}'
        f"memory_turns = {memory_turns}\ntorque_noise_Nm = 0.08\n"
        f"torque_walk_Nm_per_sqrt_s = 2.5\ninitial_amplitude_Nm = 4.0\n"
        f"[ripple_filter.provenance]\n{MADE}"
    )


def joint_text(*sections: str) -> str:
    """Put a joint file together."""
    return "\n".join(['schema_version = 1\n[joint]\nname = "test"\n', *sections])


def of_method(name: str) -> Subject:
    """Take a method with its standard tuning."""
    return subject_of_setting(name, Setting(PERIOD_S, Fraction(100), 80.0))


def of_sections(*sections: str, method: str | None = None) -> Subject:
    """Take the method of a joint file."""
    return subject_of_joint(parse_joint(joint_text(*sections)).joint, method)
