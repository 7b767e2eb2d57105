"""Forms and trials on the participant's page, as a plain client of its protocol sees them."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import StudyError
from sandbox.server import clients
from sandbox.study.design.design import Item
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.run.answers import check_answer
from sandbox.study.run.runner import SessionOutcome
from sandbox.words import words_in
from tests.sandbox.server.test_page_server import wait_for
from tests.sandbox.study.study_on_page import SMALL, OnPage, on_page, study_in, touch
from tests.support.page_client import Page
from tests.support.processes import PATIENCE

SCREEN = {"px_per_in": 100.0, "width_px": 1000.0, "height_px": 700.0, "calibrated": True}
QUICK = SMALL.replace('"box-to-goal"\nsurface', '"tests/support/regress_tasks.py:Quick"\nsurface')
"""Trials that are over in a blink."""


@pytest.fixture
def study(tmp_path: Path) -> StudyFolder:
    return study_in(tmp_path, QUICK)


@pytest.fixture
def person(study: StudyFolder) -> Participant:
    return study.add(hand="right", hand_size=1.0, language="de")


@pytest.fixture
def running(study: StudyFolder, person: Participant) -> Iterator[OnPage]:
    with on_page(study, person) as running:
        yield running


def opened(running: OnPage, name: str = "tablet", role: str = "player") -> Page:
    return Page(running.server.url, name=name, role=role, screen=dict(SCREEN), beats=True)


def answer(page: Page, sheet: dict[str, Any], item: str, value: object) -> None:
    page.say(type="answer", sheet=sheet["sheet"], item=item, value=value)


def leave(page: Page, sheet: dict[str, Any], how: str = "done") -> None:
    page.say(type="leave", sheet=sheet["sheet"], how=how)


def agreed(page: Page) -> dict[str, Any]:
    """Through the consent; the first form."""
    leave(page, page.until("sheet", kind="consent"), "yes")
    return page.until("sheet", kind="form")


def drafts(running: OnPage) -> dict[str, Any]:
    """What is written down of forms that are still open."""
    records = read_journal(running.folder / "session.jsonl")
    return {r["item"]: r["answer"] for r in records if r["kind"] == "answer"}


def trial(page: Page) -> None:
    """Touches once, when the scene is there, and until it is over."""
    page.until("sheet", kind="none")
    page.touch((1, 5.0, 3.0))
    page.until("sheet", kind="wait")
    page.touch()


def test_a_whole_session_is_asked_and_played_on_the_page(running: OnPage) -> None:
    with opened(running) as page:
        welcome = page.until("welcome")
        assert welcome["study"]["language"] == "de" and not welcome["study"]["words"]
        form = agreed(page)
        assert [i["kind"] for i in form["items"]] == ["choice", "number", "scale", "text"]
        assert form["items"][0]["ask"] == "Mit welcher Hand schreiben Sie?"
        assert form["answers"] == {}
        for item, value in (("handedness", "left"), ("age", 33), ("tablets", 7)):
            answer(page, form, item, value)
        leave(page, form)
        text = page.until("sheet", kind="text")
        assert text["text"] == "Schieben Sie die Kiste."
        leave(page, text)
        new = page.until("sheet", kind="task")
        assert (new["title"], new["text"]) == ("Quick", "Every third seed fails.")
        assert new["note"] == "Übung · 1 von 2"
        leave(page, new)
        scene = page.until("scene")
        assert (scene["task"], scene["goal"]) == ("Quick", "Every third seed fails.")
        trial(page)
        counted = page.until("sheet", kind="task")
        assert counted["note"] == "2 von 2"
        leave(page, counted)
        trial(page)
        last = page.until("sheet", kind="form")
        assert last["title"] == "Zu dem, was Sie gerade getan haben"
        answer(page, last, "effort", 85)
        leave(page, last)
        assert page.until("sheet", kind="end")["text"] == words_in("de")["end"]
    assert running.ended() is SessionOutcome.COMPLETE
    found = {r["item"]: r["answer"] for r in running.rows("answers.csv")}
    about = {"handedness": "left", "age": "33", "tablets": "7", "remarks": ""}
    assert found == {**about, "effort": "85"}
    trials = running.rows("trials.csv")
    assert [(r["practice"], r["counted"]) for r in trials] == [("1", "1"), ("0", "1")]


def test_what_is_no_answer_is_refused_and_a_form_is_left_only_when_it_is_whole(
    running: OnPage,
) -> None:
    with opened(running) as page:
        form = agreed(page)
        odd: list[tuple[str, object]] = [
            ("handedness", "none of these"),
            ("handedness", 1),
            ("age", 17),
            ("age", "33"),
            ("tablets", 3.5),
            ("tablets", 0),
            ("remarks", 5),
        ]
        for item, value in odd:
            answer(page, form, item, value)
            assert page.until("refusal")["item"] == item
        answer(page, form, "nothing like it", "x")
        answer(page, {"sheet": form["sheet"] + 1}, "age", 50)
        leave(page, form, "yes")
        leave(page, form)
        assert page.until("refusal")["item"] == "handedness"
        assert drafts(running) == {}
        for item, value in (("handedness", "both"), ("age", 18), ("tablets", 1)):
            answer(page, form, item, value)
        # What was answered can be taken back, and is missing again.
        answer(page, form, "age", None)
        leave(page, form)
        assert page.until("refusal")["item"] == "age"
        answer(page, form, "age", 19)
        leave(page, form)
        page.until("sheet", kind="text")
    assert drafts(running) == {"handedness": "both", "age": 19, "tablets": 1}


def test_a_page_that_comes_back_finds_what_was_filled_in(running: OnPage) -> None:
    with opened(running) as page:
        form = agreed(page)
        answer(page, form, "age", 44)
        assert wait_for(lambda: drafts(running) == {"age": 44})
    with opened(running) as page:
        again = page.until("sheet")
        assert again["answers"] == {"age": 44}
        assert {**again, "answers": {}} == form


def test_nobody_looks_over_a_participants_shoulder(running: OnPage) -> None:
    with opened(running) as page, opened(running, "projector", "spectator") as other:
        form = agreed(page)
        answer(page, form, "age", 44)
        answer(other, form, "age", 45)
        assert wait_for(lambda: drafts(running) == {"age": 44})
        leave(other, form)
        other.say(type="beat", t=1.0)
        other.until("echo")
        assert not [m for m in other.told if m["type"] in ("sheet", "refusal")]
    assert running.server.counters["not the player"] == 2


def test_a_participants_page_cannot_ask_for_other_tasks_or_stop_time(running: OnPage) -> None:
    with opened(running) as page:
        agreed(page)
        for what in ("retry", "pause", "task"):
            page.say(type="ask", what=what, value="stack")
        page.say(type="beat", t=1.0)
        page.until("echo")
    assert running.server.take_requests() == []


@pytest.mark.slow
def test_the_experimenter_skips_pauses_and_repeats_while_forms_and_trials_are_on_the_page(
    running: OnPage,
) -> None:
    with opened(running) as page:
        form = agreed(page)
        running.type("p")
        assert page.until("sheet", kind="wait")["text"] == words_in("de")["paused"]
        answer(page, form, "age", 50)
        running.type("p")
        form = page.until("sheet", kind="form")
        assert form["answers"] == {}
        running.type("s late")
        leave(page, page.until("sheet", kind="text"))
        leave(page, page.until("sheet", kind="task"))
        page.until("sheet", kind="none")
        running.type("p")
        page.until("sheet", kind="wait")
        page.touch((1, 5.0, 3.0))
        running.type("p")
        page.until("sheet", kind="none")
        page.touch()
        running.type("r the phone rang")
        trial(page)
        leave(page, page.until("sheet", kind="task"))
        trial(page)
        running.type("r once more")
        trial(page)
        form = page.until("sheet", kind="form")
        running.type("i")
        running.heard("2 of 2 trials")
        running.type("q")
        assert running.ended() is SessionOutcome.STOPPED
    state = running.state
    assert "form:demographics" in state.skipped
    assert [len(some) for some in state.attempts.values()] == [2, 2]
    assert all(state.counted(t) for t in (1, 2))


def test_a_break_lasts_as_long_as_it_has_to(tmp_path: Path) -> None:
    text = QUICK.replace("practice = 1", "practice = 0\nrepetitions = 2")
    study = study_in(tmp_path, text)
    person = study.add(hand="right", hand_size=1.0, language="en")
    with on_page(study, person) as running, opened(running) as page:
        past_the_form(running, page)
        trial(page)
        rest = page.until("sheet", kind="rest")
        laid = time.monotonic()
        leave(page, rest)
        time.sleep(0.3)
        leave(page, rest)
        with opened(running) as again:
            assert 0.0 <= again.until("sheet", kind="rest")["seconds"] < 1.0
            while time.monotonic() - laid < 1.2:
                time.sleep(0.05)
            leave(again, rest)
            again.until("sheet", kind="none")


def to_the_end(page: Page) -> None:
    """Taps until the trial is over, and answers its form."""
    form = tapped_until_form(page)
    answer(page, form, "effort", 5)
    leave(page, form)
    page.until("sheet", kind="end")


def tapped_until_form(page: Page) -> dict[str, Any]:
    """Taps as a person does who sees that nothing goes on: a tap in a pause begins nothing."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        page.touch()
        page.touch((1, 5.0, 3.0))
        tapped = time.monotonic()
        while time.monotonic() - tapped < 1.0:
            try:
                message = page.next(timeout=1.0)
            except TimeoutError:
                break
            if message["type"] == "frame":
                page.say(type="got", frame=message["number"])
            if message["type"] == "sheet" and message["kind"] == "form":
                return message
    raise AssertionError("the trial does not end")


