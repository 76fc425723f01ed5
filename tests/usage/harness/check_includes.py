"""Passes when the core includes nothing but itself and freestanding headers, C's own in C."""

import pathlib
import re
import sys

ALLOWED = {"cmath", "cstddef", "cstdint", "limits", "type_traits"}
ALLOWED_IN_C = {"stdbool.h", "stdint.h"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)"|(.+))')


def complaints(include: pathlib.Path) -> list[str]:
    """Lines of the core that include something else, each with its place."""
    headers = sorted((include / "strainwave").rglob("*"))
    files = [header for header in headers if header.is_file()]
    if not files:
        return [f"no header under {include}"]
    found = []
    for path in files:
        allowed = ALLOWED_IN_C if path.suffix == ".h" else ALLOWED
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            if not match:
                continue
            system, own, _ = match.groups()
            is_own = own is not None and own.startswith("strainwave/") and (include / own).is_file()
            if not (system in allowed or is_own):
                found.append(f"{path.relative_to(include)}:{number}: {line.strip()}")
    return found


def main() -> int:
    """Check the folder given; the exit status is the verdict."""
    found = complaints(pathlib.Path(sys.argv[1]))
    for complaint in found:
        print(complaint)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
