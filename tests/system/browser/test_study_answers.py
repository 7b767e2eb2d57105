"""What participants type is told, whatever the network does; what is wrong is not left out."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.server.page_server import PageServer
from sandbox.server.protocol import ItemAnswer, ItemView, Sheet, StudyView
from sandbox.study.record.journal import read_journal
from sandbox.words import words_in
from tests.sandbox.server.test_page_server import wait_for
from tests.sandbox.study.study_on_page import HEIGHT, KNOWN, SMALL, WIDTH, OnPage, on_page, study_in
from tests.support.chromium import BINARY, Browser, Tab
from tests.system.browser.network import ADDRESS, Network

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
FORM = SMALL[: SMALL.index("[[demographics]]")] + (
    '[[demographics]]\nname = "age"\nkind = "number"\nlow = 18\noptional = true\n'
    'ask = {en = "How old are you?", de = "Wie alt?"}\n'
    '[[demographics]]\nname = "remarks"\nkind = "text"\noptional = true\n'
    'ask = {en = "Anything else?", de = "Noch etwas?"}\n'
)


@pytest.fixture
def running(tmp_path: Path) -> Iterator[OnPage]:
    study = study_in(tmp_path, FORM)
    with on_page(study, study.add(hand="right", hand_size=1.0, language="en")) as running:
        yield running


def in_form(browser: Browser, url: str) -> Tab:
    """The page, once its form is open."""
    tab = browser.open(url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait("document.querySelector('.study').dataset.kind === 'consent'")
    tab.tap(ENGLISH["agree"])
    tab.wait("document.querySelector('.study').dataset.kind === 'form'")
    return tab


def type_in(tab: Tab, field: str, text: str) -> None:
    """Types into a field, in place of what is in it."""
    tab.evaluate(f"document.querySelector({field!r}).focus()")
    tab.evaluate(f"document.querySelector({field!r}).select()")
    tab.call("Input.insertText", text=text)


def answers(running: OnPage) -> dict[str, object]:
    """The answers to the form, once it was left."""
    records = read_journal(running.folder / "session.jsonl")
    (found,) = [r["answers"] for r in records if r["kind"] == "form"]
    return dict(found)


def test_a_text_that_is_typed_while_the_network_is_gone_is_told_when_it_is_back(
    browser: Browser, running: OnPage
) -> None:
    server = running.server
    server.access = replace(server.access, names=(ADDRESS,))
    network = Network(server.access.port)
    try:
        tab = in_form(browser, server.url.replace("127.0.0.1", ADDRESS))
        network.leave()
        tab.wait("document.querySelector('.dot').dataset.condition !== 'open'")
        type_in(tab, "textarea", "typed meanwhile")
        # Longer than a page waits after the last key.
        time.sleep(0.5)
        network.come_back()
        tab.wait("document.querySelector('.dot').dataset.condition === 'open'")
        tab.tap(ENGLISH["done"])
        tab.wait("document.querySelector('.study').dataset.kind === 'text'")
        assert wait_for(lambda: answers(running)["remarks"] == "typed meanwhile")
        tab.close()
    finally:
        network.close()


def test_a_number_out_of_its_range_is_not_left_out_in_silence(
    browser: Browser, running: OnPage
) -> None:
    tab = in_form(browser, running.server.url)
    type_in(tab, ".entry.short", "1990")
    tab.tap(ENGLISH["done"])
    tab.wait("document.body.innerText.includes('18')")
    tab.tap(ENGLISH["done"])
    assert tab.evaluate("document.querySelector('.item-number').classList.contains('is-wrong')")
    assert tab.evaluate("document.querySelector('.study').dataset.kind") == "form"
    type_in(tab, ".entry.short", "33")
    tab.tap(ENGLISH["done"])
    tab.wait("document.querySelector('.study').dataset.kind === 'text'")
    assert answers(running)["age"] == 33
    tab.close()


def test_a_number_with_three_digits_after_its_only_sign_is_never_stored_as_a_thousandth(
    browser: Browser,
) -> None:
    server = PageServer(study=StudyView("en", {}, ["task"]))
    try:
        item = ItemView("income", "number", "Income?", True, [], 0.0, 500000.0, 1.0, "", "")
        server.show_sheet(Sheet(1, "form", "", "", [item], {}, 0.0))
        tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
        tab.wait("document.querySelector('.study').dataset.kind === 'form'")
        stored: list[object] = []

        def answered(value: object) -> bool:
            stored.extend(up.value for up in server.take_inputs() if isinstance(up, ItemAnswer))
            return stored[-1:] == [value]

        # Both signs mean thousands somewhere, and a decimal somewhere else.
        for typed in ("40,000", "1.500", "٤٠٫٠٠٠", "٤٠٬٠٠٠", "1,234,567", "+40,000"):
            type_in(tab, ".entry.short", "7")
            assert wait_for(lambda: answered(7)), typed
            type_in(tab, ".entry.short", typed)
            tab.wait("document.querySelector('.item-number').classList.contains('is-wrong')")
            assert ENGLISH["number"].format(low=0, high=500000) in tab.text()
            assert wait_for(lambda: answered(None)), typed
        assert set(stored) == {7, None}
        # No country writes thousands so.
        for typed, value in (("40000", 40000), ("0,125", 0.125), ("12,5", 12.5), ("٠٫١٢٥", 0.125)):
            type_in(tab, ".entry.short", typed)
            assert wait_for(lambda: answered(value)), typed  # noqa: B023
        tab.close()
    finally:
        server.close()
