"""`strainwave identify --reference`: decisions in the joint file, and what the filter makes of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.accuracy.joint import FULL_SCALE_NM, WAVE_FACTOR
from helpers.log_files import command, read_result, write_csv, write_parquet
from helpers.reference_runs import Reference, reference_run
from strainwave.identify.moving_rows import moving_rows
from strainwave.identify.order_phasors import phasors_of
from strainwave.identify.orders import order_windows
from strainwave.identify.recording import CANDIDATES
from strainwave.joint import read_joint
from strainwave.joint.ripple_filter import RippleFilter

Call = Any
OPTIONS = ("--map", "time=t,angle=q,torque=tau", "--angle-side", "motor", "--ratio", 100)
SHARES = {2: 0.0, 4: 1.0, 6: 0.0}
UNDECIDABLE = "undecidable from this log"


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = reference_run(5, SHARES, Reference(delay_rows=0))
    rows = len(made.reference_Nm)
    columns = {
        "t": made.run.motion.time_s,
        "q": made.run.motor_angle_rad,
        "tau": made.run.measured_torque_Nm,
        "ref": made.reference_Nm,
        "turned": -1e3 * made.reference_Nm,
        "said": ["high"] * rows,
        "empty": np.full(rows, np.nan),
        "truth": made.true_torque_Nm,
    }
    return write_parquet(tmp_path_factory.mktemp("logs") / "run.parquet", columns)


def _amplitudes_Nm(log: Path, torque_Nm: np.ndarray) -> dict[float, float]:
    """Amplitude of every order, phase and all, mean over windows."""
    columns = read_result(log)
    rows = moving_rows(columns["t"], columns["q"], torque_Nm)
    windows = order_windows(rows.angle_rad)
    found = phasors_of(rows.angle_rad, rows.torque_Nm, windows, CANDIDATES, WAVE_FACTOR)
    # The first half is for learning.
    half = len(windows) // 2
    return {
        order: float(abs(np.mean(each.amplitude_Nm[each.window > half])))
        for order, each in found.items()
    }


def test_a_kept_order_passes_the_filter_and_the_others_do_not(
    tmp_path: Path, call: Call, log: Path
) -> None:
    file = tmp_path / "joint.toml"
    base = ("identify", log, *OPTIONS, "--rated-torque", FULL_SCALE_NM)
    ended = call(*base, "--reference", "ref", "--out", file, "--json")
    assert ended.code == 0
    orders = {each["order"]: each for each in ended.result["orders"]}
    assert {order: each["decision"] for order, each in orders.items()} == {
        2.0: "remove",
        4.0: "keep",
        6.0: "remove",
    }
    assert {each["basis"] for each in orders.values()} == {"reference"}
    assert orders[4.0]["torque_share"] == pytest.approx(1.0, abs=0.02)
    assert 1e-5 < orders[4.0]["torque_share_standard_uncertainty"] < 0.01
    assert orders[2.0]["artefact_Nm"] == pytest.approx(orders[2.0]["amplitude_Nm"], rel=0.05)
    assert orders[4.0]["torque_Nm"] == pytest.approx(orders[4.0]["amplitude_Nm"], rel=0.05)
    assert orders[4.0]["why_undecidable"] is None
    assert ended.result["reference"]["gain"] == pytest.approx(1.0, abs=1e-3)
    section = read_joint(file).joint.ripple_filter
    assert isinstance(section, RippleFilter)
    assert section.orders == ("2m", "4m", "6m")
    assert section.kept_orders == ("4m",)
    assert section.provenance is not None
    assert "--reference ref" in str(section.provenance.command)
    out = tmp_path / "clean.parquet"
    assert call("filter", log, "--joint", file, "--out", out).code == 0
    truth = _amplitudes_Nm(log, read_result(log)["truth"])
    clean = _amplitudes_Nm(log, read_result(out)["torque_Nm"])
    assert truth[4.0] > 0.6
    assert clean[4.0] == pytest.approx(truth[4.0], rel=0.02)
    assert max(clean[2.0], clean[6.0]) < 0.03


def test_the_table_names_share_and_decision(tmp_path: Path, call: Call, log: Path) -> None:
    mapping = ("--map", "reference-torque=-turned:mNm")
    ended = call("identify", log, *OPTIONS, *mapping, "--out", tmp_path / "j.toml")
    assert ended.code == 0
    lines = [line for line in ended.out.splitlines() if line.startswith("  order")]
    assert [line.rsplit(": ", 1)[1] for line in lines] == ["remove", "keep", "remove"]
    assert all("torque's share" in line and "by reference" in line for line in lines)


def test_a_minus_turns_the_reference_round(tmp_path: Path, call: Call, log: Path) -> None:
    base = ("identify", log, *OPTIONS, "--json")
    right = call(*base, "--reference", "-turned:mNm", "--out", tmp_path / "a.toml")
    assert right.code == 0
    assert right.result["reference"]["gain"] == pytest.approx(1.0, abs=1e-3)
    wrong = call(*base, "--reference", "turned", "--out", tmp_path / "b.toml")
    assert wrong.code == 0
    assert "reads -1e+03 of the measured torque" in wrong.err
    assert "check its unit and sign" in wrong.err
    assert {each["decision"] for each in wrong.result["orders"]} == {UNDECIDABLE}
    section = read_joint(tmp_path / "b.toml").joint.ripple_filter
    assert isinstance(section, RippleFilter)
    assert section.kept_orders == ()


def test_without_a_reference_an_earlier_decision_stays(
    tmp_path: Path, call: Call, log: Path
) -> None:
    file = tmp_path / "joint.toml"
    given = (*OPTIONS, "--rated-torque", FULL_SCALE_NM)
    assert call("identify", log, *given, "--reference", "ref", "--out", file).code == 0
    ended = call("identify", log, "--joint", file, "--out", file, "--json")
    assert ended.code == 0
    assert {each["decision"] for each in ended.result["orders"]} == {UNDECIDABLE}
    assert ended.result["orders"][0]["torque_share"] is None
    assert ended.result["orders"][0]["basis"] is None
    assert ended.result["reference"] is None
    assert ended.err.count("torque or artefact") == 1
    assert "(--reference COLUMN) decides it" in ended.err
    assert 'order "4m" stays kept, as the joint file has it' in ended.err
    section = read_joint(file).joint.ripple_filter
    assert isinstance(section, RippleFilter)
    assert section.kept_orders == ("4m",)


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        ("reff", "there is no column 'reff' for reference-torque; expected the name of one of its"),
        ("tau", "column 'tau' is mapped for torque and for reference-torque"),
        ("-tau", "column 'tau' is mapped for torque and for reference-torque"),
        ("said", "column 'said' for reference-torque holds text"),
        ("empty", "column 'empty' for reference-torque holds no number in the first"),
        ("ref:kg", "--reference ref:kg: the unit 'kg' of reference-torque is unknown; expected"),
        ("ref,speed=w", "--reference ref,speed=w: it names more than one column"),
        ("", "--reference : no column follows reference-torque="),
    ],
)
def test_a_bad_reference_is_refused(
    tmp_path: Path, call: Call, log: Path, reference: str, said: str
) -> None:
    file = tmp_path / "j.toml"
    ended = call("identify", log, *OPTIONS, "--reference", reference, "--out", file)
    assert ended.code == 2
    assert said in ended.err
    assert "Traceback" not in ended.err
    assert not file.exists()


def test_a_reference_is_named_once_and_by_identify_alone(
    tmp_path: Path, call: Call, log: Path
) -> None:
    twice = ("--map", "reference-torque=ref", "--reference", "ref")
    ended = call("identify", log, *OPTIONS, *twice, "--out", tmp_path / "j.toml")
    assert ended.code == 2
    assert "reference-torque is mapped by --map as well" in ended.err
    other = ("filter", log, *OPTIONS, "--map", "reference-torque=ref")
    ended = call(*other, "--out", tmp_path / "o.parquet")
    assert ended.code == 2
    assert "'reference-torque' is no signal" in ended.err


def test_text_in_a_csv_column_is_found_by_its_row(tmp_path: Path, call: Call) -> None:
    t = np.arange(50) * 1e-3
    references: list[Any] = [0.5] * 50
    references[20] = "over"
    log = write_csv(
        tmp_path / "a.csv", {"t": t, "q": 10 * t, "tau": np.sin(20 * t), "ref": references}
    )
    ended = call("identify", log, *OPTIONS, "--reference", "ref", "--out", tmp_path / "j.toml")
    assert ended.code == 2
    assert "'over'" in ended.err
    assert "22" in ended.err
    assert not (tmp_path / "j.toml").exists()
