"""The results in Markdown, as the documentation shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from benchmarks.speed.bounds import flops_ns

#: Between these the documentation holds the tables.
BEGIN: Final = "<!-- tables of benchmarks/results/latest.json -->"
END: Final = "<!-- end of tables -->"


def with_tables(page: str, tables: str) -> str:
    """Put tables into a page.

    Parameters
    ----------
    page : str
        Markdown with the marks `BEGIN` and `END`.
    tables : str
        From `markdown_of`.

    Returns
    -------
    str
        The page with these tables in place of the ones it had.
    """
    head, _, rest = page.partition(BEGIN)
    _, _, tail = rest.partition(END)
    return f"{head}{BEGIN}\n{tables}{END}{tail}"


def number(value: float | None, digits: int = 3) -> str:
    """Write a number with so many significant digits, without an exponent where it is readable.

    Parameters
    ----------
    value : float, optional
        What; None becomes a dash.
    digits : int
        How many.

    Returns
    -------
    str
        For a table.
    """
    if value is None:
        return "-"
    if value == 0 or 1e-3 <= abs(value) < 1e6:
        return f"{float(f'{value:.{digits}g}'):,.10f}".rstrip("0").rstrip(".")
    return f"{value:.{digits}g}"


def percent(share: float | None) -> str:
    """Write a share.

    Parameters
    ----------
    share : float, optional
        What; None becomes a dash.

    Returns
    -------
    str
        For a table.
    """
    return "-" if share is None else f"{100 * share:.2g} %"


def acceptance_table(results: Mapping[str, Any]) -> str:
    """Write what was asked for and what was reached.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.

    Returns
    -------
    str
        Markdown.
    """
    lines = ["| result | value | target | met |", "|---|---|---|---|"]
    for name, each in results.items():
        if not (isinstance(each, dict) and {"value", "target", "met", "how"} <= each.keys()):
            continue
        met = {True: "yes", False: "no", None: "-"}[each["met"]]
        value = number(each["value"]) if each["value"] is not None else "not available"
        lines.append(f"| `{name}` | {value} | {number(each['target'])} | {met} |")
    return "\n".join(lines) + "\n"


def implementations_table(results: Mapping[str, Any], which: str) -> str:
    """Write one filter's implementations beside each other.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.
    which : str
        ``published`` or ``default``.

    Returns
    -------
    str
        Markdown.
    """
    lines = [
        "| implementation | precision | ns a sample | ratio | peak memory, MB | limit, ns "
        "| share of limit | difference, Nm rms |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in results["implementations"]:
        if row["filter"] != which:
            continue
        cells = [row["what"], row["precision"]]
        if row["ns_per_sample"] is None:
            cells += ["not available", "-", "-", "-", "-"]
        else:
            cells += [
                number(row["ns_per_sample"]),
                number(row["ratio"]),
                f"{row['peak_memory_bytes'] / 1e6:.0f}",
                number(row["limit_ns"]),
                percent(row["share_of_limit"]),
            ]
        cells.append(number(row["difference_rms_Nm"], 2))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def limits_table(results: Mapping[str, Any]) -> str:
    """Write what the machine can do at best, and what that means for an update.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.

    Returns
    -------
    str
        Markdown.
    """
    limits = results["limits"]
    lines = [
        "| vector level | float, GFLOP/s | double, GFLOP/s | published, float, ns | default, float, ns |",
        "|---|---|---|---|---|",
    ]
    for level, rates in limits["operations_per_s"].items():
        bounds = [flops_ns(which, level, "float", limits) for which in ("published", "default")]
        lines.append(
            f"| {level} | {rates['float'] / 1e9:.0f} | {rates['double'] / 1e9:.0f} "
            f"| {number(bounds[0])} | {number(bounds[1])} |"
        )
    lines += ["", "| threads | copy, GB/s | triad, GB/s |", "|---|---|---|"]
    for threads, rates in limits["bandwidth_bytes_per_s"].items():
        lines.append(f"| {threads} | {rates['copy'] / 1e9:.1f} | {rates['triad'] / 1e9:.1f} |")
    return "\n".join(lines) + "\n"


def markdown_of(results: Mapping[str, Any]) -> str:
    """Write all tables.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.

    Returns
    -------
    str
        Markdown.
    """
    machine = results["machine"]
    flops = results["limits"]["flops"]
    return "\n".join(
        [
            f"{machine['processor']}, {machine['cores']} cores, x86-64-{machine['vector_level']}; "
            f"{machine['compiler']}.\n",
            acceptance_table(results),
            f"Published filter, 6 states, {flops['published']} flops an update:\n",
            implementations_table(results, "published"),
            f"Default ripple filter, 15 states, {flops['default']} flops an update:\n",
            implementations_table(results, "default"),
            "What this machine can do at best:\n",
            limits_table(results),
        ]
    )
