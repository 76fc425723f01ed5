"""Copies of an image with one bit of the joint's constants turned over, as worn-out flash has it."""

import random
import re
from collections.abc import Iterator
from pathlib import Path

from listing import tool

_parts = ("gear", "config", "learned", "checksum")


class NoJointError(LookupError):
    """An image without the constants of an exported joint: nothing in it can look after them."""


def constants(image: Path) -> dict[str, range]:
    """Find the joint's constants in an image: their bytes' places in the file, by name."""
    segments = [
        [int(number, 16) for number in numbers]
        for numbers in re.findall(
            r"LOAD\s+(0x\w+) (0x\w+) 0x\w+ (0x\w+)", tool("readelf", "-lW", str(image))
        )
    ]
    found = {}
    for line in tool("nm", "-SC", str(image)).splitlines():
        symbol = re.fullmatch(r"(\w+) (\w+) \w strainwave::joints::\w+::(\w+)", line)
        if symbol and symbol[3] in _parts:
            address, size = int(symbol[1], 16), int(symbol[2], 16)
            (start,) = (
                offset + address - first
                for offset, first, length in segments
                if first <= address and address + size <= first + length
            )
            found[symbol[3]] = range(start, start + size)
    missing = set(_parts) - found.keys()
    if missing:
        raise NoJointError(f"{image.name} holds no {' and no '.join(sorted(missing))} of a joint")
    return found


def copies(image: Path, flips_each: int) -> Iterator[Path]:
    """Make copies with one bit flipped, so many for each constant, the same ones in every run.

    Bytes that are 0 are left out: some of them lie between the values and belong to none.
    """
    sound = image.read_bytes()
    board = image.stem.split("-", 1)[1]
    for part, places in constants(image).items():
        seeded = random.Random(part)  # noqa: S311 - chooses bits, keeps no secret
        values = [place for place in places if sound[place] != 0]
        for place in seeded.sample(values, min(flips_each, len(values))):
            spoilt = bytearray(sound)
            spoilt[place] ^= 1 << seeded.randrange(8)
            copy = image.with_name(f"spoilt_{part}_{place - places.start}-{board}.elf")
            copy.write_bytes(spoilt)
            yield copy
            copy.unlink()
