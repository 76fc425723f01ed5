"""Memory of a process that works through a long recording."""

from __future__ import annotations

import ctypes
from typing import Final

#: Parameters of the C library's mallopt().
_TRIM_THRESHOLD: Final = -1
_MMAP_THRESHOLD: Final = -3
_ARENA_MAX: Final = -8
_NEVER_BYTES: Final = 1 << 30


def keep_freed_memory() -> None:
    """Let the process use memory again that it has freed, rather than give it back each time.

    Rows come and go in arrays of the same few sizes. To get cleared pages for each anew takes about
    as long as to filter what is in them. Does nothing where the C library is not glibc.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_MMAP_THRESHOLD, _NEVER_BYTES)
        mallopt(_TRIM_THRESHOLD, _NEVER_BYTES)
        # One thread's arrays are freed in another.
        mallopt(_ARENA_MAX, 1)
