"""`strainwave export`: files out, or one sentence; `--check` proves that header and joint agree."""

from __future__ import annotations

import json
import random
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from helpers.elbow import FOLDER
from helpers.exported_joints import ROOT, WRIST, random_joint
from helpers.log_files import command
from strainwave.errors import InputError
from strainwave.export import check_header, exported, joint_identifier, rendered, write_source
from strainwave.joint import Joint, canonical_hash, parse_joint

Call = Any
TEXT = WRIST.read_text(encoding="utf-8")
HEADER = WRIST.with_suffix(".hpp").read_text(encoding="utf-8")


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _joint(tmp_path: Path, text: str = TEXT) -> Path:
    path = tmp_path / "wrist.toml"
    path.write_text(text, encoding="utf-8")
    return path


def _without_section(name: str) -> str:
    """The wrist's file without a section and its parts."""
    kept, is_kept = [], True
    for line in TEXT.splitlines():
        if line.startswith("["):
            is_kept = line.strip("[]").split(".")[0] != name
        if is_kept:
            kept.append(line)
    return "\n".join(kept)


def test_export_and_check(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path)
    ended = call("export", joint, "--out", tmp_path, "--json")
    assert ended.code == 0, ended.err
    result = ended.result
    header = tmp_path / "wrist.hpp"
    assert result["header"] == str(header)
    assert result["hash"] == canonical_hash(parse_joint(TEXT).joint)
    assert result["checksum"] in header.read_text(encoding="utf-8").lower()
    assert (result["gauges"], result["pairs"], result["precision"]) == (4, 5, "float")
    assert result["has_learned"]
    assert result["has_monitor"]
    assert {Path(file).name for file in result["files"]} == {
        *("wrist.hpp", "strainwave_joint.h", "strainwave_joint.cpp"),
    }
    ended = call("export", joint, "--check", header, "--json")
    assert ended.code == 0
    assert ended.result["result"] == "agrees"
    assert len(ended.result["files"]) == 3
    ended = call("export", joint, "--out", tmp_path)
    assert ended.code == 0
    assert "4 gauges, ripple filter with 5 pairs, a gauge monitor, with learned" in ended.out
    # Comments and layout of the joint file are no values.
    _joint(tmp_path, "# another comment\n" + TEXT.replace("= 40.0", "= 40"))
    assert call("export", joint, "--check", header).code == 0


def test_precision_and_name(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path)
    given = ("--precision", "double", "--name", "left_wrist_2")
    assert call("export", joint, "--out", tmp_path, *given).code == 0
    header = tmp_path / "left_wrist_2.hpp"
    text = header.read_text(encoding="utf-8")
    assert "using Real = double;" in text
    assert "namespace strainwave::joints::left_wrist_2 {" in text
    # The joint file's own digits: doubles lose none of them.
    assert ".values = {0.934920607, 1.01374809, 1.06306746, 0.988263841}" in text
    assert call("export", joint, "--check", header).code == 0
    ended = call("export", joint, "--check", header, "--precision", "float")
    assert ended.code == 2
    assert "using Real = double" in ended.err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("zero_V = 0.0735", "zero_V = 0.0736"), "one of them was changed"),
        (('input = "made up', 'input = "made out'), "the joint file's hash is"),
        (("memory_turns = 30", "memory_turns = 31"), "the joint file's hash is"),
    ],
)
def test_a_changed_joint_file_is_refused(
    tmp_path: Path, call: Call, change: tuple[str, str], words: str
) -> None:
    joint = _joint(tmp_path)
    call("export", joint, "--out", tmp_path)
    _joint(tmp_path, TEXT.replace(*change))
    ended = call("export", joint, "--check", tmp_path / "wrist.hpp")
    assert ended.code == 2
    assert words in ended.err
    assert "export the joint again" in ended.err


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_digit_of_the_header_counts(data: st.DataObject) -> None:
    places = [place for place, sign in enumerate(HEADER) if sign.isdigit()]
    place = data.draw(st.sampled_from(places))
    digit = data.draw(st.sampled_from("0123456789").filter(lambda sign: sign != HEADER[place]))
    changed = HEADER[:place] + digit + HEADER[place + 1 :]
    joint = parse_joint(TEXT).joint
    with (
        _file("wrist.hpp", changed) as header,
        pytest.raises(InputError, match=r"expected|changed"),
    ):
        check_header(joint, header)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_digit_of_the_joint_file_counts(data: st.DataObject) -> None:
    bare = "\n".join(line.partition("#")[0] for line in TEXT.splitlines())
    places = [place for place, sign in enumerate(bare) if sign.isdigit()]
    place = data.draw(st.sampled_from(places))
    digit = data.draw(st.sampled_from("0123456789").filter(lambda sign: sign != bare[place]))
    try:
        joint = parse_joint(bare[:place] + digit + bare[place + 1 :]).joint
    except InputError:
        return  # refused already, with its own sentence
    assume(canonical_hash(joint) != canonical_hash(parse_joint(TEXT).joint))  # a digit too many
    with pytest.raises(InputError):
        check_header(joint, WRIST.with_suffix(".hpp"))


