"""`strainwave certify`: a certificate of a joint file, as HTML and PDF."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import cyclopts

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from strainwave.certificate.building import Certificate


#: Beyond this a certificate's own loads speak of another joint, or of another unit.
LARGEST_LIKELY_ERROR_PERCENT: Final = 5.0


def certify(
    joint: Path | None = None,
    /,
    *,
    session: Path | None = None,
    out: Path | None = None,
    pdf: Path | None = None,
    loads: Path | None = None,
    loads_map: Annotated[tuple[str, ...], cyclopts.Parameter(show_default=False)] = (),
    fluctuation: Path | None = None,
    fluctuation_map: Annotated[tuple[str, ...], cyclopts.Parameter(show_default=False)] = (),
    template: Path | None = None,
    json: bool = False,
) -> None:
    """Write the certificate of a joint file: who, with what, results, limits, hashes.

    Example: strainwave certify joint.toml --session session.toml --loads loads.csv
    --fluctuation run.csv --out certificate.html --pdf certificate.pdf

    Parameters
    ----------
    joint : Path
        The joint file, with a serial number.
    session : Path
        Operator, instruments, setup, environment and limits: .toml.
    out : Path
        The certificate that is written: .html.
    pdf : Path
        The same as a document: .pdf.
    loads : Path
        A table of loads, for the figure of linearity and hysteresis.
    loads_map : tuple of str
        Which of its columns are what, as for `strainwave calibrate torque`; that command's own
        mapping without.
    fluctuation : Path
        A recording of all gauges, for the figures of fluctuation and vectors.
    fluctuation_map : tuple of str
        Which of its columns are what, as for `strainwave calibrate fluctuation`; that command's own
        mapping without.
    template : Path
        Write an empty session file there, and nothing else.
    json : bool
        Print the certificate's values as JSON.
    """
    from strainwave.cli.output import print_json, progress_console, result_console
    from strainwave.errors import InputError

    if template is not None:
        _write_template(template, [joint, session, out, pdf, loads, fluctuation])
        result_console().print(f"{template}: an empty session file", soft_wrap=True, markup=False)
        return
    if joint is None or session is None or out is None:
        missing = next(
            name
            for name, given in (("JOINT.toml", joint), ("--session", session), ("--out", out))
            if given is None
        )
        raise InputError(
            f"{missing} is missing; expected a joint file, --session and --out, or --template alone "
            "for an empty session file, so add it"
        )
    _check_outputs(out, pdf, [joint, session, loads, fluctuation])
    certificate = _certificate(joint, session, loads, loads_map, fluctuation, fluctuation_map)
    _write(certificate, out, pdf)
    for warning in _warnings(certificate):
        progress_console().print(f"strainwave: warning: {warning}", soft_wrap=True, markup=False)
    if json:
        print_json({**certificate.block, "certificate_sha256": certificate.sha256})
        return
    console = result_console()
    for line in _lines(certificate, out, pdf):
        console.print(line, soft_wrap=True, markup=False)


def _write_template(template: Path, others: Sequence[Path | None]) -> None:
    from strainwave.atomic import write_atomically
    from strainwave.certificate.session import session_template
    from strainwave.errors import InputError
    from strainwave.records.checks import check_output

    if any(other is not None for other in others):
        raise InputError(
            f"--template {template}: something else is asked for beside it; expected --template "
            "alone, so write the empty session file first"
        )
    check_output(template, option="--template", endings=(".toml",))
    if template.exists():
        raise InputError(
            f"--template {template}: there is a file already; expected a new name, so choose "
            "another one"
        )
    write_atomically(template, session_template().encode())


def _check_outputs(out: Path, pdf: Path | None, inputs: Sequence[Path | None]) -> None:
    from strainwave.errors import InputError

    taken = {given.resolve() for given in inputs if given is not None}
    for option, path, ending in (("--out", out, ".html"), ("--pdf", pdf, ".pdf")):
        if path is None:
            continue
        if path.suffix.lower() != ending:
            raise InputError(
                f"{option} {path}: the name ends in {path.suffix!r}; expected a certificate, so "
                f"choose a name that ends in {ending}"
            )
        if path.resolve() in taken or path.exists():
            raise InputError(
                f"{option} {path}: there is a file already; expected a new name, because an issued "
                "certificate is not written over, so choose another one"
            )


def _certificate(
    joint: Path,
    session: Path,
    loads: Path | None,
    loads_map: tuple[str, ...],
    fluctuation: Path | None,
    fluctuation_map: tuple[str, ...],
) -> Certificate:
    from strainwave.certificate.building import build_certificate
    from strainwave.certificate.evidence import fluctuation_evidence, load_evidence
    from strainwave.certificate.session import read_session
    from strainwave.errors import InputError
    from strainwave.joint import read_joint

    known = read_joint(joint).joint
    told = read_session(session)
    for option, path, mapping in (
        ("--loads", loads, loads_map),
        ("--fluctuation", fluctuation, fluctuation_map),
    ):
        if mapping and path is None:
            raise InputError(
                f"{option}-map is given without {option}; expected both or neither, so add {option}"
            )
    return build_certificate(
        known,
        told,
        loads=None if loads is None else load_evidence(loads, loads_map, known),
        fluctuation=None
        if fluctuation is None
        else fluctuation_evidence(fluctuation, fluctuation_map, known),
    )


def _write(certificate: Certificate, out: Path, pdf: Path | None) -> None:
    from strainwave.atomic import write_atomically
    from strainwave.report.certificate import certificate_figures, certificate_page
    from strainwave.report.certificate_pdf import certificate_pdf

    figures = certificate_figures(certificate)
    page = certificate_page(certificate, figures).encode()
    # Both are there before either is written.
    document = None if pdf is None else certificate_pdf(certificate, figures)
    if pdf is not None and document is not None:
        write_atomically(pdf, document)
    try:
        write_atomically(out, page)
    except BaseException:
        if pdf is not None:
            pdf.unlink(missing_ok=True)
        raise


def _warnings(certificate: Certificate) -> Iterator[str]:
    loads = certificate.block.get("loads", {})
    error_percent = loads.get("largest_error_percent_of_rated_torque", 0.0)
    if error_percent > LARGEST_LIKELY_ERROR_PERCENT:
        yield (
            f"the joint file's torque differs from the loads of --loads by up to {error_percent:.3g} "
            "%FS: check --loads-map, its units, and whether these are this joint's loads"
        )


def _lines(certificate: Certificate, out: Path, pdf: Path | None) -> Iterator[str]:
    from strainwave.report.certificate import judged_text, number_text, wording

    block = certificate.block
    words = wording(block)
    written = str(out) if pdf is None else f"{out}, {pdf}"
    yield (
        f"{written}: certificate of joint {block['joint']['name']!r}, serial number "
        f"{block['joint']['serial']}"
    )
    if words["simulated_text"]:
        yield f"  {words['simulated_text']}"
    yield f"  {words['verdict_text']}"
    for each in block["judgements"]:
        value = judged_text(each["value"], each["limit"]) if "value" in each else "not known"
        unit = "" if each["unit"] == "1" else f" {each['unit']}"
        yield (
            f"  {each['verdict']:<12} {each['label']}: {value}{unit}, limit "
            f"{number_text(each['limit'])}"
        )
    if "loads" in block:
        error = block["loads"]["largest_error_percent_of_rated_torque"]
        yield f"  largest error of the readings in --loads: {number_text(error)} %FS"
    for each in block["checks"]:
        yield f"  {each['verdict']:<12} {each['what']}: {each['found']}"
    yield f"  joint file   {block['joint']['sha256']}"
    yield f"  certificate  {certificate.sha256}"
