"""The certificate as a page and as a document: words, tables and figures from its block."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from markupsafe import Markup

from strainwave.certificate.sealing import SLOT, sealed
from strainwave.report.figures_certificate import (
    fluctuation_figure,
    limits_figure,
    load_errors_figure,
)
from strainwave.report.figures_fluctuation import fluctuation_vectors_figure
from strainwave.report.page import templates
from strainwave.report.style import data_uri, svg

if TYPE_CHECKING:
    from strainwave.certificate.building import Certificate

#: Most harmonics whose vectors are drawn.
_FIGURE_HARMONICS: Final = 3
#: Largest height of a figure on paper, over the width of the text.
_TALLEST: Final = 1.2
_SIZE: Final = re.compile(r'(?:width|height)="([0-9.]+)pt"')


@dataclass(frozen=True)
class CertificateFigure:
    """A figure with its words.

    Attributes
    ----------
    title, caption, alternative : str
        Heading, what it shows, and it in words for who does not see it.
    svg : str
        The drawing.
    """

    title: str
    caption: str
    alternative: str
    svg: str

    @property
    def image(self) -> str:
        """The figure as a data address."""
        return data_uri(self.svg)

    @property
    def width_percent(self) -> float:
        """Share of the text's width at which it fits on a page."""
        width, height = (float(size) for size in _SIZE.findall(self.svg)[:2])
        return min(100.0, 100.0 * _TALLEST * width / height)


def certificate_figures(certificate: Certificate) -> tuple[CertificateFigure, ...]:
    """Draw the figures that the certificate has data for.

    Parameters
    ----------
    certificate : Certificate
        What it says.

    Returns
    -------
    tuple of CertificateFigure
        Judged values, errors and hysteresis, fluctuation, vectors; those without data are left out.
    """
    figures = []
    of = "Simulated data. " if certificate.block["data"] == "simulated" else ""
    judged = [each for each in certificate.block["judgements"] if "value" in each]
    if judged:
        worst = max(judged, key=lambda each: each["value"] / each["limit"])
        figures.append(
            CertificateFigure(
                "Values and limits",
                f"{of}Every judged value as a share of its limit.",
                f"Largest share: {worst['label']}, {judged_text(worst['value'], worst['limit'])} of "
                f"{number_text(worst['limit'])} {worst['unit']}",
                svg(limits_figure(judged)),
            )
        )
    loads = certificate.loads
    if loads is not None:
        figures.append(
            CertificateFigure(
                "Linearity and hysteresis",
                f"{of}Readings of {loads.source.name}, turned into torque by the joint file as it "
                "stands; full scale is the rated torque.",
                f"Errors up to {loads.largest_error_percent:.3g} %FS over the load",
                svg(load_errors_figure(loads)),
            )
        )
    found = certificate.fluctuation
    if found is not None:
        same = ""
        if found.source.is_the_calibrations:
            same = (
                " The gains were found from this recording: what is below the uncertainty is zero "
                "by construction."
            )
        figures.append(
            CertificateFigure(
                "Fluctuation before and after",
                f"{of}Recording {found.source.name}: amplitude of the sum of all gauges, zero to "
                f"peak, with equal gains and with those of the joint file.{same}",
                "Amplitude of each harmonic with equal gains and with the gains found",
                svg(fluctuation_figure(found)),
            )
        )
        vectors = found.phasors[: max(1, min(_FIGURE_HARMONICS, len(found.phasors) - 1))]
        figures.append(
            CertificateFigure(
                "Vectors of the gauges",
                f"{of}Vectors of every gauge put end to end, as in Godler et al. 2000, fig. 8; where "
                "they close, nothing is left.",
                "Vector diagram of the gauges with equal gains and with the gains found",
                svg(fluctuation_vectors_figure(vectors, found.gains, "V")),
            )
        )
    return tuple(figures)


def number_text(value: float) -> str:
    """Write a number so that reading it gives the same number again.

    Parameters
    ----------
    value : int or float
        A finite number.

    Returns
    -------
    str
        The shortest decimal that is the number.
    """
    if isinstance(value, int):
        return str(value)
    return repr(float(value)).removesuffix(".0")


def judged_text(value: float, limit: float) -> str:
    """Write a judged value with four digits, or as many as show on which side of the limit it is.

    Parameters
    ----------
    value, limit : float
        Finite numbers.

    Returns
    -------
    str
        The number; every digit of it stands among the results.
    """
    for digits in range(4, 18):
        text = f"{value:.{digits}g}"
        if (float(text) > limit) == (value > limit):
            return text
    return number_text(value)


