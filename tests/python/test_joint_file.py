"""Joint files keep what people wrote, and change only what they are told to."""

import hashlib
import pickle
from datetime import UTC, datetime
from pathlib import Path

import pytest
from tomlkit import TOMLDocument

from helpers.elbow import FOLDER, GEAR, NOON, PROVENANCE, TEXT, elbow
from strainwave.errors import ConfigurationError, InputError
from strainwave.joint import (
    Gains,
    Gauges,
    Joint,
    Misalignment,
    MisalignmentTerm,
    Provenance,
    Rosette,
    Temperature,
    build_section,
    editing,
    new_joint,
    parse_joint,
    read_joint,
    write_joint,
)


def test_the_example_is_read_as_written() -> None:
    joint = read_joint(FOLDER / "elbow.toml").joint
    assert joint.gear is not None
    assert joint.gear.ratio == 51.0
    assert joint.signals is not None
    assert joint.signals.motor_angle is not None
    assert joint.signals.motor_angle.unit == "counts/16777216"
    assert joint.gauges is not None
    assert joint.gauges.rosettes[1].orientation_error_rad == -0.02
    assert joint.gains is not None
    assert joint.gains.provenance is not None
    assert joint.gains.provenance.created == datetime(2026, 11, 2, 13, 5, tzinfo=UTC)
    assert joint.identity.notes is not None
    assert joint.identity.notes.endswith("film.")


def test_sections_are_optional() -> None:
    joint = read_joint(FOLDER / "named_only.toml").joint
    assert joint.model_dump(by_alias=True, exclude_none=True) == {"joint": {"name": "wrist"}}


def test_reading_and_writing_changes_no_byte(tmp_path: Path) -> None:
    path = elbow(tmp_path)
    write_joint(read_joint(path), path)
    assert path.read_bytes() == TEXT.encode()


def test_only_changed_lines_change_when_a_section_is_set() -> None:
    joint_file = parse_joint(TEXT)
    joint = joint_file.joint
    assert joint.gear is not None
    new_gear = joint.gear.model_copy(update={"rated_torque_Nm": 90.0})
    joint_file.set_section("gear", new_gear, PROVENANCE)
    text, _, history = joint_file.text().partition("[[history]]")
    assert 'section = "gear"' in history
    before, after = TEXT.splitlines(), text.splitlines()
    assert [line for line in after if line not in before] == [
        "rated_torque_Nm = 90.0               # data sheet",
        "output_direction = 1",
        "created = 2026-12-01T12:00:00Z",
        'version = "0.2.0"',
    ]
    gone = [line for line in before if line not in after]
    assert gone == ["rated_torque_Nm = 100               # data sheet", *gone[1:]]
    assert set(gone[1:]) == {"created = 2026-11-01T08:30:00Z"}
    assert "ratio = 51" in after
    assert joint_file.joint.gear == new_gear.model_copy(update={"provenance": PROVENANCE})


def test_comments_in_lists_of_tables_stay_when_one_value_changes() -> None:
    joint_file = parse_joint(TEXT)
    gauges = joint_file.joint.gauges
    assert gauges is not None
    rosettes = list(gauges.rosettes)
    rosettes[1] = rosettes[1].model_copy(update={"orientation_error_rad": -0.03})
    changed = gauges.model_copy(update={"rosettes": tuple(rosettes)})
    joint_file.set_section("gauges", changed, PROVENANCE)
    assert "orientation_error_rad = -0.03       # visible under the microscope" in joint_file.text()


def test_lists_of_tables_can_grow_and_shrink() -> None:
    for count in (1, 2, 5):
        joint_file = parse_joint(TEXT)
        joint_file.remove_section("gains")
        signals = joint_file.joint.signals
        assert signals is not None
        joint_file.set_section("signals", signals.model_copy(update={"gauges": ()}), PROVENANCE)
        rosettes = tuple(Rosette(position_rad=0.1 * j, gauge_factor=2.0) for j in range(count))
        gauges = Gauges(
            wiring="half_bridge_each", bridge_supply_V=5, amplifier_gain=1, rosettes=rosettes
        )
        joint_file.set_section("gauges", gauges, PROVENANCE)
        again = parse_joint(joint_file.text()).joint
        assert again.gauges == gauges.model_copy(update={"provenance": PROVENANCE})
        assert "# Elbow joint of the test arm" in joint_file.text()