def past_the_form(running: OnPage, page: Page) -> None:
    """Through the consent, past the form, and to the first trial."""
    leave(page, page.until("sheet", kind="consent"), "yes")
    page.until("sheet", kind="form")
    running.type("s")
    leave(page, page.until("sheet", kind="text"))
    leave(page, page.until("sheet", kind="task"))


SLOW = pytest.mark.slow
PAUSED = 4.0
"""s"""


def test_the_time_before_the_first_touch_is_without_the_experimenter_s_pause(
    tmp_path: Path,
) -> None:
    text = SMALL.replace("time_limit_s = 20", "time_limit_s = 1")
    study = study_in(tmp_path, text.replace("practice = 1", "practice = 0"))
    with on_page(study, study.add(hand="right", hand_size=1.0, language="en")) as running:
        with opened(running) as page:
            past_the_form(running, page)
            page.until("sheet", kind="none")
            running.type("p")
            page.until("sheet", kind="wait")
            time.sleep(PAUSED)
            running.type("p")
            shown = time.monotonic()
            touch(page)
            seen = time.monotonic() - shown
            page.until("sheet", kind="form")
            running.type("q")
        running.ended()
    # The scene is seen for a moment before the pause, too.
    assert running.state.counted(1).end["result"]["measures"]["waited_s"] < seen + PAUSED / 2


