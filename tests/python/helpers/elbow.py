"""The documented joint file, and what is needed to change it."""

from datetime import UTC, datetime
from pathlib import Path

from strainwave.joint import Gear, Provenance

FOLDER = Path(__file__).parents[2] / "data/joints"
TEXT = (FOLDER / "elbow.toml").read_text(encoding="utf-8")
NOON = datetime(2026, 12, 1, 12, tzinfo=UTC)
PROVENANCE = Provenance.by_hand(clock=lambda: NOON, version="0.2.0")
GEAR = Gear(configuration="fixed_flexspline", ratio=51, rated_torque_Nm=90)


def elbow(tmp_path: Path) -> Path:
    path = tmp_path / "elbow.toml"
    path.write_bytes(TEXT.encode())
    return path
