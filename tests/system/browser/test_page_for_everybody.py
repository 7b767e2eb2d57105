"""What people meet on the page: nothing is cut off, and axe-core finds nothing serious."""

from __future__ import annotations

import os

import pytest

from sandbox.words import LANGUAGES
from tests.support.chromium import BINARY, Browser
from tests.support.needs import AXE
from tools.docs.page_languages import OVERFLOWS, SIZES, USUAL, moments

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

SERIOUS = """
axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) =>
  violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map((n) => n.html.slice(0, 120)).join(" | ")}`))
"""


@pytest.mark.needs("axe")
@pytest.mark.parametrize("code", ["en", "ar"])
def test_axe_finds_nothing_serious_on_any_sheet(browser: Browser, code: str) -> None:
    found = {}
    for name, tab in moments(browser, code, USUAL):
        tab.evaluate(f"{AXE.read_text(encoding='utf-8')}; true")
        if serious := tab.evaluate(SERIOUS):
            found[name] = serious
    assert found == {}


OTHERS = [pytest.param(code, USUAL, marks=pytest.mark.full) for code in LANGUAGES]
EVERYWHERE = [
    pytest.param(code, size, marks=pytest.mark.full) for code in ("en", "ar") for size in SIZES
]


@pytest.mark.parametrize(("code", "size"), [("de", "390x844"), ("ar", USUAL), *OTHERS, *EVERYWHERE])
def test_no_words_are_cut_off(browser: Browser, code: str, size: str) -> None:
    found = {}
    for name, tab in moments(browser, code, size):
        if cut_off := tab.evaluate(OVERFLOWS):
            found[name] = cut_off
    assert found == {}
