"""Every number of a joint file as a row of its certificate, read by the models' own descriptions."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from pydantic import BaseModel

from strainwave.joint import SECTION_NAMES, Section
from strainwave.joint.fields import key_of, unit_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pydantic.fields import FieldInfo

    from strainwave.joint import Joint

Number = int | float
#: Which key holds the standard uncertainty of another one.
_UNCERTAINTY_OF: Final = {
    "gear.ratio": "gear.ratio_standard_uncertainty",
    "torque_calibration.gain_Nm_per_V": "torque_calibration.gain_standard_uncertainty_Nm_per_V",
    "ripple_filter.learned_coefficients_Nm": "ripple_filter.learned_standard_deviations_Nm",
}
#: How a recording is read is no result.
_NOT_RESULTS: Final = ("signals",)


@dataclass(frozen=True)
class Result:
    """A number, or a list of numbers, of the joint file.

    Attributes
    ----------
    key : str
        Where it stands: ``"gains.without_gauge[2].noise_factor"``, positions counted from 1.
    label : str
        What it is.
    values : tuple of int or float
        One, or those of a list.
    unit : str
        Its unit, ``"1"`` where it is dimensionless.
    standard_uncertainties : tuple of float
        Of each value; empty where they are not known.
    """

    key: str
    label: str
    values: tuple[Number, ...]
    unit: str
    standard_uncertainties: tuple[float, ...] = ()

    @property
    def section(self) -> str:
        """Name of the section it stands in."""
        return self.key.partition(".")[0]


def results_of(joint: Joint) -> tuple[Result, ...]:
    """Collect every number with a unit that a joint file holds, section by section.

    Parameters
    ----------
    joint : Joint
        The joint.

    Returns
    -------
    tuple of Result
        In the order of the file.
    """
    found = [
        result
        for name in SECTION_NAMES
        if name not in _NOT_RESULTS and isinstance(section := getattr(joint, name), Section)
        for result in _results(section, name)
    ]
    by_key = {result.key: result for result in found}
    return tuple(_with_uncertainty(result, by_key) for result in found)


def _results(model: BaseModel, prefix: str) -> Iterator[Result]:
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        key = f"{prefix}.{key_of(name, field)}"
        items = value if isinstance(value, tuple) else (value,)
        if name == "provenance" or value is None or not items:
            continue
        if isinstance(items[0], BaseModel):
            for position, item in enumerate(items, start=1):
                yield from _results(item, f"{key}[{position}]")
            continue
        unit = unit_of(field)
        if unit is not None and all(isinstance(item, int | float) for item in items):
            yield Result(key, _label(field), items, unit)


def _label(field: FieldInfo) -> str:
    return re.split(r"[;:]", field.description or "")[0].strip()


def _with_uncertainty(result: Result, by_key: dict[str, Result]) -> Result:
    other = by_key.get(_UNCERTAINTY_OF.get(result.key, ""))
    if other is None:
        return result
    spread = tuple(float(value) for value in other.values)
    return Result(result.key, result.label, result.values, result.unit, spread)