@pytest.mark.parametrize(
    "section",
    [
        (
            "gear.configuration = 'fixed_flexspline' # mine\ngear.ratio = 2\ngear.rated_torque_Nm = 3\n"
            "gear.provenance = {input='a', created=2026-11-01T08:30:00Z, version='1'}\n"
            "[joint]\nname = 'a'\n"
        ),
        (
            "gear = {configuration = 'fixed_flexspline', ratio = 2, rated_torque_Nm = 3, "
            "provenance = {input='a', created=2026-11-01T08:30:00Z, version='1'}}\n"
            "[joint]\nname = 'a'\n"
        ),
        (
            "[gear.provenance]\ninput='a'\ncreated=2026-11-01T08:30:00Z\nversion='1'\n[joint]\n"
            "name = 'a'\n[gear]\nconfiguration = 'fixed_flexspline'\nratio = 2\nrated_torque_Nm = 3\n"
        ),
        (
            "[gear]\nconfiguration = 'fixed_flexspline'\nratio = 2\nrated_torque_Nm = 3\n"
            "[joint]\nname = 'a'\n"
            "[gear.provenance]\ninput='a'\ncreated=2026-11-01T08:30:00Z\nversion='1'\n"
        ),
    ],
    ids=["dotted", "inline", "provenance first", "apart"],
)
def test_every_layout_of_toml_can_be_edited(section: str) -> None:
    joint_file = parse_joint("schema_version = 1\n" + section)
    assert joint_file.joint.gear is not None
    assert joint_file.joint.gear.ratio == 2.0
    joint_file.set_section("gear", GEAR, PROVENANCE)
    drift = Temperature(
        reference_temperature_degC=20.0, zero_drift_V_per_K=1e-7, gain_drift_per_K=0.0
    )
    joint_file.set_section("temperature", drift, PROVENANCE)
    again = parse_joint(joint_file.text()).joint
    assert again == joint_file.joint
    assert again.gear == GEAR.model_copy(update={"provenance": PROVENANCE})
    joint_file.remove_section("gear")
    again = parse_joint(joint_file.text()).joint
    assert again.gear is None
    assert again.temperature is not None
    assert again.identity.name == "a"


def test_a_layout_that_cannot_be_edited_in_place_is_written_anew() -> None:
    # Dotted keys below a section of which one goes: the TOML library gives up on these.
    start, end = TEXT.index("[temperature.provenance]"), len(TEXT)
    dotted = "".join(
        f"provenance.{line}\n" for line in TEXT[start:end].splitlines()[1:] if "=" in line
    )
    joint_file = parse_joint(TEXT[:start] + dotted)
    assert joint_file.joint == parse_joint(TEXT).joint
    temperature = joint_file.joint.temperature
    assert temperature is not None
    joint_file.set_section("temperature", temperature, PROVENANCE)
    again = parse_joint(joint_file.text()).joint
    assert again == joint_file.joint
    assert again.temperature == temperature.model_copy(update={"provenance": PROVENANCE})
    assert "# Elbow joint of the test arm" in joint_file.text()


@pytest.mark.parametrize("failure", ["raises", "changes the wrong value"])
def test_only_what_is_read_back_right_is_kept(
    monkeypatch: pytest.MonkeyPatch, failure: str
) -> None:
    def wrong_edit(document: TOMLDocument, *_: object) -> None:
        if failure == "raises":
            raise IndexError
        document["gear"]["ratio"] = 3.0

    joint_file = parse_joint(TEXT, "elbow.toml")
    joint = joint_file.joint
    monkeypatch.setattr(editing, "set_in_place", wrong_edit)
    with monkeypatch.context() as context:
        context.setattr(editing, "set_anew", wrong_edit)
        with pytest.raises(InputError, match=r"elbow.toml: \[gear\] cannot be edited"):
            joint_file.set_section("gear", GEAR, PROVENANCE)
    assert joint_file.joint == joint
    assert joint_file.text() == TEXT
    joint_file.set_section("gear", GEAR, PROVENANCE)
    assert joint_file.joint == parse_joint(joint_file.text()).joint
    assert joint_file.joint.gear == GEAR.model_copy(update={"provenance": PROVENANCE})


