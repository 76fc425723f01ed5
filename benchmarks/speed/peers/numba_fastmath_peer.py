"""numba with fastmath: sums reordered, which none of the others is allowed."""

from __future__ import annotations

from benchmarks.speed.inputs import Recording
from benchmarks.speed.peers import numba_options, numba_peer
from benchmarks.speed.peers.peer import Peer


def make(case: str, recording: Recording) -> Peer:
    """Make the peer.

    Parameters
    ----------
    case : str
        ``published_numba_fastmath`` or ``default_numba_fastmath``.
    recording : Recording
        Signals.

    Returns
    -------
    Peer
        Ready to run.
    """
    numba_options.fastmath = True
    return numba_peer.make(case, recording)
