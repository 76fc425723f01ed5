"""The page that `strainwave demo` writes."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from strainwave.report.demo import STEPS, DemoReport, write_demo
from strainwave.reproduce.comparison import tallies


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> DemoReport:
    return write_demo(tmp_path_factory.mktemp("demo"))


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.images: list[dict[str, str | None]] = []
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag == "img":
            self.images.append(values)
        if values.get("id"):
            self.anchors.add(str(values["id"]))
        if tag == "a":
            self.links.add(str(values.get("href")))
        for name in ("src", "href"):
            target = values.get(name) or ""
            if target and not target.startswith(("data:", "#")):
                self.outside.append(target)


def test_report_is_self_contained_and_complete(demo: DemoReport) -> None:
    text = demo.page.read_text(encoding="utf-8")
    page = _Page()
    page.feed(text)
    assert page.outside == []
    assert {link.removeprefix("#") for link in page.links} <= page.anchors
    assert len(page.images) == 14
    assert all(image.get("alt") for image in page.images)
    for words in ("Table I", "figure 7", "Figure 8", "Figure 9", "Figure 10", "Figure 11"):
        assert words in text
    for words in ("Figure 3", "Figure 6", "Figures 4, 7 and 11", "2N + 1", "swallows true torque"):
        assert words in text
    assert text.count("Simulated") >= 10
    words_only = re.sub(r"data:[^\"]*", "", text)
    assert not re.search(r"\bnan\b", words_only)
    for kind in tallies(demo.comparisons):
        assert f"{kind.compared} {kind.kind}" in words_only
    # A number has a minus sign, not a hyphen (but for exponents).
    assert (
        re.findall(
            r"[>(\s]-\d[^<]*", re.sub(r"<style>.*?</style>", "", words_only, flags=re.DOTALL)
        )
        == []
    )


def test_same_command_gives_the_same_page(demo: DemoReport, tmp_path: Path) -> None:
    steps: list[str] = []
    again = write_demo(tmp_path, on_step=steps.append)
    assert again.page.read_bytes() == demo.page.read_bytes()
    assert again.picture.read_bytes() == demo.picture.read_bytes()
    assert tuple(steps) == STEPS


def test_comparisons_are_plain_values(demo: DemoReport) -> None:
    text = json.dumps([entry.as_dict() for entry in demo.comparisons], allow_nan=False)
    assert "sensor gain" in text
