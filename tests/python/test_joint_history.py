"""What was replaced or removed stays in the joint file, as a chain of hashes."""

from datetime import UTC, datetime

import pytest

from helpers.elbow import GEAR, PROVENANCE, TEXT
from strainwave.errors import InputError
from strainwave.joint import Provenance, canonical_hash, parse_joint

LATER = Provenance(
    input="again.csv",
    input_sha256="a" * 64,
    created=datetime(2027, 1, 2, 3, 4, 5, tzinfo=UTC),
    version="0.3.0",
    command="strainwave calibrate torque again.csv",
)


def test_every_replacement_and_removal_leaves_an_entry() -> None:
    joint_file = parse_joint(TEXT)
    hashes = [canonical_hash(joint_file.joint)]
    joint_file.set_section("gear", GEAR, PROVENANCE)
    hashes.append(canonical_hash(joint_file.joint))
    joint_file.set_section("gear", GEAR, LATER)
    hashes.append(canonical_hash(joint_file.joint))
    joint_file.remove_section("temperature", LATER)
    joint = parse_joint(joint_file.text()).joint
    assert joint == joint_file.joint
    assert joint.history is not None
    assert [(entry.section, entry.change) for entry in joint.history] == [
        ("gear", "replaced"),
        ("gear", "replaced"),
        ("temperature", "removed"),
    ]
    # Each entry holds the hash of the joint before it: the entries form a chain.
    assert [entry.previous_sha256 for entry in joint.history] == hashes
    second = joint.history[1]
    assert (second.input, second.input_sha256, second.command) == (
        "again.csv",
        "a" * 64,
        LATER.command,
    )
    assert (second.previous_input, second.previous_created) == (
        "entered by hand",
        PROVENANCE.created,
    )
    assert joint.history[2].previous_input_sha256 is not None


def test_a_first_filling_and_the_same_again_leave_none() -> None:
    joint_file = parse_joint('schema_version = 1\n[joint]\nname = "a"\n')
    joint_file.set_section("gear", GEAR, PROVENANCE)
    text = joint_file.text()
    joint_file.set_section("gear", GEAR, PROVENANCE)
    joint_file.remove_section("gains")
    assert joint_file.joint.history is None
    assert joint_file.text() == text


def test_history_counts_in_the_hash_but_not_among_the_values() -> None:
    joint_file = parse_joint(TEXT)
    before = joint_file.joint
    assert before.gear is not None
    joint_file.set_section("gear", before.gear, LATER)
    after = joint_file.joint
    assert canonical_hash(after) != canonical_hash(before)
    assert canonical_hash(after, include_provenance=False) == canonical_hash(
        before, include_provenance=False
    )


def test_comments_outlive_several_changes() -> None:
    joint_file = parse_joint(TEXT)
    for provenance in (PROVENANCE, LATER, PROVENANCE):
        joint_file.set_section("gear", GEAR, provenance)
        joint_file = parse_joint(joint_file.text())
    assert joint_file.joint.history is not None
    assert len(joint_file.joint.history) == 3
    assert "# Elbow joint of the test arm" in joint_file.text()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'change = "replaced"',
            'change = "bent"',
            r'\[history\] entry 1, change = "bent": expected',
        ),
        ('section = "gear"', "sektion = 1", r'\[history\] entry 1.*unknown key "sektion"'),
        ("previous_sha256 =", "previous_sha257 =", "unknown key"),
    ],
)
def test_a_bad_entry_is_named(old: str, new: str, message: str) -> None:
    joint_file = parse_joint(TEXT)
    joint_file.set_section("gear", GEAR, LATER)
    text = joint_file.text()
    start = text.index("[[history]]")
    with pytest.raises(InputError, match=message):
        parse_joint(text[:start] + text[start:].replace(old, new), "elbow.toml")
