"""The loading sequence as a page to print and fill in by hand."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import jinja2

if TYPE_CHECKING:
    from strainwave.commissioning.loading_plan import LoadingPlan


def loading_sheet_html(plan: LoadingPlan, sheet: str) -> str:
    """Draw the sheet as a page, one table for each experiment.

    Parameters
    ----------
    plan : LoadingPlan
        The sequence.
    sheet : str
        Name of the CSV file that holds the same rows.

    Returns
    -------
    str
        A self-contained HTML document.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("strainwave.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    numbered = enumerate(plan.rows, 1)
    experiments = [
        list(rows) for _, rows in itertools.groupby(numbered, lambda row: row[1].experiment)
    ]
    template = environment.get_template("loading_sheet.html.j2")
    return template.render(plan=plan, sheet=sheet, experiments=experiments)
