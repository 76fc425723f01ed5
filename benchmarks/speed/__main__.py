"""`python -m benchmarks.speed`: runs the speed bench, prints its tables, writes the results.

Agreement with dense references is checked first; who disagrees is reported and not timed.
"""

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

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results"
DOCS = ROOT / "docs"
EXAMPLE = """example: python -m benchmarks.speed --quick --out /tmp/speed
  measures for some minutes less and leaves the results on record alone"""


def main() -> int:
    """Run the bench.

    Returns
    -------
    int
        0, whatever is measured; 1 where the core's own programs cannot be built.
    """
    # Imported here, so that the variables above come first.
    from benchmarks.accuracy.__main__ import rounded  # noqa: PLC0415
    from benchmarks.speed.bench import FULL, QUICK, run_bench  # noqa: PLC0415
    from benchmarks.speed.figures import FIGURES  # noqa: PLC0415
    from benchmarks.speed.programs import prepare  # noqa: PLC0415
    from benchmarks.speed.table import markdown_of, with_tables  # noqa: PLC0415

    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.speed",
        description=__doc__,
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--quick", action="store_true", help="few rounds, short logs; no curves, docs left alone"
    )
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder for results")
    parser.add_argument("--docs", type=Path, default=DOCS, help="documentation to bring up to date")
    parser.add_argument("--json", action="store_true", help="print the results as JSON")
    options = parser.parse_args()
    started_s = time.monotonic()

    def say(text: str) -> None:
        sys.stderr.write(f"{time.monotonic() - started_s:6.0f} s  {text}\n")

    try:
        programs = prepare(say)
    except RuntimeError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    results = rounded(run_bench(programs, QUICK if options.quick else FULL, say))
    as_json = json.dumps(results, indent=1, allow_nan=False) + "\n"
    text = markdown_of(results)
    sys.stdout.write(as_json if options.json else text)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "latest.json").write_text(as_json, encoding="utf-8")
    if results["scaling"] is not None:
        for name, draw in FIGURES.items():
            (options.docs / "images" / name).write_text(draw(results), encoding="utf-8")
        page = options.docs / "reference" / "bench.md"
        before = page.read_text(encoding="utf-8")
        page.write_text(with_tables(before, text), encoding="utf-8")
    say(f"{options.out} written")
    return 0


if __name__ == "__main__":
    sys.exit(main())