def test_a_change_that_would_contradict_the_rest_changes_nothing() -> None:
    joint_file = parse_joint(TEXT, "elbow.toml")
    joint = joint_file.joint
    with pytest.raises(InputError, match=r"elbow.toml: \[gains\] has 2 gains, but \[gauges\] has"):
        joint_file.set_section("gains", Gains(gains=(1.0, 1.0)), PROVENANCE)
    with pytest.raises(InputError, match=r"elbow.toml: \[torque_calibration\] has a linearisation"):
        joint_file.remove_section("gear")
    assert joint_file.text() == TEXT
    assert joint_file.joint == joint


def test_a_section_takes_its_own_model_only() -> None:
    joint_file = new_joint("a")
    with pytest.raises(TypeError, match=r"section \[gains\]: expected Gains, got Gear"):
        joint_file.set_section("gains", GEAR, PROVENANCE)
    with pytest.raises(InputError, match=r"\[joint\] is not a section that can be filled"):
        joint_file.set_section("joint", GEAR, PROVENANCE)
    with pytest.raises(InputError, match=r'\[geer\].*did you mean "gear"'):
        joint_file.remove_section("geer")


def test_the_document_handed_out_is_a_copy() -> None:
    joint_file = parse_joint(TEXT)
    joint_file.document["gear"]["ratio"] = -1.0
    assert joint_file.text() == TEXT


def test_values_from_a_person_make_a_section() -> None:
    values = {"configuration": "fixed_flexspline", "ratio": 51, "rated_torque_Nm": 90}
    assert build_section("gear", values, "command line") == GEAR
    terms = [{"cycles_per_output_turn": 1, "cosine_Nm": 1, "sine_Nm": 2.5}]
    term = MisalignmentTerm(cycles_per_output_turn=1, cosine_Nm=1.0, sine_Nm=2.5)
    assert build_section("misalignment", {"terms": terms}, "page") == Misalignment(terms=(term,))


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_line_ends_are_kept(tmp_path: Path, mark: bytes) -> None:
    path = tmp_path / "elbow.toml"
    path.write_bytes(mark + TEXT.replace("\n", "\r\n").encode())
    joint_file = read_joint(path)
    assert joint_file.joint == parse_joint(TEXT).joint
    joint_file.set_section("gear", GEAR, PROVENANCE)
    write_joint(joint_file, path)
    content = path.read_bytes()
    assert content.count(b"\n") == content.count(b"\r\n") > 100
    assert read_joint(path).joint == joint_file.joint


def test_provenance_of_a_file(tmp_path: Path) -> None:
    recording = tmp_path / "log.csv"
    content = bytes(range(256)) * 10_000  # more than two chunks
    recording.write_bytes(content)
    provenance = Provenance.of_file(
        recording, command="strainwave identify log.csv", clock=lambda: NOON, version="0.2.0"
    )
    assert provenance == Provenance(
        input="log.csv",
        input_sha256=hashlib.sha256(content).hexdigest(),
        created=NOON,
        version="0.2.0",
        command="strainwave identify log.csv",
    )
    with pytest.raises(InputError, match=r"none.csv: cannot be read .*\(no such file"):
        Provenance.of_file(tmp_path / "none.csv")


def test_provenance_of_other_sources() -> None:
    assert PROVENANCE.input == "entered by hand"
    assert Provenance.of_preset("taghirad").input == "preset taghirad"
    simulated = Provenance.of_simulation("free motion, seed 7")
    assert simulated.input == "simulated free motion, seed 7"
    assert abs((simulated.created - datetime.now(UTC)).total_seconds()) < 60.0
    assert simulated.version


def test_errors_survive_being_passed_between_processes() -> None:
    error = ConfigurationError("ratio", 0.5, "", "a number from 1", "look it up")
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error) == "ratio = 0.5: expected a number from 1; look it up"
    assert copy.allowed == "a number from 1"


def test_a_new_joint_is_a_joint() -> None:
    joint_file = new_joint("elbow", serial="7", notes="two\nlines")
    assert joint_file.text().startswith("schema_version = 1\n\n[joint]\n")
    assert joint_file.joint == Joint.model_validate(
        {"joint": {"name": "elbow", "serial": "7", "notes": "two\nlines"}}
    )
