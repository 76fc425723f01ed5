"""From the bytes of a file to a TOML document, or to one clear sentence."""

from __future__ import annotations

import re
import stat
import tomllib
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError

from strainwave.errors import InputError

LARGEST_FILE_BYTES: Final = 4_000_000
_POSITION = re.compile(
    r"^(?P<what>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end .*)\)$"
)
_TWICE = ("Cannot overwrite a value", "Cannot declare", "Duplicate inline table key")


def read_bytes(path: Path, kind: str = "joint file") -> bytes:
    """Return the content of a joint file, or of another small file, which `kind` names.

    Raises
    ------
    InputError
        If there is no such file, if it is none (a directory, a device), if it cannot be read or
        is far too large.
    """
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise InputError(
                f"{path}: it is a directory; expected a {kind}, so name the file inside it"
            )
        if not stat.S_ISREG(status.st_mode):
            raise InputError(
                f"{path}: it is not a regular file but a device or pipe; expected a {kind}, so "
                "save the content in a file first"
            )
        if status.st_size > LARGEST_FILE_BYTES:
            raise InputError(
                f"{path}: it has {status.st_size} bytes; expected a {kind}, of at most "
                f"{LARGEST_FILE_BYTES}, so check whether a recording was given in its place"
            )
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(
            f"{path}: there is no such file; expected a {kind}, so check the name or create it"
        ) from error
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise InputError(
            f"{path}: it cannot be read ({reason}); expected a readable {kind}, so check its "
            "permissions and the path"
        ) from error


def decode(content: bytes, source: str, kind: str = "joint file") -> str:
    r"""Return the text of a joint file or the like, with ``\n`` as line end and no byte order mark.

    Raises
    ------
    InputError
        If it is empty or not UTF-8 text.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{source}, line {line}: it is not UTF-8 text (byte 0x{content[error.start]:02x} at "
            f"position {error.start}); expected a {kind} in TOML, so check whether another "
            "file was given or save it as UTF-8"
        ) from error
    text = text.replace("\r\n", "\n")
    if not text.strip():
        parts = "schema_version and a section [joint]" if kind == "joint file" else "its keys"
        raise InputError(
            f"{source}: it is empty; expected a {kind} with {parts}, so create it anew or take a "
            "copy"
        )
    return text


def _invalid(text: str, source: str, error: Exception) -> InputError:
    match = _POSITION.match(str(error))
    what = match["what"] if match else str(error)
    lines = text.split("\n")
    line, column = len(lines), len(lines[-1]) + 1
    if match and match["line"]:
        line, column = int(match["line"]), int(match["column"])
    where = f"{source}, line {line}, column {column}"
    content = lines[line - 1].strip()[:60]
    seen = f", in: {content}" if content else ""
    if what.startswith(_TWICE):
        return InputError(
            f"{where}: a key or section is given twice, the second time in this line ({content}); "
            "expected each once, so remove one of the two"
        )
    return InputError(
        f"{where}: it is not valid TOML ({what[:1].lower()}{what[1:]}{seen}); expected "
        "[section] or key = value, so correct this line"
    )


def parse_values(text: str, source: str) -> dict[str, Any]:
    """Return the values of a TOML text as plain Python objects.

    Raises
    ------
    InputError
        If it is not valid TOML, with line and column.
    """
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise InputError(
            f"{source}: its lists or tables are nested too deeply; expected a joint file, whose "
            "tables are at most four deep, so check whether another file was given"
        ) from error
    except ValueError as error:
        raise _invalid(text, source, error) from error


def parse_document(text: str, source: str) -> tomlkit.TOMLDocument:
    """Return a TOML text as a document that keeps comments and layout.

    Raises
    ------
    InputError
        If it is not valid TOML.
    """
    parse_values(text, source)
    try:
        return tomlkit.parse(text)
    except (TOMLKitError, ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: it is TOML that cannot be edited in place ({error}); expected the plain "
            "layout of sections with key = value lines, so rewrite that place"
        ) from error
