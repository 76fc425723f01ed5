"""What a tuning does to true torque, of any filter and of any method.

A ripple filter is judged by what it leaves untouched. For a filter by itself there are
`pass_through` and `contact_step`; `assess` measures a method as `strainwave filter` runs it, with
ripple and noise present, and has a verdict.
"""

from strainwave.fidelity.any_filter import (
    PassThrough,
    RemovesRipple,
    StepResponse,
    complex_gain,
    contact_step,
    pass_through,
)
from strainwave.fidelity.assessment import Assessment, assess, assess_shortly
from strainwave.fidelity.of_joint import subject_of_joint, subject_of_setting
from strainwave.fidelity.subject import Subject
from strainwave.fidelity.verdict import (
    GAIN_ERROR_LIMIT,
    PASSES,
    SWALLOWS,
    delay_limit_s,
    worst_delay,
    worst_gain_error,
)

__all__ = [
    "GAIN_ERROR_LIMIT",
    "PASSES",
    "SWALLOWS",
    "Assessment",
    "PassThrough",
    "RemovesRipple",
    "StepResponse",
    "Subject",
    "assess",
    "assess_shortly",
    "complex_gain",
    "contact_step",
    "delay_limit_s",
    "pass_through",
    "subject_of_joint",
    "subject_of_setting",
    "worst_delay",
    "worst_gain_error",
]
