"""Runs clang-tidy over the project's own files in the compilation databases of build folders.

Reads no more than the standard library, so that it runs before anything is installed.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Written for g++; clang need not know every one of its flags.
CLANG = [
    "--extra-arg=-Wno-unknown-warning-option",
    "--extra-arg=-Wno-ignored-optimization-argument",
]


def own_files(build: pathlib.Path) -> list[pathlib.Path]:
    """Files of the project, or written for it by CMake, in a folder's compilation database."""
    database = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    files = {pathlib.Path(entry["file"]).resolve() for entry in database}
    return sorted(file for file in files if file.is_relative_to(ROOT) and ".venv" not in file.parts)


def check(build: pathlib.Path, file: pathlib.Path) -> tuple[pathlib.Path, bool, str]:
    """Whether clang-tidy is content with one file, and what it says."""
    tidy = pathlib.Path(sys.executable).parent / "clang-tidy"
    command = [str(tidy), "--quiet", "-p", str(build), *CLANG, str(file)]
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    output = result.stdout if result.returncode == 0 else result.stdout + result.stderr
    return file, result.returncode == 0, output


def main() -> int:
    """Check every file; the exit status is the verdict."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", nargs="+", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()

    work = [(build, file) for build in arguments.build for file in own_files(build)]
    if not work:
        print("no file to check")
        return 1
    content = True
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for file, passed, output in pool.map(lambda pair: check(*pair), work):
            if not passed:
                content = False
                print(f"{file.relative_to(ROOT)}\n{output}", flush=True)
    if content:
        print(f"{len(work)} translation units are clean")
    return 0 if content else 1


if __name__ == "__main__":
    sys.exit(main())
