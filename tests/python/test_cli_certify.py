"""`strainwave certify` and `verify` from a simulated joint to a certificate, by their command lines."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from helpers.certified import SESSION
from helpers.elbow import TEXT, elbow
from strainwave.calibrate.fluctuation import fit_fluctuation
from strainwave.certificate.sealing import read_block
from strainwave.cli import main
from strainwave.joint import canonical_hash, read_joint, write_joint

EXAMPLE = Path(__file__).parents[2] / "examples/python/simulated_joint.py"


def refused(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    assert stop.value.code == 2
    message = capsys.readouterr().err
    assert "Traceback" not in message
    return message


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The documented sequence of commands, on the simulated joint of the examples."""
    spec = importlib.util.spec_from_file_location("simulated_joint", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    folder = tmp_path_factory.mktemp("demo") / "certified"
    module.make(folder)
    joint = str(folder / "joint.toml")
    main(
        [
            *("calibrate", "torque", str(folder / "loads.csv"), "--joint", joint, "--out", joint),
            *("--map", "load=load_Nm,voltage=bridge_V,experiment=run"),
            *("--map", "position=beta_deg:deg"),
        ]
    )
    main(
        [
            *("certify", joint, "--session", str(folder / "session.toml")),
            *("--loads", str(folder / "loads.csv")),
            *("--fluctuation", str(folder / "run.csv")),
            *("--out", str(folder / "certificate.html"), "--pdf", str(folder / "certificate.pdf")),
        ]
    )
    return folder


def test_the_demo_certificate(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    block = read_block(made / "certificate.html")
    assert block["data"] == "simulated"
    assert block["simulated_sections"] == ["gear"]
    assert block["verdict"] == "pass"
    calibration = read_joint(made / "joint.toml").joint.torque_calibration
    assert calibration is not None
    judged = {each["quantity"]: each["value"] for each in block["judgements"]}
    for key in ("linearity_error_percent_of_rated_torque", "hysteresis_percent_of_rated_torque"):
        assert judged[key] == getattr(calibration, key)
    # Read again with the joint file, the loads show the hysteresis that the calibration found.
    assert block["loads"]["hysteresis_percent_of_rated_torque"] == pytest.approx(
        calibration.hysteresis_percent_of_rated_torque, rel=2e-3
    )
    page = (made / "certificate.html").read_text("utf-8")
    assert page.count("<img") == 4
    assert (made / "certificate.pdf").read_bytes().startswith(b"%PDF-")
    capsys.readouterr()
    main(["verify", str(made / "joint.toml"), "--certificate", str(made / "certificate.html")])
    assert "SIM-0005, simulated data, verdict: pass" in capsys.readouterr().out


def test_fluctuation_before_and_after_is_that_of_the_sums(made: Path) -> None:
    told = read_block(made / "certificate.html")["fluctuation"]
    table = np.loadtxt(made / "run.csv", delimiter=",", skiprows=1)
    gains = read_joint(made / "joint.toml").joint.gains
    assert gains is not None
    weights = np.array(gains.gains)
    for name, weight in (("before_V", np.full(5, weights.mean())), ("after_V", weights)):
        # The sum as one signal, without the phasors of the gauges.
        summed = (table[:, 1:] @ weight)[:, np.newaxis]
        fit = fit_fluctuation(summed, table[:, 0], positions_rad=[0.0], harmonics=3)
        np.testing.assert_allclose(told[name], fit.amplitudes[:, 0], rtol=1e-5, atol=1e-9)
    assert told["after_V"][0] < 2 * told["standard_uncertainty_V"][0] < 0.01 * told["before_V"][0]


def test_errors_by_the_joint_file_follow_its_formula(made: Path) -> None:
    rows = np.genfromtxt(made / "loads.csv", delimiter=",", names=True)
    calibration = read_joint(made / "joint.toml").joint.torque_calibration
    assert calibration is not None
    assert not calibration.linearisation
    torque = calibration.gain_Nm_per_V * (rows["bridge_V"] - calibration.zero_V)
    largest = float(np.max(np.abs(torque - rows["load_Nm"])))
    told = read_block(made / "certificate.html")["loads"]
    assert told["largest_error_percent_of_rated_torque"] == pytest.approx(largest, rel=1e-9)


def test_one_changed_digit_fails(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (made / "joint.toml").read_text()
    place = text.index("gain_Nm_per_V = ") + len("gain_Nm_per_V = 6.7")
    digit = str((int(text[place]) + 1) % 10)
    changed = made / "changed.toml"
    changed.write_text(text[:place] + digit + text[place + 1 :])
    certificate = made / "certificate.html"
    message = refused(capsys, "verify", changed, "--certificate", certificate)
    assert "[torque_calibration] was changed" in message
    with pytest.raises(SystemExit):
        main(["verify", str(changed), "--certificate", str(certificate), "--json"])
    result = json.loads(capsys.readouterr().out)
    assert result["verified"] is False
    assert "[torque_calibration] was changed" in result["reason"]


def test_a_new_calibration_is_told_by_the_history(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    joint, loads = tmp_path / "joint.toml", tmp_path / "fewer.csv"
    joint.write_bytes((made / "joint.toml").read_bytes())
    rows = (made / "loads.csv").read_text().splitlines(keepends=True)
    loads.write_text("".join(row for row in rows if not row.startswith("5,")))
    main(
        [
            *("calibrate", "torque", str(loads), "--joint", str(joint), "--out", str(joint)),
            *("--map", "load=load_Nm,voltage=bridge_V,experiment=run"),
        ]
    )
    message = refused(capsys, "verify", joint, "--certificate", made / "certificate.html")
    assert "[torque_calibration] was changed; its history says [torque_calibration] rep" in message
    assert "from fewer.csv" in message
    (entry,) = read_joint(joint).joint.history or ()
    before = read_joint(made / "joint.toml").joint
    assert entry.previous_sha256 == canonical_hash(before)
    assert (entry.previous_input, entry.input) == ("loads.csv", "fewer.csv")


def test_json_of_both(made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    joint, out = made / "joint.toml", tmp_path / "again.html"
    capsys.readouterr()
    main(
        [
            *("certify", str(joint), "--session", str(made / "session.toml")),
            *("--out", str(out), "--json"),
        ]
    )
    block = json.loads(capsys.readouterr().out)
    digest = block.pop("certificate_sha256")
    assert block == read_block(out)
    assert digest in out.read_text("utf-8")
    main(["verify", str(joint), "--certificate", str(out), "--on", "2030-01-01", "--json"])
    result = json.loads(capsys.readouterr().out)
    assert result["verified"] is True
    assert result["joint_sha256"] == block["joint"]["sha256"]


def test_the_mapping_is_that_of_the_calibration(made: Path, tmp_path: Path) -> None:
    # [torque_calibration] keeps its command; certify took --map from there in the demo above.
    block = read_block(made / "certificate.html")
    roles = [each["role"] for each in block["inputs"]]
    assert "loads of the figures, that of the calibration" in roles


def test_bad_input(made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    joint, session = made / "joint.toml", made / "session.toml"
    out = tmp_path / "c.html"
    by_hand = made / "by-hand.toml"
    by_hand.write_text(TEXT)
    base = ("certify", joint, "--session", session, "--out", out)
    cases: list[tuple[tuple[object, ...], str]] = [
        (("certify", joint), "--session is missing"),
        (("certify", joint, "--session", session, "--out", tmp_path / "c.txt"), "ends in .html"),
        (("certify", joint, "--session", session, "--out", made / "certificate.html"), "already"),
        ((*base, "--pdf", tmp_path / "c.html"), "ends in .pdf"),
        ((*base, "--loads-map", "load=a"), "--loads-map is given without --loads"),
        (
            ("certify", by_hand, *base[2:], "--loads", made / "loads.csv"),
            "so add --loads-map",
        ),
        (
            (
                *base,
                "--fluctuation",
                made / "run.csv",
                "--fluctuation-map",
                "angle=beta_rad,gauges=g1_V",
            ),
            "1 gauges are mapped, but [gains] has 5",
        ),
        ((*base, "--loads", made / "run.csv"), "load_Nm"),
        (("certify", joint, "--template", tmp_path / "t.toml"), "--template alone"),
        (
            ("verify", joint, "--certificate", made / "certificate.html", "--on", "soon"),
            "YYYY-MM-DD",
        ),
        (("verify", joint, "--certificate", made / "certificate.pdf"), "and not the PDF"),
    ]
    for arguments, message in cases:
        assert message in refused(capsys, *arguments), arguments
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_left_where_a_file_cannot_be_written(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    message = refused(
        capsys,
        *("certify", made / "joint.toml", "--session", made / "session.toml"),
        *("--out", tmp_path / "none" / "c.html", "--pdf", tmp_path / "c.pdf"),
    )
    assert "cannot be written" in message
    assert list(tmp_path.iterdir()) == []


def test_a_template_is_written_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "session.toml"
    main(["certify", "--template", str(path)])
    assert path.read_text("utf-8").startswith("# Session of a calibration")
    assert "already" in refused(capsys, "certify", "--template", path)


def test_history_stands_on_the_certificate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = elbow(tmp_path)
    joint_file = read_joint(path)
    temperature = joint_file.joint.temperature
    assert temperature is not None
    assert temperature.provenance is not None
    later = temperature.provenance.model_copy(update={"input": "second.csv"})
    joint_file.set_section("temperature", temperature, later)
    write_joint(joint_file, path)
    session = tmp_path / "session.toml"
    session.write_text(SESSION)
    main(["joint", "check", str(path)])
    assert "temperature replaced, from second.csv (before: climate-chamber.csv)" in (
        capsys.readouterr().out
    )
    main(["joint", "check", str(path), "--json"])
    (entry,) = json.loads(capsys.readouterr().out)["history"]
    assert (entry["section"], entry["change"]) == ("temperature", "replaced")
    out = tmp_path / "c.html"
    main(["certify", str(path), "--session", str(session), "--out", str(out)])
    assert "[temperature] replaced</td><td>second.csv</td><td>climate-chamber.csv" in (
        out.read_text("utf-8")
    )
