"""The methods of removing ripple, by name: for `strainwave filter --method` and the benches."""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING

from strainwave.errors import ConfigurationError, InputError
from strainwave.methods.setting import Setting

if TYPE_CHECKING:
    from collections.abc import Callable

    from strainwave.methods.interface import Method

__all__ = ["DEFAULT_METHOD", "METHOD_NAMES", "Setting", "build_method"]

# Each builder imports its method when it is called: a command line that lists names, or uses one
# method, does not wait for the libraries of the others.


def _ripple(setting: Setting) -> Method:
    from strainwave.methods.ripple import Ripple  # noqa: PLC0415

    return Ripple(setting)


def _smoother(setting: Setting) -> Method:
    from strainwave.methods.smoother import Smoother  # noqa: PLC0415

    return Smoother(setting)


def _taghirad1999(setting: Setting) -> Method:
    from strainwave.methods.published import taghirad1999  # noqa: PLC0415

    return taghirad1999(setting)


def _taghirad1999_4(setting: Setting) -> Method:
    from strainwave.methods.published import taghirad1999_4  # noqa: PLC0415

    return taghirad1999_4(setting)


def _oscillator(setting: Setting) -> Method:
    from strainwave.methods.published import oscillator  # noqa: PLC0415

    return oscillator(setting)


def _low_pass(setting: Setting) -> Method:
    from strainwave.methods.low_pass import LowPass  # noqa: PLC0415

    return LowPass(setting)


def _notch(setting: Setting) -> Method:
    from strainwave.methods.notch import Notch  # noqa: PLC0415

    return Notch(setting)


_BUILDERS: dict[str, Callable[[Setting], Method]] = {
    "ripple": _ripple,
    "smoother": _smoother,
    "taghirad1999": _taghirad1999,
    "taghirad1999-4": _taghirad1999_4,
    "oscillator": _oscillator,
    "low-pass": _low_pass,
    "notch": _notch,
}

#: Names that `build_method` takes.
METHOD_NAMES: tuple[str, ...] = tuple(_BUILDERS)

#: The method where none is named.
DEFAULT_METHOD = "ripple"


def build_method(name: str, setting: Setting) -> Method:
    """Build a method by its name, in its state before the first row.

    Parameters
    ----------
    name : str
        One of `METHOD_NAMES`.
    setting : Setting
        Sample period, ratio, full scale and joint file.

    Returns
    -------
    Method
        A new one; two never share a state.

    Raises
    ------
    InputError
        If there is no method of that name, if the setting is unusable, or if the method needs what
        the setting does not have.
    """
    builder = _BUILDERS.get(name)
    if builder is None:
        close = difflib.get_close_matches(name.lower(), METHOD_NAMES, n=2, cutoff=0.5)
        advice = f"did you mean {' or '.join(close)}?" if close else "check the spelling"
        raise InputError(
            f"method = {name!r} is unknown: expected one of {', '.join(METHOD_NAMES)}; {advice}"
        )
    for parameter, value, unit in (
        ("sample_period_s", setting.sample_period_s, "s"),
        ("rated_torque_Nm", setting.rated_torque_Nm, "Nm"),
    ):
        if not (math.isfinite(value) and value > 0.0):
            raise ConfigurationError(parameter, value, unit, "a number greater than 0")
    return builder(setting)
