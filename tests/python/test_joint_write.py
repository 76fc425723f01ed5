"""Writing a joint file happens whole or not at all."""

import errno
import os
import stat
from pathlib import Path

import pytest

from helpers.elbow import GEAR, PROVENANCE, TEXT, elbow
from strainwave.errors import InputError
from strainwave.joint import (
    JointFile,
    new_joint,
    read_joint,
    write_joint,
)


def changed(path: Path) -> JointFile:
    joint_file = read_joint(path)
    joint_file.set_section("gear", GEAR, PROVENANCE)
    return joint_file


@pytest.mark.parametrize("step", ["open", "fsync", "replace"])
def test_a_failed_write_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    path = elbow(tmp_path)
    joint_file = changed(path)

    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as context:
        context.setattr(os, step, fail)
        with pytest.raises(InputError, match=r"elbow.toml: it cannot be written \(no space left"):
            write_joint(joint_file, path)
    assert path.read_bytes() == TEXT.encode()
    assert [entry.name for entry in tmp_path.iterdir()] == ["elbow.toml"]
    # What failed can be tried again.
    write_joint(joint_file, path)
    assert read_joint(path).joint == joint_file.joint


def test_a_write_that_is_interrupted_half_way_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = elbow(tmp_path)
    joint_file = changed(path)
    written = []

    def interrupt(descriptor: int) -> None:
        written.append(os.fstat(descriptor).st_size)
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_joint(joint_file, path)
    assert written == [len(joint_file.text().encode())]
    assert path.read_bytes() == TEXT.encode()
    assert [entry.name for entry in tmp_path.iterdir()] == ["elbow.toml"]


def test_the_old_file_is_whole_until_it_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = elbow(tmp_path)
    joint_file = changed(path)
    seen = []
    real_replace = os.replace

    def look(source: Path, target: Path) -> None:
        seen.append((path.read_bytes(), Path(source).read_bytes(), Path(source).parent))
        real_replace(source, target)

    monkeypatch.setattr(os, "replace", look)
    write_joint(joint_file, path)
    assert seen == [(TEXT.encode(), joint_file.text().encode(), tmp_path)]
    assert path.read_text() == joint_file.text()


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_permissions_are_kept(tmp_path: Path, mode: int) -> None:
    path = elbow(tmp_path)
    path.chmod(mode)
    write_joint(changed(path), path)
    assert stat.S_IMODE(path.stat().st_mode) == mode


def test_a_new_file_has_the_usual_permissions(tmp_path: Path) -> None:
    usual = tmp_path / "usual"
    usual.touch()
    write_joint(new_joint("a"), tmp_path / "new.toml")
    assert (tmp_path / "new.toml").stat().st_mode == usual.stat().st_mode


def test_a_symbolic_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "files").mkdir()
    path = elbow(tmp_path / "files")
    link = tmp_path / "link.toml"
    link.symlink_to(path)
    joint_file = changed(link)
    write_joint(joint_file, link)
    assert link.is_symlink()
    assert path.read_text() == joint_file.text()


def test_folders_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be written \(no such file or directory\)"):
        write_joint(new_joint("a"), tmp_path / "none" / "a.toml")
    with pytest.raises(InputError, match="it is a directory"):
        write_joint(new_joint("a"), tmp_path)


def test_nobodys_changes_are_lost(tmp_path: Path) -> None:
    path = elbow(tmp_path)
    mine = changed(path)
    theirs = read_joint(path)
    theirs.remove_section("temperature")
    write_joint(theirs, path)
    with pytest.raises(InputError, match=r"was changed since.*ask to overwrite it"):
        write_joint(mine, path)
    with pytest.raises(InputError, match="there is a file already"):
        write_joint(new_joint("other"), path)
    assert path.read_text() == theirs.text()
    write_joint(mine, path, overwrite=True)
    assert path.read_text() == mine.text()
    # Written once, it may be written again.
    mine.remove_section("temperature")
    write_joint(mine, path)
    assert read_joint(path).joint.temperature is None
