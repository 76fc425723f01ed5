"""Lays the core out as an Arduino library: headers under src/, properties, an example that compiles.

The repository is none itself, because src/ holds the Python package. PlatformIO takes the repository
as it is, by library.json, or this folder.
"""

import argparse
import json
import shutil
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
SKETCH = "strainwave_torque"

PROPERTIES = """\
name=strainwave
version={version}
author=strainwave maintainers
maintainer=strainwave maintainers
sentence={sentence}
paragraph=Gauges to torque with the ripple removed, for one exported joint. Needs a compiler set to C++20.
category=Sensors
architectures=*
includes=strainwave_arduino.h
"""


def lay_out(folder: Path) -> None:
    """Write the library into a folder that does not exist yet."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    described = json.loads((ROOT / "library.json").read_text(encoding="utf-8"))
    if described["version"] != project["version"]:
        raise SystemExit(
            f"library.json has version {described['version']}, but pyproject.toml "
            f"{project['version']}; expected the same, so correct library.json"
        )
    if folder.exists():
        raise SystemExit(f"--out {folder}: it exists; expected a new folder, so choose another")
    shutil.copytree(ROOT / "include", folder / "src")
    sketch = folder / "examples" / SKETCH
    shutil.copytree(ROOT / "examples" / "arduino" / SKETCH, sketch)
    for name in ("wrist.hpp", "strainwave_joint.h", "strainwave_joint.cpp"):
        shutil.copy(ROOT / "examples" / "joint" / name, sketch / name)
    shutil.copy(ROOT / "LICENSE", folder / "LICENSE")
    properties = PROPERTIES.format(version=project["version"], sentence=project["description"])
    (folder / "library.properties").write_text(properties, encoding="utf-8")


def main() -> int:
    """Lay the library out where --out says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="a folder that does not exist yet")
    folder = parser.parse_args().out
    lay_out(folder)
    print(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
