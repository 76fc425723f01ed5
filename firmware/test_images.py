"""Runs all images in qemu, checks what they do, and writes what they cost.

python3 firmware/test_images.py build/firmware firmware/results.json
"""

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import budgets
import controller
import emulator
import spoilt

_flips_each = 4  # in each of the joint's constants
_not_as_it_should = (
    budgets.MismatchError,
    controller.MismatchError,
    emulator.ImageError,
    spoilt.NoJointError,
)


def _version(tool: str) -> str:
    done = subprocess.run([tool, "--version"], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[0]


def _spoil(image: Path) -> str:
    flips = 0
    for copy in spoilt.copies(image, _flips_each):
        controller.check_spoilt(copy)
        flips += 1
    return f"{flips} flipped bits in the joint's constants: each a fault, and no torque"


def main(build: Path, results_file: Path) -> int:
    """Check all there is to check; the exit code."""
    with ThreadPoolExecutor(max_workers=2) as pool:
        shown = [
            pool.submit(controller.check, build / f"controller-{b}.elf") for b in controller.boards
        ]
        refused = [pool.submit(_spoil, build / f"controller-{b}.elf") for b in controller.boards]
        measured = [
            pool.submit(budgets.measure, build / f"{s}-mps2-an386.elf") for s in budgets.subjects
        ]
        try:
            for board, line in zip(controller.boards, shown, strict=True):
                print(f"{board}: {line.result()}")
            for board, line in zip(controller.boards, refused, strict=True):
                print(f"{board}: {line.result()}")
            results = {s: m.result() for s, m in zip(budgets.subjects, measured, strict=True)}
        except _not_as_it_should as caught:
            print(f"firmware: {caught}", file=sys.stderr)
            return 1
    for subject, figures in results.items():
        print(
            f"{subject}: {figures['instructions']:g} instructions per update "
            f"(worst {figures['worst_instructions']:g}; about {figures['cycles_estimated']:g} "
            f"cycles), {figures['code_bytes']} B code, {figures['state_bytes']} B state, "
            f"{figures['stack_bytes']} B stack"
        )
    record = {
        "command": "make firmware-test",
        "compiler": _version("arm-none-eabi-g++"),
        "emulator": _version("qemu-system-arm"),
        "processor": "Cortex-M4F (mps2-an386)",
        **results,
        "over_limits": budgets.over_limits(results),
    }
    before = json.loads(results_file.read_text()) if results_file.exists() else {}
    results_file.write_text(json.dumps(record, indent=2) + "\n")
    for line in record["over_limits"]:
        print(f"over its limit: {line}")
    if before.get("compiler") != record["compiler"]:
        return 0
    dearer = budgets.grown({s: before[s] for s in budgets.subjects if s in before}, results)
    for line in dearer:
        print(f"dearer than on record: {line}. Commit {results_file} if that is meant")
    return 1 if dearer else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