class _file:  # noqa: N801 - used like a function
    """A file in a folder of its own, for tests that hypothesis repeats."""

    def __init__(self, name: str, text: str) -> None:
        from tempfile import TemporaryDirectory  # noqa: PLC0415

        self.folder, self.name, self.text = TemporaryDirectory(), name, text

    def __enter__(self) -> Path:
        path = Path(self.folder.name) / self.name
        path.write_text(self.text, encoding="utf-8")
        return path

    def __exit__(self, *_: object) -> None:
        self.folder.cleanup()


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.integers(0, 2**32), st.sampled_from(["float", "double"]))
def test_any_joint_exports_and_agrees(seed: int, precision: Any) -> None:
    joint = random_joint(random.Random(seed))
    source = rendered(exported(joint, precision=precision))
    with _file("any.hpp", "") as header:
        header.unlink()
        paths = write_source(source, header.parent)
        assert paths[0] == header
        agreement = check_header(joint, header)
        assert len(agreement.files) == 3
        assert agreement.joint.precision == precision
        # As an editor of another system would save it.
        header.write_bytes(source.header.replace("\n", "\r\n").encode())
        check_header(joint, header)
        other = joint.model_copy(
            update={"identity": joint.identity.model_copy(update={"serial": "another"})}
        )
        with pytest.raises(InputError, match="hash"):
            check_header(other, header)


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("ripple_filter", "there is no section [ripple_filter]"),
        ("gear", "[gear]"),
        ("gauges", "there is no section [gauges]"),
        ("torque_calibration", "there is no section [torque_calibration]"),
        ("signals", "there is no section [signals]"),
    ],
)
def test_a_joint_that_lacks_something(tmp_path: Path, call: Call, section: str, words: str) -> None:
    joint = _joint(tmp_path, _without_section(section))
    before = sorted(tmp_path.iterdir())
    ended = call("export", joint, "--out", tmp_path)
    assert ended.code == 2
    assert words in ended.err
    assert str(joint) in ended.err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "expected either --out DIR"),
        (("--out", "{}", "--check", "{}/wrist.hpp"), "expected either --out DIR"),
        (("--out", "{}/none"), "there is no such folder"),
        (("--out", "{}/wrist.toml"), "there is no such folder"),
        (("--check", "{}/none.hpp"), "there is no such file"),
        (("--check", "{}"), "it cannot be read as text"),
        (("--check", "{}/wrist.toml"), "it is no header of strainwave export"),
        (("--check", "{}/latin.hpp"), "it cannot be read as text"),
        (("--out", "{}", "--name", "left wrist"), "no name for a C++ namespace"),
        (("--out", "{}", "--name", "class"), "no name for a C++ namespace"),
        (("--out", "{}", "--name", "_wrist"), "no name for a C++ namespace"),
        (("--out", "{}", "--name", "../wrist"), "no name for a C++ namespace"),
        (("--out", "{}", "--name", "wrist__2"), "no name for a C++ namespace"),
        (("--out", "{}", "--name", ""), "no name for a C++ namespace"),
        (("--out", "{}", "--precision", "half"), "half"),
    ],
)
def test_what_is_refused(tmp_path: Path, call: Call, options: tuple[str, ...], words: str) -> None:
    joint = _joint(tmp_path)
    (tmp_path / "latin.hpp").write_bytes("grün".encode("latin-1"))
    before = sorted(tmp_path.iterdir())
    ended = call("export", joint, *(option.format(tmp_path) for option in options))
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert ended.out == ""
    assert sorted(tmp_path.iterdir()) == before


