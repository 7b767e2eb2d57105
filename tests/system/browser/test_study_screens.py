"""What a participant sees of the example study, screen by screen, is what its design shows."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from sandbox.words import words_in
from tests.sandbox.study.study_on_page import HEIGHT, KNOWN, WIDTH, OnPage, on_page, study_in
from tests.support.chromium import BINARY, Browser, Tab

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

EXAMPLE = Path(__file__).resolve().parents[3] / "examples/study/design.toml"
ENGLISH = words_in("en")
SHEET = "document.querySelector('.study')"
SHOWN = f"({SHEET}.checkVisibility() ? {SHEET} : document.body).innerText"
"""Text of the sheet, which covers the page, or of the page."""
TRIAL = "document.querySelector('.study').dataset.kind === 'none'"
PLAYS_ALONE = "document.querySelector('.reason').textContent === " + repr(ENGLISH["demonstration"])
"""True while a demonstration is shown."""
PUSHED = [(1, WIDTH / 2, HEIGHT / 2)]


@contextmanager
def session(browser: Browser, out: Path, design: str) -> Iterator[tuple[OnPage, Tab]]:
    study = study_in(out, design)
    person = study.add(hand="right", hand_size=1.0, language="en")
    with on_page(study, person) as running:
        tab = browser.open(running.server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
        yield running, tab
        tab.close()


def flat(*texts: str) -> str:
    """Texts in one line, as paragraphs are laid out anew on every screen."""
    return " ".join(" ".join(texts).split())


def sees(tab: Tab, *texts: str) -> None:
    """Waits until the page shows these texts, and nothing else."""
    tab.wait(f"{SHOWN}.split(/\\s+/).filter(Boolean).join(' ') === {flat(*texts)!r}")


def left_over_of_form(tab: Tab, *texts: str) -> str:
    """What a form shows besides some texts."""
    tab.wait("document.querySelector('.study').dataset.kind === 'form'")
    return left_over(flat(tab.evaluate(SHOWN)), *texts)


def left_over(shown: str, *texts: str) -> str:
    """What a page shows besides some texts."""
    for text in sorted(map(flat, texts), key=len, reverse=True):
        shown = shown.replace(text, " ")
    return flat(shown)


def of_item(item: dict[str, Any]) -> list[str]:
    means = [item["low_means"]["en"], item["high_means"]["en"]] if "low_means" in item else []
    return [item["ask"]["en"], *(m["en"] for m in item.get("means", ())), *means]


def introduced(tab: Tab, place: str) -> None:
    """Through the sheet before a new task, and after practice, with its place among the trials."""
    tab.wait("document.querySelector('.study').dataset.kind === 'task'")
    assert f" {place} of " in flat(tab.text())
    assert ENGLISH["practice"] not in flat(tab.text()).replace(place, "")
    tab.tap(ENGLISH["next"])


FIRST = f"{ENGLISH['practice']} · 1"


def test_the_example_study_shows_its_own_texts_and_nothing_else(
    browser: Browser, tmp_path: Path
) -> None:
    design = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
    at_start, at_encoder, _ = (one["text"]["en"] for one in design["instructions"])
    tasks = design["factors"][1]["levels"]
    goals = [f"{ENGLISH[f'task_{task}']} {ENGLISH[f'goal_{task}']}" for task in tasks]
    with session(browser, tmp_path, EXAMPLE.read_text(encoding="utf-8")) as (running, tab):
        sees(tab, design["consent"]["text"]["en"], ENGLISH["decline"], ENGLISH["agree"])
        tab.tap(ENGLISH["agree"])
        asked = [text for item in design["demographics"] for text in of_item(item)]
        words = [ENGLISH[key] for key in ("optional", "next", "back", "done")]
        assert left_over_of_form(tab, *asked, *words) == "( )"
        running.type("s")
        sees(tab, at_start, ENGLISH["next"])
        tab.tap(ENGLISH["next"])
        sees(tab, at_encoder, ENGLISH["next"])
        tab.tap(ENGLISH["next"])
        introduced(tab, FIRST)
        tab.wait(TRIAL)
        tab.wait(f"document.body.innerText.includes({ENGLISH['first_touch']!r})")
        task = next(goal for goal in goals if goal in flat(tab.text()))
        sees(tab, task, ENGLISH["first_touch"])
        tab.touch(PUSHED)
        sees(tab, task)
        # Somebody who makes no progress gets no help, and nobody offers another task or trial.
        while running.player.moments.get(timeout=30.0)[1].time < 11.0:
            pass
        sees(tab, task)
        tab.call("Input.dispatchKeyEvent", type="keyDown", key="?", text="?")
        running.type("s")
        introduced(tab, "2")
        tab.wait(f"document.body.innerText.includes({ENGLISH['first_touch']!r})")
        sees(tab, task, ENGLISH["first_touch"])


def demonstrated(running: OnPage) -> list[bool | None]:
    """Of every attempt that has ended: whether its page had a demonstration."""
    attempts = running.state.attempts
    return [
        a.end["result"].get("demonstrated") for some in attempts.values() for a in some if a.end
    ]


SHOWS = 'shows = ["task", "goal", "demo", "hint", "result"]'


def test_a_design_that_shows_them_has_a_demonstration_a_hint_and_a_result(
    browser: Browser, tmp_path: Path
) -> None:
    text = EXAMPLE.read_text(encoding="utf-8").replace("[trials]", f"[trials]\n{SHOWS}")
    text = text.replace('["box-to-goal", "wrench-turn"]', '["box-to-goal"]')
    text = text.replace("time_limit_s = 30", "time_limit_s = 8")
    task = [ENGLISH[f"{what}_box-to-goal"] for what in ("task", "goal")]
    with session(browser, tmp_path, text) as (running, tab):
        tab.tap(ENGLISH["agree"])
        tab.wait("document.querySelector('.study').dataset.kind === 'form'")
        running.type("s")
        for instruction in tomllib.loads(text)["instructions"][:2]:
            sees(tab, instruction["text"]["en"], ENGLISH["next"])
            tab.tap(ENGLISH["next"])
        introduced(tab, FIRST)
        tab.wait(TRIAL)
        tab.wait(PLAYS_ALONE)
        how = ENGLISH["how_box-to-goal"]
        sees(tab, *task, ENGLISH["demonstration"], how)
        # A page that is loaded anew has it, too.
        tab.reload()
        tab.wait(PLAYS_ALONE)
        tab.touch(PUSHED)
        sees(tab, *task, how)
        tab.wait(f"document.body.innerText.includes({ENGLISH['time_up']!r})")
        shown = flat(tab.text())
        missing = left_over(shown, *task, ENGLISH["time_up"])
        assert missing.startswith("the box is ")
        tab.touch([])
        introduced(tab, "2")
        # The second trial of the task has the words alone.
        tab.wait(f"document.body.innerText.includes({ENGLISH['first_touch']!r})")
        sees(tab, *task, ENGLISH["first_touch"], how)
    assert demonstrated(running)[0] is True
    assert True not in demonstrated(running)[1:]
