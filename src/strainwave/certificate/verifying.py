"""Whether a joint file is the one that a certificate was issued for."""

from __future__ import annotations

from datetime import date
from typing import TYPE_CHECKING, Any

from strainwave.certificate.sealing import read_block
from strainwave.errors import InputError
from strainwave.joint import SECTION_NAMES, Joint, canonical_hash, read_joint, section_hash

if TYPE_CHECKING:
    from pathlib import Path


def verify_certificate(joint_path: Path, certificate: Path, *, on: date) -> dict[str, Any]:
    """Hold a joint file against its certificate.

    Parameters
    ----------
    joint_path : Path
        The joint file.
    certificate : Path
        The HTML that `strainwave certify` wrote.
    on : date
        The day that a stated validity is held against.

    Returns
    -------
    dict
        What the certificate says: its block.

    Raises
    ------
    InputError
        If the certificate was changed, is for another joint or not for these values, or is past its
        stated validity.
    """
    block = read_block(certificate)
    joint = read_joint(joint_path).joint
    certified = block["joint"]
    if joint.identity.serial != certified["serial"]:
        raise InputError(
            f"{joint_path}: it has the serial number {joint.identity.serial or 'none'}, but "
            f"{certificate} is for {certified['serial']}; expected the certificate of this joint, so "
            "take that one"
        )
    digest = canonical_hash(joint)
    if digest != certified["sha256"]:
        raise InputError(
            f"{joint_path}: its hash is {digest[:16]}..., but {certificate} was issued on "
            f"{block['issued_at']} for {certified['sha256'][:16]}...: {_difference(joint, certified)}; "
            "expected the joint file that was certified, so take that one, or certify this one anew"
        )
    until = block["session"].get("valid_until")
    if until is not None and date.fromisoformat(until) < on:
        raise InputError(
            f"{certificate}: it was valid until {until}, and the day is {on}; expected a "
            "certificate that holds, so calibrate and certify anew"
        )
    return block


def _difference(joint: Joint, certified: dict[str, Any]) -> str:
    """Say which sections differ from the certified ones, and what the history tells of it."""
    before = certified["sections"]
    now = {name: section_hash(joint, name) for name in SECTION_NAMES if getattr(joint, name)}
    words = [
        f"[{name}] was {change}"
        for change, names in (
            (
                "changed",
                [name for name in now if name in before and now[name] != _hash(before, name)],
            ),
            ("added", [name for name in now if name not in before]),
            ("removed", [name for name in before if name not in now]),
        )
        for name in names
    ]
    if (joint.identity.name, joint.identity.notes) != (certified["name"], certified.get("notes")):
        words.append("[joint] was changed")
    entries = joint.history or ()
    fresh = entries[len(certified["history"]) :]
    told = [
        f"[{entry.section}] {entry.change} at {entry.changed_at:%Y-%m-%d %H:%M} UTC from {entry.input}"
        for entry in fresh
    ]
    if not words and not told:
        words.append("[[history]] was changed")
    history = (
        f"; its history says {', '.join(told)}" if told else "; its history says nothing of it"
    )
    return ", ".join(words or ["values are the same, history is not"]) + history


def _hash(sections: dict[str, Any], name: str) -> str:
    return str(sections[name]["sha256"])
