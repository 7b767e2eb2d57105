"""A whole session on the page of a real browser, with pages closed and the program killed in it."""

from __future__ import annotations

import csv
import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sandbox.recording.recording import load_recording
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.run.runner import SessionOutcome
from sandbox.trial.replay import replay
from sandbox.words import words_in
from tests.sandbox.server.test_page_server import wait_for
from tests.sandbox.study.study_on_page import (
    HEIGHT,
    KNOWN,
    PPI,
    SMALL,
    WIDTH,
    on_page,
    play,
    study_in,
)
from tests.support.chromium import BINARY, Browser, Tab

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

SCENE = "document.querySelector('.study').dataset.kind === 'none'"
GERMAN = words_in("de")
PICTURE = (
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGA"
    "WjR9awAAAABJRU5ErkJggg=="
)
"""A picture of one pixel."""


def opened(browser: Browser, url: str) -> Tab:
    return browser.open(url, width=WIDTH, height=HEIGHT, storage=KNOWN)


def sees(tab: Tab, kind: str) -> None:
    """Waits for a kind of sheet."""
    tab.wait(f"document.querySelector('.study').dataset.kind === {kind!r}")


def type_in(tab: Tab, field: str, text: str) -> None:
    """Types into a field as people do, key by key."""
    tab.wait(f"!!document.querySelector({field!r})")
    tab.evaluate(f"document.querySelector({field!r}).focus()")
    tab.call("Input.insertText", text=text)


def go_on(tab: Tab, unless: str = "true") -> None:
    """To the next page of a form, or out of it; how much is on a page is up to the screen."""
    tab.evaluate(f"if ({unless}) document.querySelector('.go-on').click()")


def pull(tab: Tab, share: float) -> None:
    """A finger on a scale's line, at a share of its length."""
    tab.wait("!!document.querySelector('.track')")
    left, top, width, height = tab.evaluate(
        "(() => { const b = document.querySelector('.track').getBoundingClientRect();"
        "return [b.left, b.top, b.width, b.height] })()"
    )
    y = top + height / 2
    tab.touch([(1, left + 0.1 * width, y)])
    tab.touch([(1, left + share * width, y)])
    tab.touch([])


@pytest.fixture
def limit() -> int:
    """s of a trial."""
    return 5


@pytest.fixture
def study(tmp_path: Path, limit: int) -> StudyFolder:
    return study_in(tmp_path, SMALL.replace("time_limit_s = 20", f"time_limit_s = {limit}"))


@pytest.fixture
def person(study: StudyFolder) -> Participant:
    return study.add(hand="right", hand_size=1.0, language="de")


