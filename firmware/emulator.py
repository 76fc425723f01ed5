"""Runs an image in qemu: what it prints, and how it ends."""

import re
import subprocess
from pathlib import Path

_longest_run_s = 120


class ImageError(RuntimeError):
    """An image that did not end, or not as it should."""


def _command(image: Path, argument: str) -> list[str]:
    board = image.stem.split("-", 1)[1]
    return [
        "qemu-system-arm",
        *("-machine", board, "-kernel", str(image)),
        *("-display", "none", "-monitor", "none", "-serial", "stdio"),
        # One instruction takes 1 ns of simulated time, whatever the host is doing.
        *("-icount", "shift=0"),
        *("-semihosting-config", f"enable=on,target=native,arg={image.name},arg={argument}"),
    ]


def run(image: Path, argument: str = "", options: tuple[str, ...] = (), exit_code: int = 0) -> str:
    """Run an image; what it prints until it ends with the exit code that is expected."""
    try:
        done = subprocess.run(
            [*_command(image, argument), *options],
            capture_output=True,
            text=True,
            timeout=_longest_run_s,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired as caught:
        raise ImageError(f"{image.name} did not end within {_longest_run_s} s") from caught
    if done.returncode != exit_code:
        raise ImageError(
            f"{image.name} ended with code {done.returncode}:\n{done.stdout}{done.stderr}"
        )
    return done.stdout


def executed(image: Path, log: Path) -> list[int]:
    """List the addresses of all instructions executed in a short run, one after the other."""
    run(image, "trace", ("-singlestep", "-d", "exec,nochain", "-D", str(log)))
    text = log.read_text()
    log.unlink()
    return [int(address, 16) for address in re.findall(r"\[[0-9a-f]+/([0-9a-f]+)/", text)]
