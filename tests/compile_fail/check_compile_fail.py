"""Passes when a file fails to compile with the messages that its first lines state.

A case also holds its own control: compiled with -DSTRAINWAVE_CONTROL it must succeed, so that it
cannot fail for another reason than the misuse that it shows.
"""

import argparse
import pathlib
import subprocess
import sys

PREFIX = "// expected: "


def expected_messages(source: pathlib.Path) -> list[str]:
    """Messages stated at the head of the file, in order."""
    messages = []
    for line in source.read_text(encoding="utf-8").splitlines():
        if not line.startswith(PREFIX):
            break
        messages.append(line.removeprefix(PREFIX).strip())
    return messages


def compile_case(compiler: list[str], source: pathlib.Path, *flags: str) -> tuple[bool, str]:
    """Whether the file compiles, and what the compiler says."""
    # To an object, not -fsyntax-only: templates have to be instantiated.
    command = [*compiler, *flags, "-fno-diagnostics-color", "-c", str(source), "-o", "/dev/null"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return result.returncode == 0, result.stderr


def main() -> int:
    """Check one case; the exit status is the verdict."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("compiler", nargs="+", help="after --: the compiler and its flags")
    arguments = parser.parse_args()

    expected = expected_messages(arguments.source)
    if not expected:
        print(f"{arguments.source.name}: its first line must be '{PREFIX}<substring>'")
        return 1
    compiled, output = compile_case(arguments.compiler, arguments.source)
    if compiled:
        print(f"{arguments.source.name} compiled, and must not")
        return 1
    missing = [message for message in expected if message not in output]
    if missing:
        print(f"{arguments.source.name} failed without saying: {missing}\n{output}")
        return 1
    control, output = compile_case(arguments.compiler, arguments.source, "-DSTRAINWAVE_CONTROL")
    if not control:
        print(f"{arguments.source.name} must compile with -DSTRAINWAVE_CONTROL:\n{output}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
