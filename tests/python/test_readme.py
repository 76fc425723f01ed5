"""The README's examples are the files in examples/, and these run."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("language", "file"),
    [("cpp", "examples/cpp/first.hpp"), ("python", "examples/python/first.py")],
)
def test_readme_shows_the_example_that_is_run(language: str, file: str) -> None:
    shown = re.search(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert shown
    assert shown[1] == (ROOT / file).read_text(encoding="utf-8")


def test_python_example_removes_ripple_and_keeps_the_contact() -> None:
    run = subprocess.run(
        [sys.executable, ROOT / "examples/python/first.py"],
        capture_output=True,
        text=True,
        check=True,
    )
    numbers = re.fullmatch(r"([\d.]+) -> ([\d.]+) Nm rms\n", run.stdout)
    assert numbers
    # A sine of 1.6 Nm; what is left of it and the contact's ringing is a few per cent.
    assert float(numbers[1]) == pytest.approx(1.6 / 2**0.5, abs=0.01)
    assert 0.0 < float(numbers[2]) < 0.1


def test_cpp_example_reads_the_converter(tmp_path: Path) -> None:
    program = tmp_path / "first"
    subprocess.run(
        [
            *("g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-I", ROOT / "include"),
            *(ROOT / "examples/cpp/main.cpp", "-o", program),
        ],
        check=True,
    )
    run = subprocess.run([program], capture_output=True, text=True, check=True)
    # Code 36000 of a 16-bit converter over +-10 V, at 6.60 Nm/V.
    expected_Nm = (36000 / 2**16 * 20 - 10) * 6.60
    assert run.stdout.startswith(f"{expected_Nm:.3f} Nm")


@pytest.mark.parametrize("link", sorted(set(re.findall(r"\]\(([^)#:]+)\)", README))))
def test_links_of_the_readme_lead_somewhere(link: str) -> None:
    assert (ROOT / link.strip()).exists()
