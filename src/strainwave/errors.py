"""The errors that strainwave raises when something a person gave it cannot be used."""

from __future__ import annotations


class StrainwaveError(Exception):
    """Base of every error that strainwave raises on purpose."""


class InputError(StrainwaveError, ValueError):
    """Something a person gave (a file, a column, a value, an option) cannot be used.

    The message is one clear sentence: what is wrong, where (file, section and key, or row and
    column), what was expected, and what to do. The command line prints it without a traceback and
    ends with exit code 2.
    """


class ConfigurationError(InputError):
    """A configuration value lies outside what is allowed.

    Parameters
    ----------
    parameter : str
        Name of the parameter.
    value : object
        The value that was given.
    unit : str
        Unit of the value, ``""`` or ``"1"`` for a dimensionless one.
    allowed : str
        What is allowed, in words that follow "expected": ``"a number greater than 0"``.
    advice : str, optional
        What to do about it.
    """

    def __init__(
        self,
        parameter: str,
        value: object,
        unit: str,
        allowed: str,
        advice: str = "correct this value",
    ) -> None:
        self.parameter = parameter
        self.value = value
        self.unit = unit
        self.allowed = allowed
        self.advice = advice
        shown_unit = "" if unit in ("", "1") else f" {unit}"
        super().__init__(f"{parameter} = {value!r}{shown_unit}: expected {allowed}; {advice}")

    def __reduce__(self) -> tuple[type[ConfigurationError], tuple[str, object, str, str, str]]:
        return (
            type(self),
            (self.parameter, self.value, self.unit, self.allowed, self.advice),
        )
