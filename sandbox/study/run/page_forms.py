"""Forms on the participant's page, on a tablet or in a browser."""

from __future__ import annotations

import time
from collections.abc import Callable

from models.errors import StudyError
from sandbox.server.protocol import Choice, ItemAnswer, ItemView, Leave
from sandbox.study.design.design import Form, Item
from sandbox.study.run.answers import Answers, Draft, check_answer
from sandbox.study.run.forms import NewTask, Poll
from sandbox.study.run.study_page import TICK, StudyPage, inches


class PageForms:
    """Forms on the page; implements `sandbox.study.run.forms.Forms`.

    Args:
        page: The participant's page.
        paused: Returns True while the experimenter pauses the session.
    """

    def __init__(self, page: StudyPage, paused: Callable[[], bool] = lambda: False) -> None:
        self._page, self._paused = page, paused

    def consent(self, text: str, poll: Poll) -> bool:
        how = self._show_until_left(
            poll, ("yes", "no"), lambda: self._page.show_sheet("consent", text=text)
        )
        return how == "yes"

    def instruct(self, text: str, poll: Poll) -> None:
        self._show_until_left(poll, ("done",), lambda: self._page.show_sheet("text", text=text))

    def introduce(self, task: NewTask, poll: Poll) -> None:
        words = self._page.texts
        place = words["trial_of"].format(number=task.number, count=task.count)
        if task.practice:
            place = f"{words['practice']} · {place}"
        self._show_until_left(
            poll,
            ("done",),
            lambda: self._page.show_sheet(
                "task", task.title, task.goal, note=place, picture=task.picture
            ),
        )

    def rest(self, least: float, poll: Poll) -> None:
        until = time.monotonic() + least

        def show() -> None:
            words = self._page.texts
            self._page.show_sheet(
                "rest",
                title=words["rest"],
                text=words["rest_over"],
                seconds=max(until - time.monotonic(), 0.0),
            )

        self._show_until_left(poll, ("done",), show, until)

    def ask(self, form: Form, language: str, poll: Poll, draft: Draft) -> Answers:
        items = {item.name: item for item in form.items}
        views = [item_view(item, language) for item in form.items]

        def show() -> None:
            self._page.show_sheet(
                "form",
                title=form.title.get(language, ""),
                items=views,
                answers=draft.answers,
                note=self._page.texts.get(f"wording_{form.wording.get(language)}", ""),
            )

        self._page.wait_until_open(poll)
        show()
        try:
            while True:
                self._pause(poll, show)
                for up in self._page.take_inputs():
                    if isinstance(up, ItemAnswer):
                        self._fill(items, up, draft)
                    elif up.how == "done" and self._is_complete(form, draft):
                        return {name: draft.answers.get(name) for name in items}
                time.sleep(TICK)
        finally:
            self._page.wait()

    def _fill(self, items: dict[str, Item], up: ItemAnswer, draft: Draft) -> None:
        """Stores an answer of the page after a check; the page may send any value."""
        item = items.get(up.item)
        if item is None:
            return
        try:
            value = check_answer(item, up.value)
        except StudyError as error:
            self._page.reject_answer(item.name, self._rejection(item))
            self._page.say(f"rejected an answer: {error}")
            return
        if draft.answers.get(item.name) != value:
            # The sheet is updated first, for a page that reconnects, since the disk may be slow.
            self._page.update_sheet(answers={**draft.answers, item.name: value})
            draft.store(item.name, value)

    def _is_complete(self, form: Form, draft: Draft) -> bool:
        """Returns True if all required items are answered; else marks the first missing one."""
        missing = [i for i in form.items if not i.optional and draft.answers.get(i.name) is None]
        if missing:
            self._page.reject_answer(missing[0].name, self._page.texts["required"])
        return not missing

    def _pause(self, poll: Poll, show: Callable[[], None]) -> None:
        """Executes the experimenter's commands, and hides the sheet while the session is paused."""
        poll()
        if not self._paused():
            return
        self._page.wait("paused")
        while self._paused():
            time.sleep(TICK)
            self._page.check_connection()
            poll()
        show()

    def _rejection(self, item: Item) -> str:
        if item.kind in ("scale", "number"):
            return self._page.texts["number"].format(low=f"{item.low:g}", high=f"{item.high:g}")
        return self._page.texts["required"]

    def _show_until_left(
        self, poll: Poll, ways: tuple[str, ...], show: Callable[[], None], until: float = 0.0
    ) -> str:
        """Shows a sheet until the participant leaves it in one of `ways`, and returns this way.

        Attempts to leave it before the monotonic time `until` (s) are ignored.
        """
        self._page.wait_until_open(poll)
        show()
        try:
            while True:
                self._pause(poll, show)
                left = until - time.monotonic()
                for up in self._page.take_inputs():
                    if isinstance(up, Leave) and up.how in ways and left <= 0.0:
                        return up.how
                if left > 0.0:
                    self._page.update_sheet(seconds=left)
                time.sleep(TICK)
        finally:
            self._page.wait()


def measure_screens(page: StudyPage, poll: Poll) -> None:
    """Waits until the experimenter has measured the screens of all pages with a bank card.

    Screens that are measured, or whose guessed size was accepted, are left out. The function is
    called between steps: before the consent form, and when another device has become a page.

    Args:
        page: The participant's page; the page of the second hand is measured, too.
        poll: See `Poll`.
    """
    page.wait_until_open(poll)
    for each in page.pages:
        if not each.is_unmeasured:
            continue
        each.say(
            f"measure the screen of {each.whose} with a bank card, before the participant gets it; "
            "the key s skips this and uses a guessed size"
        )
        each.show_sheet("measure", text=each.texts["wait"])
        try:
            while not any(isinstance(up, Leave) for up in each.take_inputs()):
                poll()
                time.sleep(TICK)
        finally:
            each.leave_guessed()
            each.wait()
        screen = each.server.screen
        if screen is not None:
            guess = "" if screen.calibrated else " (a guess)"
            each.say(f"the screen of {each.whose} is {inches(screen)}{guess}")


def item_view(item: Item, language: str) -> ItemView:
    """Converts a question to the message for the page."""
    ends = [end.get(language, "") for end in item.ends] if item.ends else ["", ""]
    choices = [Choice(choice, item.called(choice, language)) for choice in item.choices]
    return ItemView(
        item.name,
        item.kind,  # type: ignore[arg-type]
        item.ask.get(language, ""),
        item.optional,
        choices,
        item.low,
        item.high,
        item.step,
        *ends,
    )