def test_a_file_of_one_s_own_is_not_replaced(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path)
    own = tmp_path / "strainwave_joint.h"
    own.write_text("// mine\n#define A 1\n", encoding="utf-8")
    ended = call("export", joint, "--out", tmp_path)
    assert ended.code == 2
    assert "was not written by strainwave export" in ended.err
    assert own.read_text(encoding="utf-8") == "// mine\n#define A 1\n"
    assert not (tmp_path / "wrist.hpp").exists()


def test_no_file_and_a_filter_alone(tmp_path: Path, call: Call) -> None:
    ended = call("export", tmp_path / "none.toml", "--out", tmp_path)
    assert ended.code == 2
    assert "none.toml" in ended.err
    ended = call("export", FOLDER / "shoulder.toml", "--out", tmp_path)
    assert ended.code == 2
    assert "there is no section [gauges]" in ended.err


def test_a_name_that_is_no_identifier_asks_for_one(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path, TEXT.replace('name = "wrist"', 'name = "linkes Handgelenk \\\\"'))
    ended = call("export", joint, "--out", tmp_path)
    assert ended.code == 2
    assert "give another one with --name" in ended.err
    assert call("export", joint, "--out", tmp_path, "--name", "wrist").code == 0
    text = (tmp_path / "wrist.hpp").read_text(encoding="utf-8")
    assert r'joint_name[] = "linkes Handgelenk \134"' in text
    assert call("export", joint, "--check", tmp_path / "wrist.hpp").code == 0


def test_what_float_cannot_hold_is_said(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path, TEXT.replace("gain_Nm_per_V = 6.6", "gain_Nm_per_V = 1e300"))
    ended = call("export", joint, "--out", tmp_path)
    assert ended.code == 2
    assert "gain_Nm_per_V" in ended.err
    assert "in the precision float" in ended.err
    assert call("export", joint, "--out", tmp_path, "--precision", "double").code == 0


def test_a_changed_file_of_the_c_interface_is_refused(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path)
    call("export", joint, "--out", tmp_path)
    interface = tmp_path / "strainwave_joint.h"
    text = interface.read_text(encoding="utf-8")
    interface.write_text(text.replace("STRAINWAVE_GAUGES 4", "STRAINWAVE_GAUGES 5"), "utf-8")
    ended = call("export", joint, "--check", tmp_path / "wrist.hpp")
    assert ended.code == 2
    assert "strainwave_joint.h, line" in ended.err
    interface.unlink()
    assert call("export", joint, "--check", tmp_path / "wrist.hpp").code == 0


@given(st.text(max_size=20))
def test_names_are_identifiers_or_refused(name: str) -> None:
    joint = Joint.model_validate({"joint": {"name": "any"}})
    try:
        found = joint_identifier(joint, name)
    except InputError:
        found = None
    assert found in (None, name)
    if found is not None:
        assert name.isascii()
        assert name.isidentifier()


def test_the_libraries_have_the_package_s_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    described = json.loads((ROOT / "library.json").read_text(encoding="utf-8"))
    assert described["version"] == project["version"]
    assert described["description"] == project["description"]
    for header in described["headers"]:
        assert (ROOT / described["build"]["includeDir"] / header).is_file()
