"""`strainwave verify`: whether a joint file is the one that a certificate was issued for."""

from __future__ import annotations

from datetime import date, datetime
from pathlib import Path


def verify(joint: Path, /, *, certificate: Path, on: str | None = None, json: bool = False) -> None:
    """Refuse a joint file that is not the one a certificate was issued for.

    Example: strainwave verify joint.toml --certificate certificate.html

    Parameters
    ----------
    joint : Path
        The joint file.
    certificate : Path
        The certificate: the .html that `strainwave certify` wrote.
    on : str
        The day that a stated validity is held against, YYYY-MM-DD; today without.
    json : bool
        Print the result as JSON, a refusal too.
    """
    from strainwave.certificate.verifying import verify_certificate
    from strainwave.cli.output import print_json, result_console
    from strainwave.errors import InputError

    day = _day(on)
    try:
        block = verify_certificate(joint, certificate, on=day)
    except InputError as error:
        if json:
            print_json({"verified": False, "reason": str(error), "on": day.isoformat()})
        raise
    about = block["joint"]
    until = block["session"].get("valid_until")
    if json:
        print_json(
            {
                "verified": True,
                "name": about["name"],
                "serial": about["serial"],
                "joint_sha256": about["sha256"],
                "issued_at": block["issued_at"],
                "valid_until": until,
                "on": day.isoformat(),
                "verdict": block["verdict"],
                "data": block["data"],
            }
        )
        return
    held = "" if until is None else f", valid until {until}"
    result_console().print(
        f"{joint}: is the joint file that {certificate} was issued for on {block['issued_at']} "
        f"(serial number {about['serial']}, {block['data']} data, verdict: {block['verdict']}{held})",
        soft_wrap=True,
        markup=False,
    )


def _day(text: str | None) -> date:
    from strainwave.errors import InputError

    if text is None:
        return datetime.now().astimezone().date()
    try:
        return date.fromisoformat(text)
    except ValueError as error:
        raise InputError(
            f"--on {text}: expected a day as YYYY-MM-DD, such as 2026-11-30; correct this value"
        ) from error
