"""The session file: who calibrated, where, with which instruments, and against which limits."""

from __future__ import annotations

from datetime import date
from typing import TYPE_CHECKING, Annotated, Final, Literal

from pydantic import Field, ValidationError, model_validator

from strainwave.errors import InputError
from strainwave.joint.base import FilePart, Line, Lines, ListOf
from strainwave.joint.problems import input_error
from strainwave.joint.toml_text import decode, parse_values, read_bytes

if TYPE_CHECKING:
    from pathlib import Path

_KIND: Final = "session file"
Magnitude = Annotated[float, Field(gt=0.0)]


class Instrument(FilePart):
    """An instrument that was used, and its own certificate."""

    name: Line = Field(description="What it is: weights, lever arm, voltmeter")
    serial: Line = Field(description="Its serial number")
    certificate: Line = Field(description="Number of its own certificate")
    calibrated_until: date | None = Field(
        default=None, description="Last day on which its own certificate holds"
    )


class Environment(FilePart):
    """Surroundings during the calibration, with expanded uncertainties (95 %)."""

    temperature_degC: float = Field(ge=-273.15, le=1000.0, description="Temperature")
    temperature_uncertainty_K: float | None = Field(
        default=None, ge=0.0, description="Expanded uncertainty of the temperature"
    )
    relative_humidity_percent: float | None = Field(
        default=None, ge=0.0, le=100.0, description="Relative humidity"
    )
    relative_humidity_uncertainty_percent: float | None = Field(
        default=None, ge=0.0, le=100.0, description="Expanded uncertainty of the humidity"
    )


class Limits(FilePart):
    """Largest magnitudes that pass; a key that is left out is not judged."""

    linearity_error_percent_of_rated_torque: Magnitude | None = Field(
        default=None, description="Limit of the linearity error"
    )
    hysteresis_percent_of_rated_torque: Magnitude | None = Field(
        default=None, description="Limit of the hysteresis"
    )
    consistency: Magnitude | None = Field(
        default=None, description="Limit of the consistency measure, a fraction"
    )
    gain_relative_standard_uncertainty: Magnitude | None = Field(
        default=None, description="Limit of the gain's standard uncertainty, a fraction of the gain"
    )
    residual_fluctuation_percent_of_rated_torque: Magnitude | None = Field(
        default=None, description="Limit of the fluctuation left, root mean square"
    )
    noise_factor: Magnitude | None = Field(
        default=None, description="Limit of the gains' noise factor"
    )
    condition_number: Magnitude | None = Field(
        default=None, description="Limit of the condition number of the gains' equations"
    )
    zero_drift_percent_of_rated_torque_per_K: Magnitude | None = Field(
        default=None, description="Limit of the zero's drift with temperature"
    )
    gain_drift_per_K: Magnitude | None = Field(
        default=None, description="Limit of the gain's drift with temperature, a fraction"
    )
    largest_error_percent_of_rated_torque: Magnitude | None = Field(
        default=None, description="Limit of the largest error of any reading of the loads given"
    )


class Session(FilePart):
    """Everything about a calibration that no recording tells."""

    operator: Line = Field(description="Who calibrated")
    laboratory: Line = Field(description="Where the operator belongs")
    place: Line = Field(description="Where it was done")
    day: date = Field(alias="date", description="When it was done")
    valid_until: date | None = Field(
        default=None, description="Last day on which the certificate is to be relied on"
    )
    data: Literal["measured", "simulated"] = Field(
        description="Whether the values come from a real joint or from a simulation"
    )
    setup: Lines = Field(description="The setup: how the joint was held and loaded")
    remarks: Lines | None = Field(default=None, description="Anything else a reader should know")
    decision_rule: Literal["simple", "guarded"] = Field(
        default="simple",
        description="simple: the value is held against the limit; guarded: the value and its "
        "expanded uncertainty together",
    )
    environment: Environment = Field(description="Surroundings during the calibration")
    instruments: ListOf[Instrument] = Field(
        min_length=1, description="The instruments that were used"
    )
    limits: Limits = Field(description="What is judged, and how")

    @model_validator(mode="after")
    def _ends_after_it_began(self) -> Session:
        if self.valid_until is not None and self.valid_until < self.day:
            raise ValueError(
                f"has valid_until = {self.valid_until}, before its date = {self.day}; expected a "
                "later day, so check whether the two were swapped"
            )
        return self


def read_session(path: Path) -> Session:
    """Read a session file.

    Parameters
    ----------
    path : Path
        The file, TOML.

    Returns
    -------
    Session

    Raises
    ------
    InputError
        If it cannot be read or is not a valid session file.
    """
    source = str(path)
    values = parse_values(decode(read_bytes(path, _KIND), source, _KIND), source)
    try:
        return Session.model_validate(values)
    except ValidationError as error:
        raise InputError(
            f"{input_error(error, source, Session)}; `strainwave certify --template` writes an "
            "empty session file"
        ) from error


def session_template() -> str:
    """Return a session file to fill in, every key with its meaning beside it.

    Returns
    -------
    str
        TOML; what has to be filled in is an empty text, which is refused until it is.
    """
    limits = "\n".join(
        f"# {name} = {'':<6}# {field.description}" for name, field in Limits.model_fields.items()
    )
    return f"""\
# Session of a calibration, for `strainwave certify`: fill in what is empty, remove what is not known.
operator = ""
laboratory = ""
place = ""
# date = 2026-01-31            # day of the calibration; required
# valid_until = 2027-01-31     # last day on which the certificate is to be relied on
data = "measured"              # or "simulated"
setup = \"\"\"
\"\"\"
# remarks = \"\"\"
# \"\"\"
decision_rule = "simple"       # or "guarded": value and expanded uncertainty together within the limit

[environment]
temperature_degC = 20.0
# temperature_uncertainty_K = 0.5                # expanded, 95 %
# relative_humidity_percent = 50.0
# relative_humidity_uncertainty_percent = 5.0    # expanded, 95 %

# One for every instrument: weights, lever arm, voltmeter, thermometer.
[[instruments]]
name = ""
serial = ""
certificate = ""               # number of its own certificate
# calibrated_until = 2027-01-31

# Largest magnitudes that pass; what stays a comment is not judged.
[limits]
{limits}
"""