@pytest.mark.parametrize("limit", [5, pytest.param(30, marks=pytest.mark.full)])
def test_a_participant_goes_through_a_study_with_two_pages_closed_in_it(
    browser: Browser, study: StudyFolder, person: Participant, limit: int
) -> None:
    with on_page(study, person) as running:
        tab = opened(browser, running.server.url)
        sees(tab, "consent")
        assert tab.evaluate("document.documentElement.lang") == "de"
        seen = [tab.text()]
        tab.tap(GERMAN["agree"])
        sees(tab, "form")
        # Nothing is answered beforehand, and nothing can be left out.
        assert tab.evaluate("document.querySelectorAll('.chosen, .mark:not([hidden])').length") == 0
        tab.tap(GERMAN["next"])
        tab.wait(f"document.body.innerText.includes({GERMAN['required']!r})")
        # What complains leaves its place empty, so that nothing moves under the finger.
        below = "document.querySelector('.study button.primary').getBoundingClientRect().top"
        before = tab.evaluate(below)
        tab.tap("left")
        tab.wait("document.querySelectorAll('.wrong.answered').length === 1")
        assert tab.evaluate(below) == before
        go_on(tab)
        type_in(tab, ".entry", "7")
        tab.wait("document.body.innerText.includes('18 bis 100')")
        seen.append(tab.text())
        # The page is closed in the middle of the form, and another one opened.
        tab.close()
        tab = opened(browser, running.server.url)
        sees(tab, "form")
        type_in(tab, ".entry", "33")
        go_on(tab)
        tab.tap("7")
        tab.tap(GERMAN["back"])
        tab.wait("document.querySelector('.entry').value === '33'")
        go_on(tab)
        tab.wait("document.querySelector('.chosen').textContent === '7'")
        go_on(tab, "!document.querySelector('textarea')")
        type_in(tab, "textarea", " schön\nhier ")
        go_on(tab)
        sees(tab, "text")
        tab.tap(GERMAN["next"])
        sees(tab, "task")
        tab.tap(GERMAN["next"])
        tab.wait(SCENE)
        play(running, tab, lambda snapshot: snapshot.time > 0.5)
        # The page is closed in the middle of the trial; time stands still until it is back.
        tab.close()
        running.heard("page is gone")
        tab = opened(browser, running.server.url)
        running.heard("page is back")
        tab.wait(SCENE)
        seen.append(tab.text())
        play(running, tab)
        sees(tab, "task")
        tab.tap(GERMAN["next"])
        running.heard("trial 2")
        tab.wait(SCENE)
        play(running, tab)
        sees(tab, "form")
        pull(tab, 0.8)
        tab.tap(GERMAN["done"])
        sees(tab, "end")
        seen.append(tab.text())
        assert running.ended() is SessionOutcome.COMPLETE
        assert not tab.events("Runtime.exceptionThrown")
        tab.close()
    told = {r["item"]: r["answer"] for r in running.rows("answers.csv")}
    assert told == {
        "handedness": "left",
        "age": "33",
        "tablets": "7",
        "remarks": "schön\nhier",
        "effort": "80",
    }
    trials = running.rows("trials.csv")
    assert [(r["practice"], r["counted"], r["attempt"]) for r in trials] == [
        ("1", "1", "1"),
        ("0", "1", "1"),
    ]
    # Hands at real time, through a browser that draws in software: they need time to succeed.
    assert limit == 5 or any(r["success"] == "1" for r in trials)
    assert all(float(r["first_contact_s"]) < 1.0 for r in trials)
    for row in trials:
        path = running.study.path / row["recording"]
        _, found = replay(load_recording(path))
        assert found.exact and found.complete
    for text in seen:
        # No debugging, no menus, no other language.
        assert not re.search(r"\bms\b|Tasks|Again|Sound|hand\b|mm|guessed|Connect", text), text


def test_a_page_that_is_reloaded_in_mid_trial_comes_back_into_it(
    browser: Browser, study: StudyFolder, person: Participant
) -> None:
    with on_page(study, person) as running:
        tab = opened(browser, running.server.url)
        sees(tab, "consent")
        tab.tap(GERMAN["agree"])
        sees(tab, "form")
        running.type("s")
        sees(tab, "text")
        tab.tap(GERMAN["next"])
        sees(tab, "task")
        tab.tap(GERMAN["next"])
        tab.wait(SCENE)
        play(running, tab, lambda snapshot: snapshot.time > 0.3)
        tab.call("Input.dispatchKeyEvent", type="keyDown", key="F5", code="F5")
        tab.wait("performance.now() < 20000 && " + SCENE)
        tab.wait("document.querySelector('.task').textContent === 'Die Kiste'")
        tab.touch([(1, 300.0, 200.0)])
        assert wait_for(lambda: running.page.device is not None and running.page.device.touched)
        tab.touch([])
        tab.close()
    attempts = running.state.attempts
    assert [len(some) for some in attempts.values()] == [1]


