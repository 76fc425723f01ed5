"""A joint with results and the session it was calibrated in, for certificates."""

from datetime import UTC, datetime
from pathlib import Path

from helpers.elbow import TEXT
from strainwave.certificate.building import Certificate, build_certificate
from strainwave.certificate.session import Session, read_session
from strainwave.joint import parse_joint
from strainwave.report.certificate import certificate_figures, certificate_page

ISSUED = datetime(2026, 12, 1, 12, tzinfo=UTC)
SESSION = """\
operator = "A. Example"
laboratory = "Bench <1> & more"
place = "here"
date = 2026-11-20
valid_until = 2027-11-30
data = "measured"
setup = "Weights on an arm of 1 m."

[environment]
temperature_degC = 20.5
temperature_uncertainty_K = 0.5

[[instruments]]
name = "weights"
serial = "W-17"
certificate = "M1"
calibrated_until = 2027-04-30

[limits]
linearity_error_percent_of_rated_torque = 1.5
hysteresis_percent_of_rated_torque = 0.4
consistency = 0.03
zero_drift_percent_of_rated_torque_per_K = 0.1
"""


def session_of(folder: Path, text: str = SESSION) -> Session:
    """Write a session file and read it."""
    path = folder / "session.toml"
    path.write_text(text, encoding="utf-8")
    return read_session(path)


def certificate_of(folder: Path, text: str = TEXT, session: str = SESSION) -> Certificate:
    """Certify a joint file's text."""
    return build_certificate(
        parse_joint(text).joint,
        session_of(folder, session),
        clock=lambda: ISSUED,
        version="0.2.0",
    )


def write_certificate(folder: Path, text: str = TEXT, session: str = SESSION) -> Path:
    """Write the joint file and its certificate."""
    (folder / "joint.toml").write_text(text, encoding="utf-8")
    certificate = certificate_of(folder, text, session)
    path = folder / "certificate.html"
    path.write_text(certificate_page(certificate, certificate_figures(certificate)), "utf-8")
    return path
