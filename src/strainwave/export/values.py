"""Values as C++ initialisers, and as the bytes of which the core makes their checksum.

One tree is both: what the header says and what its checksum covers cannot differ.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

Precision = Literal["float", "double"]

_INDENT: Final = "    "


@dataclass(frozen=True)
class Real:
    """A real number; what it becomes depends on the precision."""

    value: float

    def text(self, precision: Precision) -> str:
        """Write the shortest digits that are read back as this number."""
        if precision == "double":
            return repr(float(self.value))
        return f"{np.float32(self.value)!s}F"

    def bytes_of(self, precision: Precision) -> bytes:
        """Give the number's bytes, lowest first."""
        return struct.pack("<d" if precision == "double" else "<f", self.value)


@dataclass(frozen=True)
class Whole:
    """A whole number of so many bits: ``u32``, ``i32`` or a ``count``."""

    value: int
    kind: Literal["u32", "i32", "count"]

    def text(self, _precision: Precision) -> str:
        """Write it, unsigned where it is."""
        return f"{self.value}" if self.kind == "i32" else f"{self.value}U"

    def bytes_of(self, _precision: Precision) -> bytes:
        """Give its bytes; a count has eight on every platform."""
        return struct.pack({"u32": "<I", "i32": "<i", "count": "<Q"}[self.kind], self.value)


@dataclass(frozen=True)
class Truth:
    """True or false."""

    value: bool

    def text(self, _precision: Precision) -> str:
        """Write it."""
        return "true" if self.value else "false"

    def bytes_of(self, _precision: Precision) -> bytes:
        """Give its byte."""
        return bytes([self.value])


@dataclass(frozen=True)
class Enumerator:
    """An enumerator of one byte."""

    name: str
    value: int

    def text(self, _precision: Precision) -> str:
        """Write its name."""
        return self.name

    def bytes_of(self, _precision: Precision) -> bytes:
        """Give its byte."""
        return bytes([self.value])


@dataclass(frozen=True)
class Elements:
    """An array; elements beyond those given are the type's default, written out for the checksum.

    Without a single element it is left out of the text.
    """

    items: Sequence[Node]
    rest: Sequence[Node] = ()

    def text(self, precision: Precision) -> str:
        """Write the elements, each on a line of its own where they are structures."""
        texts = [item.text(precision) for item in self.items]
        if any(isinstance(item, Fields | Elements) for item in self.items):
            return "{" + ",\n ".join(text.replace("\n", "\n ") for text in texts) + "}"
        return "{" + ", ".join(texts) + "}"

    def bytes_of(self, precision: Precision) -> bytes:
        """Give the bytes of all elements."""
        return b"".join(item.bytes_of(precision) for item in (*self.items, *self.rest))


@dataclass(frozen=True)
class Fields:
    """A structure: its members by name, in the order of declaration.

    ``is_flat`` writes it on one line. Members in ``left_out`` have the type's defaults.
    """

    members: dict[str, Node]
    is_flat: bool = False
    left_out: frozenset[str] = frozenset()

    def text(self, precision: Precision) -> str:
        """Write designated initialisers."""
        texts = [
            f".{name} = {node.text(precision)}"
            for name, node in self.members.items()
            if name not in self.left_out and not (isinstance(node, Elements) and not node.items)
        ]
        if self.is_flat:
            return "{" + ", ".join(texts) + "}"
        lines = ",\n".join(texts).replace("\n", f"\n{_INDENT}")
        return "{\n" + _INDENT + lines + "}"

    def bytes_of(self, precision: Precision) -> bytes:
        """Give the bytes of all members."""
        return b"".join(node.bytes_of(precision) for node in self.members.values())


Node = Real | Whole | Truth | Enumerator | Elements | Fields


def reals(values: Sequence[float]) -> Elements:
    """Make an array of real numbers.

    Parameters
    ----------
    values : sequence of float
        The numbers.

    Returns
    -------
    Elements
        One element for each.
    """
    return Elements([Real(float(value)) for value in values])


def checksum(nodes: Sequence[Node], precision: Precision) -> int:
    """Compute the core's checksum of values: CRC-32 of their bytes.

    Parameters
    ----------
    nodes : sequence of Node
        The values.
    precision : {"float", "double"}
        That of the real numbers.

    Returns
    -------
    int
        32 bits.
    """
    return zlib.crc32(b"".join(node.bytes_of(precision) for node in nodes))


def text_literal(text: str) -> str:
    """Write text as a string literal of C and C++ that survives any comment and character set.

    Parameters
    ----------
    text : str
        Anything.

    Returns
    -------
    str
        With quotes; what is not plain ASCII as octal escapes of UTF-8.
    """
    plain = set(range(0x20, 0x7F)) - {ord(sign) for sign in '"\\?*/'}
    pieces = [chr(byte) if byte in plain else f"\\{byte:03o}" for byte in text.encode("utf-8")]
    return '"' + "".join(pieces) + '"'
