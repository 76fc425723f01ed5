"""The certificate's block: everything it says as plain values, and the hash over them."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

from strainwave.certificate.judging import (
    COVERAGE_FACTOR,
    instrument_checks,
    judgements,
    overall,
)
from strainwave.certificate.results import results_of
from strainwave.errors import InputError
from strainwave.joint import SECTION_NAMES, canonical_hash, canonical_json, section_hash
from strainwave.joint.provenance import strainwave_version, utc_now

if TYPE_CHECKING:
    from strainwave.certificate.evidence import FluctuationEvidence, LoadEvidence, Source
    from strainwave.certificate.session import Session
    from strainwave.joint import Joint
    from strainwave.joint.provenance import Clock

#: Raised when the keys of the block change their meaning.
FORMAT: Final = 1


@dataclass(frozen=True)
class Certificate:
    """What a certificate says, and what its figures are drawn from.

    Attributes
    ----------
    block : dict
        Plain values, as they stand in the certificate for programs.
    loads : LoadEvidence or None
        Readings under known loads.
    fluctuation : FluctuationEvidence or None
        Gauges against the wave's angle.
    """

    block: dict[str, Any]
    loads: LoadEvidence | None
    fluctuation: FluctuationEvidence | None

    @property
    def sha256(self) -> str:
        """Hash of the block, 64 hexadecimal digits."""
        return block_hash(self.block)


def block_hash(block: dict[str, Any]) -> str:
    """Return the SHA-256 of a block in the canonical form of RFC 8785.

    Parameters
    ----------
    block : dict
        Plain values.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    return hashlib.sha256(canonical_json(block).encode("utf-8")).hexdigest()


def build_certificate(
    joint: Joint,
    session: Session,
    *,
    loads: LoadEvidence | None = None,
    fluctuation: FluctuationEvidence | None = None,
    clock: Clock = utc_now,
    version: str | None = None,
) -> Certificate:
    """Put together what a certificate says.

    Parameters
    ----------
    joint : Joint
        The joint; it has a serial number and a section besides ``[joint]``.
    session : Session
        Who, where, with what, against which limits.
    loads, fluctuation : LoadEvidence, FluctuationEvidence, optional
        Recordings read again with the joint file.
    clock : callable, optional
        Returns the time of issue, with time zone.
    version : str, optional
        Version of strainwave; the installed one by default.

    Returns
    -------
    Certificate

    Raises
    ------
    InputError
        If the joint has no serial number, or there is nothing to certify.
    """
    if joint.identity.serial is None:
        raise InputError(
            f'joint "{joint.identity.name}": [joint] has no serial; expected the serial number that '
            "the certificate is for, so add it"
        )
    results = results_of(joint)
    if not results:
        raise InputError(
            f'joint "{joint.identity.name}": it has no section with results; expected at least one '
            "to certify, so calibrate first"
        )
    judged, checks = judgements(joint, session, loads), instrument_checks(session)
    told = _simulated_sections(joint)
    issued = clock()
    block: dict[str, Any] = {
        "format": FORMAT,
        "issued_at": issued,
        "software": {
            "name": "strainwave",
            "version": strainwave_version() if version is None else version,
        },
        "joint": _joint(joint),
        "data": "simulated" if told or session.data == "simulated" else session.data,
        "simulated_sections": told,
        "session": session.model_dump(mode="json", by_alias=True, exclude_none=True),
        "inputs": _inputs(joint, loads, fluctuation),
        "results": [_result(asdict(each)) for each in results],
        "judgements": [_present(asdict(each)) for each in judged],
        "checks": [asdict(each) for each in checks],
        "coverage_factor": COVERAGE_FACTOR,
        "verdict": overall(judged, checks),
    }
    block["issued_at"] = f"{issued:%Y-%m-%dT%H:%M:%SZ}"
    if loads is not None:
        block["loads"] = _loads(loads)
    if fluctuation is not None:
        block["fluctuation"] = _fluctuation(fluctuation)
    return Certificate(block, loads, fluctuation)


def _present(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None}


def _result(values: dict[str, Any]) -> dict[str, Any]:
    return {key: list(item) if isinstance(item, tuple) else item for key, item in values.items()}


def _simulated_sections(joint: Joint) -> list[str]:
    return [
        name
        for name in SECTION_NAMES
        if (section := getattr(joint, name)) is not None
        and section.provenance.input.lower().startswith("simulated")
    ]


def _joint(joint: Joint) -> dict[str, Any]:
    sections = {}
    for name in SECTION_NAMES:
        section = getattr(joint, name)
        if section is not None:
            provenance = section.provenance
            sections[name] = _present(
                {
                    "sha256": section_hash(joint, name),
                    "input": provenance.input,
                    "input_sha256": provenance.input_sha256,
                    "created": f"{provenance.created:%Y-%m-%dT%H:%M:%SZ}",
                    "version": provenance.version,
                    "command": provenance.command,
                }
            )
    history = [
        _present(
            {
                "section": entry.section,
                "change": entry.change,
                "changed_at": f"{entry.changed_at:%Y-%m-%dT%H:%M:%SZ}",
                "input": entry.input,
                "input_sha256": entry.input_sha256,
                "previous_input": entry.previous_input,
                "previous_sha256": entry.previous_sha256,
            }
        )
        for entry in joint.history or ()
    ]
    return _present(
        {
            "name": joint.identity.name,
            "serial": joint.identity.serial,
            "notes": joint.identity.notes,
            "sha256": canonical_hash(joint),
            "sections": sections,
            "history": history,
        }
    )


def _inputs(
    joint: Joint, loads: LoadEvidence | None, fluctuation: FluctuationEvidence | None
) -> list[dict[str, Any]]:
    inputs = []
    for name in SECTION_NAMES:
        section = getattr(joint, name)
        if section is not None:
            provenance = section.provenance
            inputs.append(
                _present(
                    {
                        "role": f"[{name}]",
                        "name": provenance.input,
                        "sha256": provenance.input_sha256,
                    }
                )
            )
    given: list[tuple[str, Source]] = []
    if loads is not None:
        given.append(("loads of the figures", loads.source))
    if fluctuation is not None:
        given.append(("gauges of the figures", fluctuation.source))
    for role, source in given:
        whose = "that of the calibration" if source.is_the_calibrations else "another recording"
        inputs.append({"role": f"{role}, {whose}", "name": source.name, "sha256": source.sha256})
    return inputs


def _loads(loads: LoadEvidence) -> dict[str, Any]:
    return _present(
        {
            "readings": len(loads.loadings),
            "experiments": len(loads.loadings.names),
            "largest_error_percent_of_rated_torque": loads.largest_error_percent,
            "hysteresis_percent_of_rated_torque": loads.largest_hysteresis_percent,
        }
    )


def _fluctuation(found: FluctuationEvidence) -> dict[str, Any]:
    return {
        "harmonics": list(range(1, len(found.phasors) + 1)),
        "before_V": [float(value) for value in found.before_V],
        "after_V": [float(value) for value in found.after_V],
        "standard_uncertainty_V": [float(value) for value in found.standard_uncertainty_V],
    }
