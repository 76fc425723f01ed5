"""`python -m benchmarks.faults`: runs the fault campaign, prints its table, writes the results."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path

# A process a core is at work already. Set before numpy reads it, in the children too.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

RESULTS = Path(__file__).resolve().parents[1] / "results"


def main() -> int:
    """Run the campaign.

    Returns
    -------
    int
        0, whatever is found.
    """
    # Imported here, so that the variables above come first.
    from benchmarks.accuracy.__main__ import rounded  # noqa: PLC0415
    from benchmarks.faults.campaign import run_campaign  # noqa: PLC0415
    from benchmarks.faults.table import markdown_of  # noqa: PLC0415

    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder for results")
    parser.add_argument("--seeds", type=int, default=20, help="runs of each gauge and fault")
    parser.add_argument("--hours", type=float, default=12.0, help="hours of sound gauges")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    started_s = time.monotonic()
    results = rounded(run_campaign(options.seeds, options.hours, options.processes))
    text = markdown_of(results)
    sys.stdout.write(text)
    options.out.mkdir(parents=True, exist_ok=True)
    as_json = json.dumps(results, indent=1, allow_nan=False) + "\n"
    (options.out / "faults.json").write_text(as_json, encoding="utf-8")
    (options.out / "faults.md").write_text(text, encoding="utf-8")
    sys.stdout.write(f"\n{options.out} written after {time.monotonic() - started_s:.0f} s\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
