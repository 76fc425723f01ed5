"""`python -m benchmarks.golden`: makes the golden vectors; or holds a firmware's answers to them."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from benchmarks.golden.chains import CHAINS, Answers
from benchmarks.golden.vectors import (
    GOLDEN,
    answers_of,
    deviations,
    golden_text,
    make_golden,
    read_golden,
)

#: What a float answer may differ from the host's where products are fused with sums, FS.
FUSED_TOLERANCE_FS = 5e-6
#: What a float answer may differ from the host's in double, FS.
DOUBLE_TOLERANCE_FS = 1e-4


def compare(path: Path, *, fused: bool) -> int:
    """Hold what a firmware wrote to the golden vectors and to the host's float, sample by sample.

    Parameters
    ----------
    path : Path
        Records of torque, ripple (float) and status (32 bits), chain after chain.
    fused : bool
        Whether the firmware fuses products and sums, so that its bits are its own.

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
    layout = [("torque_Nm", "<f4"), ("ripple_Nm", "<f4"), ("status", "<u4")]
    rows = np.fromfile(path, dtype=layout)
    if rows.size != count * len(CHAINS):
        sys.stdout.write(
            f"{path}: {rows.size} records, expected {count * len(CHAINS)}; the image did not run "
            "to its end\n"
        )
        return 1
    failed = False
    for name, part in zip(CHAINS, rows.reshape(-1, count), strict=True):
        answers = Answers(part["torque_Nm"], part["ripple_Nm"], part["status"])
        found = deviations(golden, name, answers)
        scale = golden["definition"]["full_scale_Nm"]
        host = answers_of(golden["definition"], name, "float")
        double = answers_of(golden["definition"], name, "double")
        from_float = float(np.max(np.abs(answers.torque_Nm - host.torque_Nm))) / scale
        from_double = float(np.max(np.abs(answers.torque_Nm - double.torque_Nm))) / scale
        other = int(np.count_nonzero(answers.status != host.status))
        good = from_double <= DOUBLE_TOLERANCE_FS and other == 0 and found["other_status"] == 0
        good &= from_float <= FUSED_TOLERANCE_FS if fused else found["same_bits"]
        failed |= not good
        sys.stdout.write(
            f"{name}: {'same bits as' if found['same_bits'] else 'other bits than'} the host's "
            f"float, at most {from_float:.2g} FS from it and {from_double:.2g} FS from its double, "
            f"{other} other statuses, {count} samples{'' if good else ': FAILED'}\n"
        )
    return int(failed)


def main() -> int:
    """Make or compare.

    Returns
    -------
    int
        0, or 1 where a firmware's answers are beyond the tolerances.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.golden", description=__doc__)
    parser.add_argument("--compare", type=Path, help="answers of a firmware")
    parser.add_argument("--fused", action="store_true", help="it fuses products and sums")
    options = parser.parse_args()
    if options.compare is not None:
        return compare(options.compare, fused=options.fused)
    GOLDEN.parent.mkdir(parents=True, exist_ok=True)
    GOLDEN.write_text(golden_text(make_golden()), encoding="utf-8")
    sys.stdout.write(f"{GOLDEN} written\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
