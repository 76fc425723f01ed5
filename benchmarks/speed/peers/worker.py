"""`python -m benchmarks.speed.peers.worker CASE INPUTS`: one implementation, told what to do by lines.

The same lines as the programs in C++ and Rust take: ``time SAMPLES SECONDS`` and
``write SAMPLES FILE``; each is answered by one line of JSON.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.speed.inputs import Recording, read
from benchmarks.speed.peers.peer import Peer


def peer_of(case: str, recording: Recording) -> Peer:
    """Make the peer of a case.

    Parameters
    ----------
    case : str
        ``filter_package``, for example ``published_filterpy``.
    recording : Recording
        Its inputs.

    Returns
    -------
    Peer
        Ready to run.
    """
    package = case.split("_", 1)[1]
    make: Callable[[str, Recording], Peer] = importlib.import_module(
        f"benchmarks.speed.peers.{package}_peer"
    ).make
    return make(case, recording)


def _answer(peer: Peer, words: list[str]) -> dict[str, Any]:
    if words[0] == "write":
        ripple = peer.ripple_Nm(peer.run(int(words[1])))
        Path(words[2]).write_bytes(np.asarray(ripple, dtype="<f8").tobytes())
        return {"samples": len(ripple)}
    samples, least_s = int(words[1]), float(words[2])
    runs, taken_s = 0, 0.0
    began_s = time.perf_counter()
    while taken_s < least_s:
        peer.run(samples)
        runs += 1
        taken_s = time.perf_counter() - began_s
    return {"ns_per_sample": 1e9 * taken_s / (runs * samples), "runs": runs}


def main() -> int:
    """Answer lines until there are no more.

    Returns
    -------
    int
        0.
    """
    peer = peer_of(sys.argv[1], read(Path(sys.argv[2])))
    sys.stdout.write(json.dumps({"version": peer.version}) + "\n")
    sys.stdout.flush()
    for line in sys.stdin:
        sys.stdout.write(json.dumps(_answer(peer, line.split())) + "\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
