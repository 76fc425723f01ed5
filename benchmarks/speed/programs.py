"""What has to be there before anything is timed: C++ and Rust programs, an environment of peers.

A peer that cannot be had is no error: it is said in a sentence, and the bench goes on without it.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[2]
BUILD: Final = ROOT / "build" / "bench"
_SPEED: Final = ROOT / "benchmarks" / "speed"

Say = Callable[[str], None]


@dataclass(frozen=True)
class Programs:
    """Where the programs are.

    Attributes
    ----------
    cpp : Path
        Folder of ``strainwave_native``, ``strainwave_dispatched`` and ``strainwave_limits``.
    rust : Path or None
        The program with minikalman.
    peers : Path
        Python with the peers in it, or this one.
    """

    cpp: Path
    rust: Path | None
    peers: Path


def _run(command: list[str | Path], **environment: str) -> str:
    """Run a command; return nothing, or what went wrong in one line."""
    try:
        subprocess.run(  # noqa: S603
            command,
            check=True,
            capture_output=True,
            text=True,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
        )
    except FileNotFoundError:
        return f"{command[0]} is not installed"
    except subprocess.CalledProcessError as error:
        lines = (error.stderr + error.stdout).strip().splitlines() or ["no message"]
        return next((line for line in lines if "error" in line.lower()), lines[-1]).strip()
    return ""


def build_cpp() -> str:
    """Build the C++ programs.

    Returns
    -------
    str
        What went wrong, or nothing.
    """
    folder = BUILD / "cpp"
    configure = ["cmake", "-S", _SPEED / "cpp", "-B", folder, "-G", "Ninja"]
    # A warning of another compiler stops nobody who only wants to measure.
    wrong = _run([*configure, "-DCMAKE_BUILD_TYPE=Release", "-DSTRAINWAVE_WERROR=OFF"])
    return wrong or _run(["cmake", "--build", folder])


def build_rust() -> str:
    """Build the program with minikalman.

    Returns
    -------
    str
        What went wrong, or nothing.
    """
    # minikalman names a newer Rust than Debian 12 has, and compiles with that one.
    return _run(
        [
            "cargo",
            "build",
            "--quiet",
            "--release",
            "--ignore-rust-version",
            "--manifest-path",
            _SPEED / "rust" / "Cargo.toml",
        ],
        CARGO_TARGET_DIR=str(BUILD / "rust"),
        RUSTFLAGS="-C target-cpu=native",
    )


def install_peers() -> str:
    """Make the environment of the peers in Python, or find it as the lock file has it.

    Returns
    -------
    str
        What went wrong, or nothing.
    """
    lock = ROOT / "requirements-bench.lock"
    folder = BUILD / "peers"
    installed = folder / "installed.lock"
    if installed.exists() and installed.read_bytes() == lock.read_bytes():
        return ""
    wrong = _run([sys.executable, "-m", "venv", folder]) or _run(
        [
            folder / "bin" / "python",
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--require-hashes",
            "--only-binary",
            ":all:",
            "-r",
            lock,
        ]
    )
    if not wrong:
        shutil.copyfile(lock, installed)
    return wrong


def find() -> Programs:
    """Find what has been built.

    Returns
    -------
    Programs
        Where it is.
    """
    rust = BUILD / "rust" / "release" / "strainwave-speed"
    peers = BUILD / "peers" / "bin" / "python"
    return Programs(
        BUILD / "cpp",
        rust if rust.exists() else None,
        peers if peers.exists() else Path(sys.executable),
    )


def prepare(say: Say) -> Programs:
    """Build and install everything.

    Parameters
    ----------
    say : callable
        Takes a sentence for the person who waits.

    Returns
    -------
    Programs
        What there is.

    Raises
    ------
    RuntimeError
        If the core's own programs cannot be built.
    """
    say("building the C++ programs")
    if wrong := build_cpp():
        raise RuntimeError(f"the C++ programs of the bench cannot be built: {wrong}")
    say("building the Rust program")
    if wrong := build_rust():
        say(f"minikalman is not available: {wrong}")
    say("installing peers in Python")
    if wrong := install_peers():
        say(f"peers in Python are not available but for what is installed already: {wrong}")
    return find()
