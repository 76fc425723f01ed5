"""The reference pages and the commands say the same options, and links lead somewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import cyclopts
import pytest

from strainwave.cli.application import app
from strainwave.cli.whole import whole_number_of_tokens
from strainwave.errors import InputError

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "docs" / "reference"
#: Commands that share the page of another one.
SHARED = {
    "calibrate tune": "calibrate-fluctuation",
    "calibrate plan": "calibrate-torque",
    "joint new": "joint",
    "joint check": "joint",
}
OPTION = re.compile(r"--[a-z][A-Za-z-]*[A-Za-z]")


def commands(
    parent: cyclopts.App, words: tuple[str, ...] = ()
) -> Iterator[tuple[str, cyclopts.App]]:
    for name in parent:
        if name.startswith("-"):
            continue
        command = parent[name]
        if command.default_command is None:
            yield from commands(command, (*words, name))
        else:
            yield " ".join((*words, name)), command


COMMANDS = dict(commands(app))


def options(name: str) -> set[str]:
    """Options of a command, as it takes them."""
    arguments = COMMANDS[name].assemble_argument_collection()
    return {each.names[0] for each in arguments if each.names[0].startswith("--")}


def page_of(name: str) -> Path:
    return REFERENCE / f"{SHARED.get(name, name.replace(' ', '-'))}-command.md"


def usages(page: Path) -> dict[str, set[str]]:
    """Options in the blocks at the head of a page, by command."""
    found: dict[str, set[str]] = {}
    command = ""
    for block in re.findall(
        r"^```\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    ):
        for line in block.splitlines():
            if line.startswith("strainwave "):
                (command,) = (name for name in COMMANDS if is_call(line, name))
            found.setdefault(command, set()).update(OPTION.findall(line))
    return found


def is_call(line: str, name: str) -> bool:
    return line.split()[1 : 1 + len(name.split())] == name.split()


def rows(page: Path) -> set[str]:
    """Options that have a row of a table of options to themselves, or share one."""
    found: set[str] = set()
    is_table = False
    for line in page.read_text(encoding="utf-8").splitlines():
        first = line.split("|")[1] if line.startswith("|") else ""
        is_table = line.startswith(("| option", "| key of `--map`")) or (is_table and bool(first))
        found |= set(OPTION.findall(first)) if is_table else set()
    return found


def test_commands_and_options_are_found() -> None:
    assert {"filter", "calibrate fluctuation", "design layout", "joint new"} <= set(COMMANDS)
    assert {"--map", "--limit-FS", "--json"} <= options("filter") | options("design layout")


@pytest.mark.parametrize("name", COMMANDS)
def test_usage_names_every_option_and_no_other(name: str) -> None:
    assert usages(page_of(name))[name] == options(name)


@pytest.mark.parametrize("page", sorted({page_of(name) for name in COMMANDS}), ids=lambda p: p.stem)
def test_tables_name_every_option_and_no_other(page: Path) -> None:
    taken = set().union(*(options(name) for name in COMMANDS if page_of(name) == page))
    assert rows(page) == taken


@pytest.mark.parametrize("name", COMMANDS)
def test_help_explains_every_option_with_an_example(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    app([*name.split(), "--help"], exit_on_error=False, result_action="return_value")
    shown = capsys.readouterr().out
    assert f"Example: strainwave {name} " in shown
    said = dict(re.findall(r"│[ *]+(--[A-Za-z-]+)[ A-Z.]* {2,}(\S.*)", shown))
    assert set(said) == options(name)
    assert all(len(words.split("[")[0].strip(" │")) > 3 for words in said.values())


@pytest.mark.parametrize("name", COMMANDS)
def test_whole_numbers_are_never_rounded(name: str) -> None:
    for argument in COMMANDS[name].assemble_argument_collection():
        if argument.hint in {int, int | None}:
            assert argument.parameter.converter is whole_number_of_tokens, argument.names


@pytest.mark.parametrize(("text", "number"), [("3", 3), ("1e6", 1_000_000), ("-2", -2), ("4.0", 4)])
def test_whole_number(text: str, number: int) -> None:
    assert whole_number_of_tokens(int, [cyclopts.Token(keyword="--n", value=text)]) == number


@pytest.mark.parametrize("text", ["3.5", "inf", "nan", "three", "", "1e400"])
def test_no_whole_number(text: str) -> None:
    with pytest.raises(InputError, match=r"--n .*: expected a whole number"):
        whole_number_of_tokens(int, [cyclopts.Token(keyword="--n", value=text)])


def anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each.lower()).replace(" ", "-") for each in headings}


@pytest.mark.parametrize(
    "page",
    sorted((ROOT / "docs").rglob("*.md")),
    ids=lambda page: page.relative_to(ROOT).as_posix(),
)
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", link):
            continue
        file, _, anchor = link.partition("#")
        target = page.parent / file if file else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link
