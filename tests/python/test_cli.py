"""The command line: what it prints, writes and refuses."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import strainwave

ELBOW = Path(__file__).parents[1] / "data" / "joints" / "elbow.toml"
COMMAND = Path(sys.executable).parent / "strainwave"


def run(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [COMMAND, *map(str, arguments)], capture_output=True, text=True, check=False, cwd=cwd
    )


def test_joint_new_and_check(tmp_path: Path) -> None:
    made = run("joint", "new", "j.toml", "--name", "left elbow", "--json", cwd=tmp_path)
    assert made.returncode == 0
    checked = run("joint", "check", "j.toml", "--json", cwd=tmp_path)
    result = json.loads(checked.stdout)
    assert result["name"] == "left elbow"
    assert result["hash"] == json.loads(made.stdout)["hash"]
    assert result["sections"] == {}


def test_joint_check_lists_what_is_known(tmp_path: Path) -> None:
    checked = run("joint", "check", ELBOW, cwd=tmp_path)
    assert checked.returncode == 0
    for section in ("gear", "gauges", "torque_calibration", "temperature"):
        assert section in checked.stdout


NEWER = 'schema_version = 99\n[joint]\nname = "x"\n'


@pytest.mark.parametrize(
    ("content", "arguments", "words"),
    [
        (None, ("joint", "check", "gone.toml"), "gone.toml: there is no such file"),
        ("", ("joint", "check", "j.toml"), "j.toml"),
        (NEWER, ("joint", "check", "j.toml"), "newer strainwave"),
        (NEWER, ("joint", "new", "j.toml", "--name", "x"), "exists already"),
        (None, ("joint", "new", "no/such/folder/j.toml", "--name", "x"), "cannot be written"),
        (None, ("joint", "new", "j.toml"), "name"),
        (None, ("demo", "--out"), "--out"),
        (None, ("demonstrate",), "demonstrate"),
        ("a file", ("demo", "--out", "j.toml"), "cannot be made a folder"),
    ],
)
def test_unusable_input_ends_with_2_and_one_sentence(
    tmp_path: Path, content: str | None, arguments: tuple[str, ...], words: str
) -> None:
    if content is not None:
        (tmp_path / "j.toml").write_text(content, encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    refused = run(*arguments, cwd=tmp_path)
    assert refused.returncode == 2
    assert refused.stdout == ""
    (message,) = [line for line in refused.stderr.splitlines() if line.startswith("strainwave: ")]
    assert words in message
    assert "Traceback" not in refused.stderr
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "command", [("demo",), ("fidelity",), ("joint", "new"), ("joint", "check")]
)
def test_help_has_an_example(tmp_path: Path, command: tuple[str, ...]) -> None:
    shown = run(*command, "--help", cwd=tmp_path)
    assert shown.returncode == 0
    assert f"Example: strainwave {' '.join(command)}" in " ".join(shown.stdout.split())
    assert "--json" in shown.stdout


def test_version(tmp_path: Path) -> None:
    assert run("--version", cwd=tmp_path).stdout.strip() == strainwave.__version__


@pytest.mark.parametrize("more", [(), ("--json",)])
def test_a_closed_pipe_ends_without_a_word(more: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        ended = subprocess.run(
            [COMMAND, "joint", "check", ELBOW, *more],
            stdout=writer,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    finally:
        os.close(writer)
    assert (ended.returncode, ended.stderr) == (141, "")
