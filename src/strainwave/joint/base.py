"""What every part of a joint file shares: strict models, lists, units and texts."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

Item = TypeVar("Item")


@dataclass(frozen=True)
class Unit:
    """The unit of a number in the joint file, attached to its field by ``Annotated``.

    Attributes
    ----------
    symbol : str
        The unit as written in the reference: ``"Nm"``, ``"rad"``; ``"1"`` for dimensionless.
    """

    symbol: str


def _as_tuple(value: Any) -> Any:
    """Take a TOML list for a tuple, and nothing else."""
    return tuple(value) if isinstance(value, list) else value


def refuse_boolean(value: Any) -> Any:
    """Refuse true and false, which Python counts among the whole numbers."""
    if isinstance(value, bool):
        raise ValueError("expected 1 or -1, not true or false")
    return value


def _refuse_control_characters(text: str, allowed: str = "") -> str:
    for character in text:
        if character not in allowed and unicodedata.category(character) in ("Cc", "Cs"):
            raise ValueError(
                f"expected a text of printable characters, but it contains {character!r}"
            )
    return text


def _printable_lines(text: str) -> str:
    return _refuse_control_characters(text, allowed="\n\t")


ListOf = Annotated[tuple[Item, ...], BeforeValidator(_as_tuple)]
"""A list in the file, an immutable tuple in Python."""

Line = Annotated[
    str, Field(min_length=1, max_length=500), AfterValidator(_refuse_control_characters)
]
"""One line of text that is not empty."""

Lines = Annotated[str, Field(min_length=1, max_length=20_000), AfterValidator(_printable_lines)]
"""Text that may span several lines."""


class FilePart(BaseModel):
    """A table of the joint file: immutable, no unknown keys, no converted types, finite numbers."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        validate_default=True,
    )
