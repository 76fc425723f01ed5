"""Passes when a freestanding object needs the C math library and memory moves, and nothing else.

No heap, exceptions, RTTI, guarded statics or standard library may be referred to, and no writable
object be defined: the core keeps no state of its own.
"""

import pathlib
import subprocess
import sys

MEMORY = {"memcpy", "memmove", "memset", "memcmp"}
MATH = {
    "acos", "asin", "atan", "atan2", "cbrt", "ceil", "copysign", "cos", "cosh", "exp", "exp2",
    "expm1", "fabs", "floor", "fma", "fmax", "fmin", "fmod", "frexp", "hypot", "ldexp", "llround",
    "log", "log10", "log1p", "log2", "lround", "modf", "nearbyint", "pow", "remainder", "rint",
    "round", "scalbn", "sin", "sincos", "sinh", "sqrt", "tan", "tanh", "trunc",
}  # fmt: skip
# In double and in float; the core does not compute in long double.
ALLOWED = MEMORY | MATH | {f"{name}f" for name in MATH}
# What the linker itself supplies for position-independent code.
LINKER = {"_GLOBAL_OFFSET_TABLE_"}
WRITABLE_SECTIONS = (".data", ".bss", ".tdata", ".tbss", "*COM*")
RUN_TIME_OBJECTS = ("guard variable for", "typeinfo for", "typeinfo name for", "vtable for")


def symbols(nm: str, path: pathlib.Path) -> list[tuple[str, str, str]]:
    """Name, class letter and section of every symbol of an object."""
    command = [nm, "--demangle", "--format=sysv", str(path)]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = []
    for line in output.splitlines():
        # A demangled name may itself hold the separator (operator|): read the columns from the end.
        columns = [column.strip() for column in line.rsplit("|", maxsplit=6)]
        if len(columns) == 7 and columns[0] != "Name":
            found.append((columns[0], columns[2], columns[6]))
    return found


def complaints(found: list[tuple[str, str, str]]) -> list[str]:
    """What these symbols hold against the object."""
    if not any(kind == "T" for _, kind, _ in found):
        return ["defines no function: nothing was tested"]
    result = []
    for name, kind, section in found:
        is_undefined = section == "*UND*"
        if is_undefined and name not in ALLOWED | LINKER:
            result.append(f"needs {name}")
        # .data.rel.ro is written by the linker alone.
        if section.startswith(WRITABLE_SECTIONS) and not section.startswith(".data.rel.ro"):
            result.append(f"holds the writable object {name} ({kind}, {section})")
        if name.startswith(RUN_TIME_OBJECTS):
            result.append(f"holds {name}")
    return result


def main() -> int:
    """Check the object given; the exit status is the verdict."""
    nm, path = sys.argv[1], pathlib.Path(sys.argv[2])
    found = complaints(symbols(nm, path))
    for complaint in found:
        print(f"{path.name} {complaint}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
