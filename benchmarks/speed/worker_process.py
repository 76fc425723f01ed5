"""A worker: one implementation in a process of its own, pinned to a core, told what to do by lines."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any, Self

import numpy as np

from benchmarks.speed.inputs import Array
from benchmarks.speed.programs import ROOT


class NotAvailableError(Exception):
    """An implementation that cannot be run here, and why."""


def pinned(cores: int) -> set[int]:
    """Choose cores: the last ones, because interrupts go to the first.

    Parameters
    ----------
    cores : int
        How many.

    Returns
    -------
    set of int
        Their numbers.
    """
    return set(sorted(os.sched_getaffinity(0))[-cores:])


class Worker:
    """A process that answers lines.

    Parameters
    ----------
    command : list of str or Path
        What to start.
    cores : int
        How many it may use.
    """

    def __init__(self, command: list[str | Path], cores: int = 1) -> None:
        every = os.sched_getaffinity(0)
        os.sched_setaffinity(0, pinned(cores))  # the child inherits it, with all of its threads
        try:
            self._process = subprocess.Popen(  # noqa: S603
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                cwd=ROOT,
                env={
                    **os.environ,
                    "PYTHONPATH": os.pathsep.join(
                        filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")])
                    ),
                    "OPENBLAS_NUM_THREADS": "1",
                    "OMP_NUM_THREADS": "1",
                },
            )
        except FileNotFoundError as error:
            raise NotAvailableError(f"{command[0]} is missing") from error
        finally:
            os.sched_setaffinity(0, every)
        try:
            self.version: str = self._read()["version"]
        except NotAvailableError:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def _read(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            assert self._process.stderr is not None
            said = self._process.stderr.read().strip().splitlines()
            raise NotAvailableError(said[-1] if said else "it ended without a word")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def ask(self, line: str) -> dict[str, Any]:
        """Send a line.

        Parameters
        ----------
        line : str
            ``time SAMPLES SECONDS`` or ``write SAMPLES FILE``.

        Returns
        -------
        dict
            The answer.
        """
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass  # what it said at its end is read below
        return self._read()

    def time_ns(self, samples: int, seconds: float) -> float:
        """Time it.

        Parameters
        ----------
        samples : int
            Length of a run.
        seconds : float
            Runs are repeated for at least so long.

        Returns
        -------
        float
            ns a sample.
        """
        return float(self.ask(f"time {samples} {seconds}")["ns_per_sample"])

    def ripple_Nm(self, samples: int, folder: Path) -> Array:
        """Run it once and take what it found.

        Parameters
        ----------
        samples : int
            How many.
        folder : Path
            For a file.

        Returns
        -------
        numpy.ndarray
            Predicted ripple.
        """
        path = folder / f"ripple-{self._process.pid}.f64"
        self.ask(f"write {samples} {path}")
        ripple = np.fromfile(path, dtype="<f8")
        path.unlink()
        return ripple

    @property
    def peak_memory_bytes(self) -> int:
        """Most memory the process has had."""
        status = Path(f"/proc/{self._process.pid}/status").read_text(encoding="ascii")
        (line,) = (each for each in status.splitlines() if each.startswith("VmHWM:"))
        return 1024 * int(line.split()[1])

    def close(self) -> None:
        """End the process."""
        for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
            if stream is not None:
                stream.close()
        self._process.wait()
