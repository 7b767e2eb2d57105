"""The notebook and its page. CI runs all of it: `python -m tools.docs.notebook --check`."""

from __future__ import annotations

import json
import re
from types import SimpleNamespace
from typing import Any

import pytest

from tools.docs.notebook import NOTEBOOK, PAGE, page

SEEN = re.compile(
    r"^```text\n.*?^```\n\n|^!\[[^\n]*\]\(pictures/[^\n]*\)\n\n?", re.MULTILINE | re.DOTALL
)
"""What steps showed, on the page."""


@pytest.fixture(scope="module")
def cells() -> list[dict[str, Any]]:
    """The notebook's cells."""
    return json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]


def test_the_notebook_is_kept_without_what_it_shows(cells: list[dict[str, Any]]) -> None:
    steps = [cell for cell in cells if cell["cell_type"] == "code"]
    assert steps and not any(cell["outputs"] or cell["execution_count"] for cell in steps)


def test_the_page_is_the_notebook_with_what_it_shows(cells: list[dict[str, Any]]) -> None:
    bare = [
        SimpleNamespace(cell_type=c["cell_type"], source="".join(c["source"]), outputs=[])
        for c in cells
    ]
    text, pictures = page(SimpleNamespace(cells=bare))
    assert not pictures
    shown = PAGE.read_text(encoding="utf-8")
    assert len(SEEN.findall(shown)) >= 6
    assert SEEN.sub("", shown).rstrip() == text.rstrip()
