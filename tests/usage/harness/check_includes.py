"""Passes when the core includes nothing but itself and freestanding headers, C's own in C.

Hosted headers, for many channels on a computer, may include more; none of the others includes one.
"""

import pathlib
import re
import sys

ALLOWED = {"cmath", "cstddef", "cstdint", "limits", "type_traits"}
ALLOWED_IN_C = {"stdbool.h", "stdint.h"}
HOSTED = re.compile(r"(batch|lanes)(_\w+)?\.hpp")
ALLOWED_HOSTED = ALLOWED | {
    "algorithm",
    "arm_neon.h",
    "atomic",
    "compare",
    "immintrin.h",
    "initializer_list",
    "memory",
    "span",
    "thread",
    "tuple",
    "utility",
    "vector",
}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)"|(.+))')


def complaints(include: pathlib.Path) -> list[str]:
    """Lines of the core that include something else, each with its place."""
    headers = sorted((include / "strainwave").rglob("*"))
    files = [header for header in headers if header.is_file()]
    if not files:
        return [f"no header under {include}"]
    found = []
    for path in files:
        hosted = HOSTED.fullmatch(path.name) is not None
        plain = ALLOWED_IN_C if path.suffix == ".h" else ALLOWED
        allowed = ALLOWED_HOSTED if hosted else plain
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            if not match:
                continue
            system, own, by_macro = match.groups()
            is_own = own is not None and own.startswith("strainwave/") and (include / own).is_file()
            reaches_hosted = is_own and HOSTED.fullmatch(pathlib.Path(own).name) is not None
            is_level = hosted and by_macro == "STRAINWAVE_LEVEL_FILE"
            if not (system in allowed or is_own or is_level) or (reaches_hosted and not hosted):
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
