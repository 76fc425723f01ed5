"""Writes a file whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator


def write_atomically(path: Path, content: bytes) -> None:
    """Replace the content of a file in one step.

    The content goes to a temporary file in the same folder, reaches the disk, and takes the place
    of the old file. Where anything fails, the old file stays as it was and no temporary file is
    left. Permissions of an existing file are kept; a symbolic link stays one and its target is
    replaced.

    Parameters
    ----------
    path : Path
        The file; it need not exist, its folder must.
    content : bytes
        The new content.

    Raises
    ------
    InputError
        If the file cannot be written there.
    """
    with replaced_atomically(path) as stream:
        stream.write(content)


@contextlib.contextmanager
def replaced_atomically(path: Path) -> Iterator[BinaryIO]:
    """Write a file piece by piece; it takes the place of the old one at the end of the block.

    As `write_atomically`, for content that does not fit into memory. Where the block ends with an
    exception, an interruption included, the old file stays as it was and no temporary file is left.
    A process that is killed leaves at most a temporary file whose name begins with a dot.

    Parameters
    ----------
    path : Path
        The file; it need not exist, its folder must.

    Yields
    ------
    BinaryIO
        Where the new content goes.

    Raises
    ------
    InputError
        If the file cannot be written there. An `OSError` of the block counts as that.
    """
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f".{target.name[:100]}.{secrets.token_hex(8)}.tmp")
    try:
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        try:
            with os.fdopen(descriptor, "wb") as stream:
                yield stream
                stream.flush()
                if target.exists():
                    temporary.chmod(stat.S_IMODE(target.stat().st_mode))
                os.fsync(stream.fileno())
            os.replace(temporary, target)  # noqa: PTH105 - one well-known call
        except BaseException:
            with contextlib.suppress(OSError):
                temporary.unlink()
            raise
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            f"{path}: it cannot be written ({reason}); expected an existing folder with room and "
            "permission to write, so choose another place; what was there before is unchanged"
        ) from error
    # The rename itself is on the disk once the folder is; not every file system can do that.
    with contextlib.suppress(OSError):
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