@pytest.mark.parametrize(
    "when", [pytest.param("pause", marks=SLOW), pytest.param("repeat", marks=SLOW), "mark"]
)
def test_a_tablet_that_is_gone_in_mid_trial_is_told_of_and_nothing_counts_twice(
    tmp_path: Path, when: str
) -> None:
    # Nothing is achieved, so a trial lasts until its time is up.
    text = SMALL.replace("time_limit_s = 20", f'time_limit_s = 5\nwhen_gone = "{when}"')
    study = study_in(tmp_path, text.replace("practice = 1", "practice = 0"))
    with on_page(study, study.add(hand="right", hand_size=1.0, language="en")) as running:
        with opened(running) as page:
            past_the_form(running, page)
            touch(page)
        running.heard("page is gone")
        time.sleep(0.2)
        with opened(running) as page:
            running.heard("page is back")
            page.until("sheet", kind="none")
            to_the_end(page)
        running.ended()
    assert [r["counted"] for r in running.rows("trials.csv")] == ["1"]
    state = running.state
    assert len(state.attempts[1]) == (2 if when == "repeat" else 1)
    measures = state.counted(1).end["result"]["measures"]
    assert measures["waited_s"] >= 0.0
    assert (measures["away_s"] >= 3.0) == (measures["away"] == 1) == (when != "repeat")


