"""`python -m benchmarks.golden`: makes the golden vectors; or holds other answers to them."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.golden.chains import CHAINS, Answers
from benchmarks.golden.inputs import samples_of
from benchmarks.golden.on_paths import CHUNK_MEMORIES, path_deviations
from benchmarks.golden.vectors import (
    GOLDEN,
    PRECISIONS,
    answers_of,
    deviations,
    golden_text,
    make_golden,
    read_golden,
)

#: How firmware compute, and what their torques may differ from the host's in the same precision,
#: FS: not at all; where products are fused with sums; where the tool chain's own arithmetic of
#: double rounds otherwise. Fused float is another float: half of what float may be off double.
TOLERANCES_FS: Final = {"float": 0.0, "fused": 5e-5, "double": 1e-12}
#: What any torque may differ from the host's in double, FS.
DOUBLE_TOLERANCE_FS: Final = 1e-4


def records_of(path: Path, arithmetic: str) -> NDArray[Any]:
    """Read what a firmware wrote.

    Parameters
    ----------
    path : Path
        Records of torque, ripple and status, chain after chain.
    arithmetic : str
        One of `TOLERANCES_FS`.

    Returns
    -------
    numpy.ndarray
        Structured, shape (records,).
    """
    real = "<f8" if arithmetic == "double" else "<f4"
    layout = [("torque_Nm", real), ("ripple_Nm", real), ("status", "<u4")]
    if arithmetic == "double":
        layout.append(("padding", "<u4"))
    return np.fromfile(path, dtype=layout)


def compare(path: Path, arithmetic: str) -> int:
    """Hold what a firmware wrote to the golden vectors and to the host, sample by sample.

    Parameters
    ----------
    path : Path
        What the image wrote.
    arithmetic : str
        One of `TOLERANCES_FS`.

    Returns
    -------
    int
        0 where all is within the tolerances, else 1.
    """
    if not path.is_file():
        sys.stdout.write(f"{path}: no such file; expected the answers that the image writes\n")
        return 1
    golden = read_golden()
    count = golden["definition"]["samples"]
    rows = records_of(path, arithmetic)
    if rows.size != count * len(CHAINS):
        sys.stdout.write(
            f"{path}: {rows.size} records, expected {count * len(CHAINS)}; the image did not run "
            "to its end\n"
        )
        return 1
    parts = zip(CHAINS, rows.reshape(-1, count), strict=True)
    good = [is_good(golden, name, part, arithmetic) for name, part in parts]
    return int(not all(good))


def is_good(golden: dict[str, Any], name: str, rows: NDArray[Any], arithmetic: str) -> bool:
    """Hold one chain's answers to the host's, and print how far they are.

    Parameters
    ----------
    golden : dict
        From `read_golden`.
    name : str
        The chain.
    rows : numpy.ndarray
        From `records_of`, shape (samples,).
    arithmetic : str
        One of `TOLERANCES_FS`.

    Returns
    -------
    bool
        Whether they are within the tolerances.
    """
    answers = Answers(rows["torque_Nm"].copy(), rows["ripple_Nm"].copy(), rows["status"].copy())
    own = "double" if arithmetic == "double" else "float"
    scale = golden["definition"]["full_scale_Nm"]
    host = answers_of(golden["definition"], name, own)
    double = answers_of(golden["definition"], name, "double")
    from_own = float(np.max(np.abs(answers.torque_Nm - host.torque_Nm))) / scale
    from_double = float(np.max(np.abs(answers.torque_Nm - double.torque_Nm))) / scale
    others = int(np.count_nonzero(answers.status != host.status))
    found = deviations(golden, name, answers)
    good = others + int(found["other_status"]) == 0
    good = good and from_own <= TOLERANCES_FS[arithmetic] and from_double <= DOUBLE_TOLERANCE_FS
    good = good and (bool(found["same_bits"]) or arithmetic != "float")
    sys.stdout.write(
        f"{name}, {arithmetic}: {'same bits as' if found['same_bits'] else 'other bits than'} the "
        f"host's {own}, at most {from_own:.2g} FS from it and {from_double:.2g} FS from its double, "
        f"{others} other statuses, {rows.size} samples{'' if good else ': FAILED'}\n"
    )
    return good


def print_paths() -> None:
    """Print how far lanes and time chunks are from step by step, the furthest of all levels."""
    golden = read_golden()
    samples = samples_of(golden["definition"], golden["definition"]["samples"])
    sys.stdout.write(
        "| chain | precision | path | furthest from step by step, FS | from the golden torques, FS "
        "| other statuses | chunks |\n|---|---|---|---|---|---|---|\n"
    )
    for name in CHUNK_MEMORIES:
        for precision in PRECISIONS:
            found = list(path_deviations(golden, samples, name, precision))
            for path, part in (
                ("lanes", [each for each in found if not each.chunks]),
                ("time chunks", [each for each in found if each.chunks]),
            ):
                chunks = sorted({each.chunks for each in part if each.chunks})
                sys.stdout.write(
                    f"| {name} | {precision} | {path} | {max(each.furthest_FS for each in part):.1e} "
                    f"| {max(each.from_golden_FS for each in part):.1e} "
                    f"| {sum(each.other_statuses for each in part)} "
                    f"| {', '.join(str(each) for each in chunks)} |\n"
                )


def main() -> int:
    """Make or compare.

    Returns
    -------
    int
        0, or 1 where a firmware's answers are beyond the tolerances.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.golden", description=__doc__)
    parser.add_argument("--compare", type=Path, help="answers of a firmware")
    parser.add_argument(
        "--arithmetic", choices=TOLERANCES_FS, default="float", help="how the firmware computes"
    )
    parser.add_argument(
        "--paths", action="store_true", help="print how far lanes and chunks are from step by step"
    )
    options = parser.parse_args()
    if options.paths:
        print_paths()
        return 0
    if options.compare is not None:
        return compare(options.compare, options.arithmetic)
    GOLDEN.parent.mkdir(parents=True, exist_ok=True)
    GOLDEN.write_text(golden_text(make_golden()), encoding="utf-8")
    sys.stdout.write(f"{GOLDEN} written\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
