"""A sentence while filtering, where the method that is used swallows true torque."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from strainwave.errors import InputError
from strainwave.fidelity.assessment import assess_shortly
from strainwave.fidelity.of_joint import subject_of_setting
from strainwave.methods.registry import DEFAULT_METHOD

if TYPE_CHECKING:
    from strainwave.methods.interface import Method
    from strainwave.methods.registry import Setting

#: Faster recordings are measured as if they had this sample period: the measurement is to cost less
#: than a second, and what is judged is slow. The joint file's oscillator filter is tuned for one
#: period and measured at that.
SHORTEST_PERIOD_S: Final = 2e-4


def fidelity_warnings(name: str, setting: Setting, method: Method) -> tuple[str, ...]:
    """Measure shortly what a method does to true torque, and say it where that is bad.

    Parameters
    ----------
    name : str
        Name of the method.
    setting : Setting
        What it was built from for the recording.
    method : Method
        The method itself: what it has chosen on the recording is measured; its state is not
        touched.

    Returns
    -------
    tuple of str
        One sentence, or none: where the method passes true torque, and where the recording is too
        slow to tell.
    """
    period_s = setting.sample_period_s
    if name != "oscillator":
        period_s = max(period_s, SHORTEST_PERIOD_S)
    chosen = getattr(method, "settings", None)
    try:
        subject = subject_of_setting(
            name, replace(setting, sample_period_s=period_s, ripple_settings=chosen)
        )
        assessment = assess_shortly(subject)
    except InputError:
        return ()
    if not assessment.reasons:
        return ()
    other = "" if name == DEFAULT_METHOD else f", or use method {DEFAULT_METHOD}"
    return (
        f"method {name} {assessment.verdict}: {assessment.reasons[0]}; see "
        f"`strainwave fidelity`{other}",
    )
