"""What is read on the page in another language than English: that language, and no English word."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from models.message import Message
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import Sheet, StudyView
from sandbox.session.collision_gating import STUCK
from sandbox.study.design.design import Design
from sandbox.study.record.folder import PILOT, StudyFolder
from sandbox.study.run.runner import SessionOutcome
from sandbox.words import words_in
from tests.sandbox.server.staged_page import HEIGHT, KNOWN, READY, TASKS, WIDTH, staged
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.sandbox.study.study_on_page import PPI, OnPage, on_page
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.study_files import design
from tests.system.browser.seen_words import seen, watch, words

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "study" / "design.toml"
GERMAN = words_in("de")
OWN_NAME = "Deutsch"


def german_of(study: Design) -> list[str]:
    """Every German text of a design."""
    forms = [*study.demographics, *(item for form in study.questionnaires for item in form.items)]
    texts = [study.consent, *(i.text for i in study.instructions)]
    texts += [form.title for form in study.questionnaires]
    for item in forms:
        texts += [item.ask, *(item.ends or ()), *item.means]
    return [text["de"] for text in texts if text]


def answer(tab: Tab) -> None:
    """Fills in what a form shows, page by page, and leaves it."""
    tab.evaluate(
        """(() => {
          for (const group of document.querySelectorAll(".points, .options"))
            group.querySelector("button").click();
          for (const line of document.querySelectorAll(".line")) {
            line.focus();
            line.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
          }
          document.querySelector(".go-on")?.click();
        })()"""
    )


def go_through(running: OnPage, tab: Tab) -> None:
    """A participant who answers anything, and touches in each trial until its time is up."""
    while running.outcome is None:
        time.sleep(0.1)
        kind = tab.evaluate("document.querySelector('.study').dataset.kind")
        if kind == "consent":
            tab.evaluate("document.querySelector('.study .primary')?.click()")
        elif kind == "form":
            # Somebody who goes on too early, and types no number, is told so.
            tab.evaluate("document.querySelector('.go-on')?.click()")
            answer(tab)
        elif kind in ("text", "task", "rest"):
            tab.evaluate("document.querySelector('.study .primary:not([hidden])')?.click()")
        elif kind == "none":
            tab.touch([(1, 250.0, 200.0), (2, 330.0, 240.0)])
            tab.touch([])
        assert running.failure is None, running.failure


def test_the_example_study_in_german_has_no_english_word(browser: Browser, tmp_path: Path) -> None:
    text = EXAMPLE.read_text(encoding="utf-8")
    for long, short in (
        ('["paper", "quadratic", "population"]', '["paper", "population"]'),
        ("repetitions = 3", "repetitions = 1"),
        ('practice = 1\npractice_each = "task"\n', ""),
        ("time_limit_s = 30", "time_limit_s = 1"),
        ("least_s = 30", "least_s = 1"),
        ("every = 7", "every = 2"),
        ("[trials]\n", '[trials]\nshows = ["task", "goal", "time", "progress", "fingers"]\n'),
    ):
        assert long in text
        text = text.replace(long, short)
    study = StudyFolder(tmp_path, design(text), PILOT)
    person = study.add(hand="right", hand_size=1.0, language="de")
    with on_page(study, person) as running:
        tab = browser.open("about:blank", width=WIDTH, height=HEIGHT)
        watch(tab)
        tab.go(running.server.url)
        # The card comes first, as on a tablet that nobody has used before.
        tab.wait("!!document.querySelector('.slider')")
        tab.evaluate(
            "(() => { const slider = document.querySelector('.slider');"
            f"slider.value = {PPI}; slider.dispatchEvent(new Event('input')); }})()"
        )
        tab.tap(GERMAN["card_fits"])
        tab.wait("document.querySelector('.study').dataset.kind === 'consent'")
        assert tab.evaluate("document.documentElement.lang") == "de"
        go_through(running, tab)
        assert running.ended() is SessionOutcome.COMPLETE
        tab.wait(f"document.body.innerText.includes({GERMAN['end']!r})")
        shown = seen(tab)
        tab.close()
    german = words(*GERMAN.values(), *german_of(study.design))
    assert {GERMAN["agree"], GERMAN["rest"], GERMAN["wording_translation"]} <= shown
    assert any(GERMAN["task_wrench-turn"] in text for text in shown)
    assert words(*shown) - german == set()


@pytest.fixture
def stage() -> Iterator[Stage]:
    server = PageServer(tasks=TASKS)
    yield staged(server)
    server.close()


def test_the_link_chooses_a_language_that_a_reload_keeps_and_the_menu_another(
    browser: Browser, stage: Stage
) -> None:
    server = stage.server
    tab = browser.open("about:blank", width=WIDTH, height=HEIGHT, storage=KNOWN)
    watch(tab)
    tab.go(f"{server.url}&lang=de")
    tab.wait(READY)
    assert "lang" not in tab.evaluate("location.search")
    assert wait_for(lambda: server.language == "de")
    stage.advance()
    tab.wait("/Kiste ist .* mm vom Ziel/.test(document.querySelector('.reason').textContent)")
    # A decimal comma, and no point.
    tab.wait("/^0,[0-9] von [0-9]+ s$/.test(document.querySelector('.clock').textContent)")
    tab.tap(GERMAN["settings"])
    tab.tap(GERMAN["language"])
    tab.wait("document.querySelectorAll('.sheet .choice').length > 1")
    # The language's own name, in the list of languages.
    tab.wait(f"seenWords.has({OWN_NAME!r})")
    tab.tap(GERMAN["close"])
    server.show_problem(Message("other_page", "The page of the other hand is not open yet."), STUCK)
    tab.wait(f"document.body.innerText.includes({GERMAN['other_page']!r})")
    assert words(*seen(tab)) - words(*GERMAN.values()) == words(OWN_NAME)
    tab.call("Page.reload")
    tab.wait(f"document.querySelector('.task').textContent === {GERMAN['task_box-to-goal']!r}")
    tab.tap(GERMAN["settings"])
    tab.tap(GERMAN["language"])
    tab.tap("English")
    tab.wait("document.documentElement.lang === 'en' && " + READY)
    tab.wait("document.querySelector('.task').textContent === 'Box to goal'")
    assert wait_for(lambda: server.language == "en")
    tab.close()


def test_a_design_gives_its_own_words_in_a_language_that_the_page_has_not(
    browser: Browser, tmp_path: Path
) -> None:
    own = {key: f"«{key}»" for key in ("agree", "decline", "preparing", "wait")}
    table = "\n".join(f'{key} = "{text}"' for key, text in own.items())
    text = f"""
