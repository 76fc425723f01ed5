"""A joint file in memory: the document with its comments, and the joint it describes."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any

import tomlkit
from pydantic import ValidationError

from strainwave.errors import InputError
from strainwave.joint import editing
from strainwave.joint.canonical import canonical_hash
from strainwave.joint.history import HistoryEntry, history_entry
from strainwave.joint.migrations import VERSION_KEY
from strainwave.joint.model import SECTION_MODELS, SECTION_NAMES, Joint
from strainwave.joint.problems import input_error
from strainwave.joint.provenance import Provenance, Section
from strainwave.joint.toml_text import parse_values


def section_models(name: str, source: str) -> tuple[type[Section], ...]:
    """Return the models of a section, by its name: one, or one for each method.

    Raises
    ------
    InputError
        If there is no section of that name that can be filled.
    """
    if name not in SECTION_MODELS:
        close = difflib.get_close_matches(name, SECTION_NAMES, n=1)
        hint = f' (did you mean "{close[0]}"?)' if close else ""
        raise InputError(
            f"{source}: [{name}] is not a section that can be filled{hint}; expected one of "
            f"{', '.join(SECTION_NAMES)}"
        )
    return SECTION_MODELS[name]


def joint_of_text(text: str, source: str) -> Joint:
    """Return the joint that a text of the present schema version describes.

    Raises
    ------
    InputError
        If it describes none.
    """
    values = parse_values(text, source)
    values.pop(VERSION_KEY, None)
    try:
        return Joint.model_validate(values)
    except ValidationError as error:
        raise input_error(error, source, Joint) from error


class JointFile:
    """A joint file: its text with comments and layout, and the joint it describes.

    Get one from `read_joint`, `parse_joint` or `new_joint`.

    Attributes
    ----------
    migrated_from : int or None
        The older schema version that was read, None where the file had the present one.
    line_end : str
        What ends a line in the file, kept when it is written again.
    content_sha256 : str or None
        SHA-256 of the bytes last read or written, None before; tells whether somebody else has
        changed the file since.
    """

    def __init__(
        self,
        document: tomlkit.TOMLDocument,
        source: str,
        *,
        migrated_from: int | None = None,
    ) -> None:
        self._document = document
        self._source = source
        self._joint = joint_of_text(document.as_string(), source)
        self.migrated_from = migrated_from
        self.line_end = "\n"
        self.content_sha256: str | None = None

    @property
    def joint(self) -> Joint:
        """What the file says."""
        return self._joint

    @property
    def document(self) -> tomlkit.TOMLDocument:
        """A copy of the TOML document, with its comments and layout."""
        return tomlkit.parse(self.text())

    def text(self) -> str:
        r"""Return the text of the file, with ``\n`` at the end of lines."""
        return self._document.as_string()

    def set_section(self, name: str, model: Section, provenance: Provenance) -> None:
        """Fill a section, or replace the one that is there.

        Comments and layout stay, but for those of values that disappear. Every value is written
        out, defaults too. A replaced section leaves an entry in ``[[history]]``. Where the result
        would not be a valid joint, nothing changes.

        Parameters
        ----------
        name : str
            Name of the section, one of `SECTION_NAMES`.
        model : Section
            Its values: a `Gear` for ``"gear"`` and so on; for ``"ripple_filter"`` an
            `OscillatorFilter` or a `RippleFilter`. A provenance it has is replaced.
        provenance : Provenance
            Where the values come from.

        Raises
        ------
        InputError
            If there is no section of that name, or the joint would contradict itself.
        TypeError
            If `model` is not of one of the section's models.
        """
        expected = section_models(name, self._source)
        if not isinstance(model, expected):
            names = " or ".join(each.__name__ for each in expected)
            raise TypeError(f"section [{name}]: expected {names}, got {type(model).__name__}")
        section = model.model_copy(update={"provenance": provenance})
        before = self._provenance_of(name)
        if getattr(self._joint, name) == section:
            return
        entry = None
        if before is not None:
            entry = history_entry(name, "replaced", before, provenance, canonical_hash(self._joint))
        self._change(name, _plain_values(section), entry)

    def remove_section(self, name: str, provenance: Provenance | None = None) -> None:
        """Take a section out, with its comments; no change where it is not there.

        Parameters
        ----------
        name : str
            Name of the section, one of `SECTION_NAMES`.
        provenance : Provenance, optional
            What the removal comes from, for the entry in ``[[history]]``; by hand without.

        Raises
        ------
        InputError
            If there is no section of that name, or another section needs it.
        """
        section_models(name, self._source)
        before = self._provenance_of(name)
        if before is None:
            return
        by = Provenance.by_hand() if provenance is None else provenance
        entry = history_entry(name, "removed", before, by, canonical_hash(self._joint))
        self._change(name, None, entry)

    def _provenance_of(self, name: str) -> Provenance | None:
        section: Section | None = getattr(self._joint, name)
        return None if section is None else section.provenance

    def _change(self, name: str, values: dict[str, Any] | None, entry: HistoryEntry | None) -> None:
        wanted = self._joint.model_dump(by_alias=True, exclude_none=True)
        wanted.pop(name, None)
        if values is not None:
            wanted[name] = values
        change = None if entry is None else entry.model_dump(exclude_none=True)
        if change is not None:
            wanted["history"] = [*wanted.get("history", ()), change]
        try:
            joint = Joint.model_validate(wanted)
        except ValidationError as error:
            raise input_error(error, self._source, Joint) from error
        for edit in (editing.set_in_place, editing.set_anew):
            document = self.document
            try:
                edit(document, name, values)
                if change is not None:
                    editing.append_entry(document, "history", change)
            except Exception:  # noqa: BLE001, S112 - see below
                # Rare layouts (dotted keys, parts of a section apart) make the TOML library fail in
                # many ways, or change the wrong place. Only what is read back right is kept.
                continue
            if _says(document, joint):
                self._document, self._joint = document, joint
                return
        raise InputError(
            f"{self._source}: [{name}] cannot be edited in the layout this file has; expected "
            f"one section [{name}] with key = value lines, so rewrite that section by hand"
        )


def _says(document: tomlkit.TOMLDocument, joint: Joint) -> bool:
    """Tell whether the text of a document describes this joint."""
    try:
        return joint_of_text(document.as_string(), "") == joint
    except InputError:
        return False


def _plain_values(section: Section) -> dict[str, Any]:
    """Return the values of a section with lists for tuples, and its provenance last."""

    def plain(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: plain(item) for key, item in value.items()}
        return [plain(item) for item in value] if isinstance(value, tuple) else value

    values: dict[str, Any] = plain(section.model_dump(by_alias=True, exclude_none=True))
    values["provenance"] = values.pop("provenance")
    return values