def values_text(values: list[float]) -> str:
    """Write a number, or several by commas.

    Parameters
    ----------
    values : list of float
        Finite numbers.

    Returns
    -------
    str
        As `number_text` writes them.
    """
    return ", ".join(number_text(value) for value in values)


def certificate_page(certificate: Certificate, figures: tuple[CertificateFigure, ...]) -> str:
    """Render the certificate as HTML, with its block and hashes inside.

    Parameters
    ----------
    certificate : Certificate
        What it says.
    figures : tuple of CertificateFigure
        From `certificate_figures`.

    Returns
    -------
    str
        A page that needs no other file and no network.
    """
    environment = templates()
    environment.filters["number"] = number_text
    environment.filters["numbers"] = values_text
    environment.filters["breakable"] = _breakable
    environment.globals["judged"] = judged_text
    page = environment.get_template("certificate.html.j2").render(
        block=certificate.block,
        sha256=certificate.sha256,
        figures=figures,
        slot=SLOT,
        **wording(certificate.block),
    )
    return sealed(page, certificate.block)


def _breakable(key: str) -> Markup:
    """Let a long key go on in the next line after a point or an underscore."""
    return Markup("<wbr>").join(re.split(r"(?<=[._])", key))


def wording(block: dict[str, Any]) -> dict[str, Any]:
    """Return the sentences and rows that page and document share.

    Parameters
    ----------
    block : dict
        What the certificate says.

    Returns
    -------
    dict
        Texts and lists of rows by name.
    """
    failing = [each["label"] for each in block["judgements"] if each["verdict"] == "fail"]
    failing += [each["what"] for each in block["checks"] if each["verdict"] == "fail"]
    verdict = {
        "pass": "PASS: every value is within its limit",
        "fail": f"FAIL: {'; '.join(failing)}",
        "incomplete": "INCOMPLETE: not everything that was to be judged is known",
        "no limits stated": "NOT JUDGED: no limits were stated",
    }[block["verdict"]]
    rules = {
        "simple": "A value passes where it is at most its limit; its uncertainty is not counted in.",
        "guarded": "A value passes where it and its expanded uncertainty together are at most the limit.",
    }
    simulated = ""
    if block["data"] == "simulated":
        told = ", ".join(f"[{name}]" for name in block["simulated_sections"])
        simulated = "SIMULATED: these values come from a simulation and not from a real joint" + (
            f" (the joint file says so of {told})." if told else "."
        )
    return {
        "verdict_text": verdict,
        "rule_text": rules[block["session"]["decision_rule"]],
        "simulated_text": simulated,
        "about": _about(block),
        "surroundings": _surroundings(block["session"], block["joint"]),
        "uncertainty_text": "Expanded uncertainties U are the standard uncertainties times k = "
        f"{number_text(block['coverage_factor'])}, for a coverage of about 95 %. FS is the rated torque.",
    }


def _about(block: dict[str, Any]) -> list[tuple[str, str]]:
    session = block["session"]
    return [
        ("Operator", session["operator"]),
        ("Laboratory", session["laboratory"]),
        ("Place", session["place"]),
        ("Day of calibration", session["date"]),
        ("Valid until", session.get("valid_until", "not stated")),
        ("Issued", block["issued_at"]),
        ("Software", f"{block['software']['name']} {block['software']['version']}"),
    ]


def _surroundings(session: dict[str, Any], joint: dict[str, Any]) -> list[tuple[str, str]]:
    air = session["environment"]
    rows = [("Setup", session["setup"].strip())]
    for label, key, unit, spread_key, spread_unit in (
        ("Temperature", "temperature_degC", "°C", "temperature_uncertainty_K", "K"),
        (
            "Relative humidity",
            "relative_humidity_percent",
            "%",
            "relative_humidity_uncertainty_percent",
            "%",
        ),
    ):
        if key in air:
            text = f"{number_text(air[key])} {unit}"
            if spread_key in air:
                text += f" ± {number_text(air[spread_key])} {spread_unit}"
            rows.append((label, text))
    for label, values, key in (
        ("Remarks", session, "remarks"),
        ("Notes of the joint file", joint, "notes"),
    ):
        if key in values:
            rows.append((label, values[key].strip()))
    return rows
