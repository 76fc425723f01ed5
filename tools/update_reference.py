"""Puts the table of keys, as the models give it, into docs/reference/joint-file.md."""

import re
from pathlib import Path

from strainwave.joint.reference import field_tables

page = Path(__file__).parent.parent / "docs" / "reference" / "joint-file.md"
text = page.read_text(encoding="utf-8")
begin, end = "<!-- keys: begin -->\n", "<!-- keys: end -->"
page.write_text(
    re.sub(
        f"{re.escape(begin)}.*{re.escape(end)}",
        lambda _: begin + field_tables() + end,
        text,
        flags=re.DOTALL,
    ),
    encoding="utf-8",
)