name = "own-words"
languages = ["nl"]
[settings]
task = "box-to-goal"
[[factors]]
name = "contact"
order = "between"
levels = ["hard"]
[words.nl]
{table}
[consent]
text = "Gaat u akkoord?"
"""
    study = StudyFolder(tmp_path, design(text), PILOT)
    person = study.add(hand="right", hand_size=1.0, language="nl")
    with on_page(study, person) as running:
        tab = browser.open(running.server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
        tab.wait("document.querySelector('.study').dataset.kind === 'consent'")
        assert tab.evaluate("document.documentElement.lang") == "nl"
        tab.wait(f"document.body.innerText.includes({own['agree']!r})")
        tab.close()


@pytest.mark.parametrize(
    ("code", "lang", "agree"),
    [
        ("de_AT", "de", GERMAN["agree"]),
        ("pt_BR", "pt", words_in("en")["agree"]),
        ("no language", "en", words_in("en")["agree"]),
    ],
)
def test_a_code_that_browsers_do_not_take_is_no_empty_page(
    browser: Browser, code: str, lang: str, agree: str
) -> None:
    server = PageServer(study=StudyView(code, {}, ["task"]))
    try:
        server.show_sheet(Sheet(1, "consent", "", "Read this.", [], {}, 0.0))
        tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
        tab.wait("document.body.innerText.includes('Read this.')")
        assert agree in tab.text()
        assert tab.evaluate("document.documentElement.lang") == lang
        assert not tab.events("Runtime.exceptionThrown")
        tab.close()
    finally:
        server.close()