def test_another_device_that_becomes_the_participants_page_does_not_finish_their_trial(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "SEAT_TIMEOUT", 0.5)
    text = SMALL.replace("time_limit_s = 20", "time_limit_s = 5")
    study = study_in(tmp_path, text.replace("practice = 1", "practice = 0"))
    with on_page(study, study.add(hand="right", hand_size=1.0, language="en")) as running:
        with opened(running) as page:
            past_the_form(running, page)
            touch(page)
        running.heard("page is gone")
        time.sleep(1.0)
        wide = {**SCREEN, "width_px": 1500.0}
        with Page(running.server.url, name="another", screen=wide, beats=True) as page:
            running.heard("another device became the participant's page")
            to_the_end(page)
        running.ended()
    ended = [attempt.end is not None for attempt in running.state.attempts[1]]
    assert ended == [False, True]


def test_a_screen_without_room_for_the_designs_rectangle_is_refused(
    study: StudyFolder, person: Participant
) -> None:
    with on_page(study, person) as running:
        running.page.needed_in = 9.0, 6.0  # as in the design
        small = {**SCREEN, "width_px": 800.0}
        with Page(running.server.url, screen=small) as page:
            running.heard("too small for the trials: it has 8.00 x 7.00 in, and")
            past_the_form(running, page)
            with pytest.raises(StudyError, match="too small"):
                running.ended(10.0)
    assert not running.state.attempts


def test_the_experimenter_measures_a_screen_before_the_consent_form_and_never_over_one(
    running: OnPage,
) -> None:
    guessed = {**SCREEN, "calibrated": False}
    with Page(running.server.url, name="tablet", screen=guessed, beats=True) as page:
        sheets = [page.until("sheet")["kind"]]
        while sheets[-1] != "measure":
            sheets.append(page.until("sheet")["kind"])
        assert "consent" not in sheets
        running.heard("measure the screen of the participant's page with a bank card")
        page.say(type="resized", screen=dict(SCREEN))
        leave(page, next(m for m in reversed(page.told) if m.get("kind") == "measure"))
        page.until("sheet", kind="consent")
        running.heard("is 10.00 x 7.00 in")
    running.heard("page is gone")
    with Page(running.server.url, name="tablet", screen=guessed, beats=True) as page:
        # Its size is a guess now, which is not measured over the form, but before the next step.
        leave(page, page.until("sheet", kind="consent"), "yes")
        leave(page, page.until("sheet", kind="measure"))
        page.until("sheet", kind="form")
    running.type("q")
    running.ended()
    records = read_journal(running.folder / "session.jsonl")
    seen = [(r["event"], r["calibrated"]) for r in records if r["kind"] == "screen"]
    assert seen == [("open", False), ("changed", True), ("gone", True), ("back", False)]
    assert {"page_gone", "page_back"} <= {row["event"] for row in running.rows("events.csv")}


ANYTHING = st.one_of(st.none(), st.booleans(), st.floats(), st.integers(), st.text(max_size=30))


@given(kind=st.sampled_from(["choice", "scale", "number", "text"]), value=ANYTHING)
def test_whatever_a_page_sends_is_an_answer_of_the_item_or_none(kind: str, value: Any) -> None:
    item = Item("x", kind, {"en": "?"}, choices=("a", "b"), low=0, high=10, step=5)
    try:
        kept = check_answer(item, value)
    except StudyError:
        return
    if kept is None:
        assert value is None or (kind == "text" and not value.strip())
    elif kind == "choice":
        assert kept in item.choices
    elif kind == "text":
        assert kept == value.strip()
    else:
        assert kept == value and 0 <= kept <= 10 and (kind == "number" or kept % 5 == 0)


@given(st.integers(0, 70), st.sampled_from([0.1, 0.25, 0.7, 5.0]), st.integers(-3, 3))
def test_a_scale_has_its_steps_as_they_are_written_and_nothing_between(
    place: int, step: float, low: int
) -> None:
    item = Item("x", "scale", {"en": "?"}, low=low, high=low + 70 * step, step=step)
    # What the page sends is what a person would write.
    told = float(f"{low + place * step:.12g}")
    assert check_answer(item, told) == told
    between = float(f"{low + (place + 0.5) * step:.12g}")
    for wrong in (between, math.nextafter(told, math.inf), -math.inf, math.nan, 10**400):
        with pytest.raises(StudyError):
            check_answer(item, wrong)
