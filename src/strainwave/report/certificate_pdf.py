"""The certificate as a PDF document, set by typst."""

from __future__ import annotations

import json
from datetime import datetime
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import matplotlib as mpl

from strainwave.errors import InputError
from strainwave.report.certificate import judged_text, number_text, values_text, wording

if TYPE_CHECKING:
    from collections.abc import Callable

    from strainwave.certificate.building import Certificate
    from strainwave.report.certificate import CertificateFigure

#: Of the pages as images.
_PIXELS_PER_INCH: Final = 100.0


def certificate_pdf(certificate: Certificate, figures: tuple[CertificateFigure, ...]) -> bytes:
    """Set the certificate as PDF; the same bytes for the same certificate.

    Parameters
    ----------
    certificate : Certificate
        What it says.
    figures : tuple of CertificateFigure
        From `strainwave.report.certificate.certificate_figures`.

    Returns
    -------
    bytes
        The document.

    Raises
    ------
    InputError
        If the package typst is not installed.
    """
    (document,) = _compiled(certificate, figures, "pdf")
    return document


def certificate_images(
    certificate: Certificate, figures: tuple[CertificateFigure, ...]
) -> list[bytes]:
    """Draw every page of the document as PNG; parameters as in `certificate_pdf`.

    Parameters
    ----------
    certificate : Certificate
        What it says.
    figures : tuple of CertificateFigure
        Its figures.

    Returns
    -------
    list of bytes
        One image a page.

    Raises
    ------
    InputError
        If the package typst is not installed.
    """
    return _compiled(certificate, figures, "png")


def _compiled(
    certificate: Certificate,
    figures: tuple[CertificateFigure, ...],
    kind: Literal["pdf", "png"],
) -> list[bytes]:
    try:
        import typst  # noqa: PLC0415 - installed where PDF is wanted
    except ImportError as error:
        raise InputError(
            "--pdf: the package typst, which sets the document, is not installed; expected it, so "
            "install strainwave[pdf], or leave --pdf out and print the HTML"
        ) from error
    issued = datetime.fromisoformat(certificate.block["issued_at"])
    template = resources.files("strainwave.report").joinpath("templates/certificate.typ")
    # Its stubs tie the kinds of several arguments together, and know of no list of pages.
    compile_document: Callable[..., bytes | list[bytes]] = typst.compile
    compiled = compile_document(
        template.read_bytes(),
        format=kind,
        font_paths=[Path(mpl.get_data_path()) / "fonts" / "ttf"],
        ignore_system_fonts=True,
        sys_inputs={"data": json.dumps(_data(certificate, figures, issued))},
        timestamp=issued,
        ppi=_PIXELS_PER_INCH,
    )
    return compiled if isinstance(compiled, list) else [compiled]


def _data(
    certificate: Certificate, figures: tuple[CertificateFigure, ...], issued: datetime
) -> dict[str, Any]:
    block = certificate.block
    return {
        "block": block,
        "sha256": certificate.sha256,
        "year": issued.year,
        "month": issued.month,
        "day": issued.day,
        **wording(block),
        "judgements": [
            {
                "label": each["label"],
                "value": judged_text(each["value"], each["limit"])
                if "value" in each
                else "not known",
                "uncertainty": f"{each['expanded_uncertainty']:.2g}"
                if "expanded_uncertainty" in each
                else "–",
                "limit": number_text(each["limit"]),
                "unit": each["unit"],
                "verdict": each["verdict"],
            }
            for each in block["judgements"]
        ],
        "results": [
            {
                "key": each["key"],
                "label": each["label"],
                "value": values_text(each["values"]),
                "uncertainty": values_text(each["standard_uncertainties"]) or "–",
                "unit": each["unit"],
            }
            for each in block["results"]
        ],
        "figures": [
            {
                "title": each.title,
                "caption": each.caption,
                "alternative": each.alternative,
                "svg": each.svg,
                "width_percent": each.width_percent,
            }
            for each in figures
        ],
    }