def test_a_screen_is_measured_by_the_experimenter_and_a_new_task_has_its_place_and_picture(
    browser: Browser, study: StudyFolder, person: Participant
) -> None:
    with on_page(study, person) as running:
        running.pictures = {"box-to-goal": PICTURE}
        unknown = {name: KNOWN[name] for name in KNOWN if "px-per-inch" not in name}
        tab = browser.open(running.server.url, width=WIDTH, height=HEIGHT, storage=unknown)
        sees(tab, "measure")
        assert GERMAN["agree"] not in tab.text()
        tab.evaluate(
            f"(() => {{ const s = document.querySelector('.slider'); s.value = {PPI};"
            "s.dispatchEvent(new Event('input')) })()"
        )
        tab.tap(GERMAN["card_fits"])
        sees(tab, "consent")
        # Nothing is over the consent form.
        assert tab.evaluate("document.querySelector('.veil') === null")
        running.heard("the screen of the participant's page is")
        tab.tap(GERMAN["agree"])
        sees(tab, "form")
        running.type("s")
        sees(tab, "text")
        tab.tap(GERMAN["next"])
        sees(tab, "task")
        for words in ("1 von 2", "Die Kiste", "Schieben Sie sie ans Ziel."):
            assert words in tab.text()
        tab.wait("document.querySelector('.task-picture').naturalWidth === 1")
        tab.tap(GERMAN["next"])
        tab.wait(SCENE)
        assert not tab.events("Runtime.exceptionThrown")
        tab.close()
    records = read_journal(running.folder / "session.jsonl")
    seen = [(r["event"], r["calibrated"]) for r in records if r["kind"] == "screen"]
    assert seen[:2] == [("open", False), ("changed", True)]
    assert "Chrome" in next(r["browser"] for r in records if r["kind"] == "screen")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Program:
    """`sandbox study run` in a process of its own."""

    def __init__(self, folder: Path, participant: str, port: int) -> None:
        self._said = folder / "said.txt"
        with self._said.open("w") as said:
            self._process = subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    "sandbox.cli.main",
                    "study",
                    "run",
                    str(folder / "design.toml"),
                    "--participant",
                    participant,
                    "--out",
                    str(folder),
                    "--device",
                    "web",
                    "--language",
                    "de",
                    "--resume",
                    "--page-port",
                    str(port),
                ],
                stdin=subprocess.PIPE,
                stdout=said,
                stderr=subprocess.STDOUT,
                text=True,
                env={**os.environ, "XDG_CONFIG_HOME": str(folder), "HOME": str(folder)},
            )

    def says(self, pattern: str, seconds: float = 30.0) -> str:
        """Waits for words on the terminal."""
        end = time.monotonic() + seconds
        while not (found := re.search(pattern, self._said.read_text())):
            assert time.monotonic() < end, self._said.read_text()
            time.sleep(0.05)
        return found[1]

    def type(self, line: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def kill(self) -> None:
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()

    def ended(self) -> int:
        return self._process.wait(30.0)


def test_the_program_is_killed_in_a_form_and_the_open_page_goes_on_with_it(
    browser: Browser, tmp_path: Path
) -> None:
    (tmp_path / "design.toml").write_text(SMALL, encoding="utf-8")
    port = free_port()
    program = Program(tmp_path, "new", port)
    try:
        url = program.says(r"open (http\S+)")
        ppid = program.says(r"participant (\w+);")
        tab = opened(browser, url)
        sees(tab, "consent")
        tab.tap(GERMAN["agree"])
        tab.tap("both")
        go_on(tab)
        type_in(tab, ".entry", "51")
        journal = tmp_path / "on-page" / ppid / "S001" / "session.jsonl"
        assert wait_for(lambda: '"answer":51' in journal.read_text().replace(" ", ""))
        program.kill()
        tab.wait(f"document.querySelector('.curtain').innerText === {GERMAN['lost']!r}")
        tab.wait("!document.querySelector('.curtain').hidden")
        program = Program(tmp_path, ppid, port)
        # The same page finds back by itself, with what was filled in.
        tab.wait("document.querySelector('.curtain').hidden", 30.0)
        sees(tab, "form")
        tab.tap("3")
        go_on(tab, "!document.querySelector('textarea')")
        go_on(tab)
        sees(tab, "text")
        program.type("q enough")
        assert program.ended() == 0
        tab.close()
    finally:
        program.kill()
    table = tmp_path / "on-page" / "tables/answers.csv"
    found = {r["item"]: r["answer"] for r in csv.DictReader(table.open(encoding="utf-8"))}
    assert found == {"handedness": "both", "age": "51", "tablets": "3", "remarks": ""}
