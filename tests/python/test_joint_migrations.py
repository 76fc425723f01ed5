"""Older files become newer ones, in order, with their comments."""

from pathlib import Path
from typing import Any

import pytest

from strainwave.errors import InputError
from strainwave.joint import SCHEMA_VERSION, new_joint, parse_joint, read_joint, write_joint
from strainwave.joint.migrations import MIGRATIONS, Document, migrate, newest_version

OLD = (Path(__file__).parents[1] / "data/joints/made_up_old_version.toml").read_text()


def rename_reduction(document: Document) -> Document:
    """From the made-up version 1: the ratio was called reduction."""
    gear: Any = document["gear"]
    gear["ratio"] = gear.pop("reduction")
    return document


def kilonewton_to_newton(document: Document) -> Document:
    """From the made-up version 2: the rated torque was in kNm."""
    gear: Any = document["gear"]
    gear["rated_torque_Nm"] = 1000.0 * gear.pop("rated_torque_kNm")
    return document


MADE_UP = (rename_reduction, kilonewton_to_newton)


def test_the_first_real_version_has_no_migrations() -> None:
    assert MIGRATIONS == ()
    assert SCHEMA_VERSION == 1
    assert newest_version(MADE_UP) == 3


def test_an_old_file_is_read_through_all_versions() -> None:
    joint_file = parse_joint(OLD, "old.toml", migrations=MADE_UP)
    assert joint_file.migrated_from == 1
    assert joint_file.joint.gear is not None
    assert joint_file.joint.gear.ratio == 100.0
    assert joint_file.joint.gear.rated_torque_Nm == 40.0
    text = joint_file.text()
    assert text.startswith("# Kept from the first bench.\nschema_version = 3\n")
    assert "# the one with the steel cap" in text


def test_only_the_missing_steps_are_taken() -> None:
    second = OLD.replace("schema_version = 1", "schema_version = 2").replace("reduction", "ratio")
    joint_file = parse_joint(second, migrations=MADE_UP)
    assert joint_file.migrated_from == 2
    assert joint_file.joint == parse_joint(OLD, migrations=MADE_UP).joint
    third = joint_file.text()
    assert parse_joint(third, migrations=MADE_UP).migrated_from is None
    assert parse_joint(third, migrations=MADE_UP).text() == third


def test_steps_are_in_order() -> None:
    steps: list[int] = []

    def step(number: int) -> Any:
        def migration(document: Document) -> Document:
            assert document["schema_version"] == number
            steps.append(number)
            return document

        return migration

    document = {"schema_version": 2}
    migrated = migrate(document, "a", tuple(step(number) for number in (1, 2, 3, 4)))
    assert steps == [2, 3, 4]
    assert migrated == {"schema_version": 5}
    assert document == {"schema_version": 2}


def test_an_old_file_that_is_not_valid_for_its_version() -> None:
    broken = OLD.replace("reduction = 100.0", "reducer = 100.0")
    with pytest.raises(
        InputError, match=r"old.toml: it cannot be taken from schema 1 to 2 .*reduction.*schema 1"
    ):
        parse_joint(broken, "old.toml", migrations=MADE_UP)


def test_a_newer_file_is_refused() -> None:
    newer = OLD.replace("schema_version = 1", "schema_version = 4")
    expected = (
        r"old.toml: it was written by a newer strainwave \(schema 4, this one knows up to 3\); "
        r"update strainwave, or take an older copy"
    )
    with pytest.raises(InputError, match=expected):
        parse_joint(newer, "old.toml", migrations=MADE_UP)


def test_what_is_written_has_the_present_version(tmp_path: Path) -> None:
    path = tmp_path / "new.toml"
    write_joint(new_joint("elbow"), path)
    assert f"schema_version = {SCHEMA_VERSION}\n" in path.read_text()
    assert read_joint(path).migrated_from is None
