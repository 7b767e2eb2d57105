"""Forms on the participant's page: a tablet or a browser, in their language."""

from __future__ import annotations

import time
from collections.abc import Callable

from models.errors import StudyError
from sandbox.server.protocol.protocol import Answer, Choice, ItemView, Leave
from sandbox.study.design.design import Form, Item
from sandbox.study.run.answers import Answers, Draft, check_answer
from sandbox.study.run.forms import Ready
from sandbox.study.run.study_page import TICK, StudyPage


class PageForms:
    """Implements `sandbox.study.run.forms.Forms`.

    Args:
        page: The participant's.
        paused: Whether the experimenter wants everything to wait.
    """

    def __init__(self, page: StudyPage, paused: Callable[[], bool] = lambda: False) -> None:
        self._page, self._paused = page, paused

    def consent(self, text: str, ready: Ready) -> bool:
        how = self._left(ready, ("yes", "no"), lambda: self._page.lay("consent", text=text))
        return how == "yes"

    def instruct(self, text: str, ready: Ready) -> None:
        self._left(ready, ("done",), lambda: self._page.lay("text", text=text))

    def rest(self, least: float, ready: Ready) -> None:
        until = time.monotonic() + least

        def lay() -> None:
            words = self._page.words
            self._page.lay(
                "rest",
                title=words["rest"],
                text=words["rest_over"],
                seconds=max(until - time.monotonic(), 0.0),
            )

        self._left(ready, ("done",), lay, until)

    def ask(self, form: Form, language: str, ready: Ready, draft: Draft) -> Answers:
        items = {item.name: item for item in form.items}
        views = [item_view(item, language) for item in form.items]

        def lay() -> None:
            self._page.lay(
                "form", title=form.title.get(language, ""), items=views, answers=draft.answers
            )

        self._page.await_somebody(ready)
        lay()
        try:
            while True:
                self._pause(ready, lay)
                for up in self._page.done():
                    if isinstance(up, Answer):
                        self._fill(items, up, draft)
                    elif up.how == "done" and self._whole(form, draft):
                        return {name: draft.answers.get(name) for name in items}
                time.sleep(TICK)
        finally:
            self._page.wait()

    def _fill(self, items: dict[str, Item], up: Answer, draft: Draft) -> None:
        """Takes an answer in, if it is one: what a page says may be anything."""
        item = items.get(up.item)
        if item is None:
            return
        try:
            value = check_answer(item, up.value)
        except StudyError as error:
            self._page.refuse(item.name, self._why(item))
            self._page.say(f"refused: {error}")
            return
        if draft.answers.get(item.name) != value:
            draft.keep(item.name, value)
            self._page.keep(answers=draft.answers)

    def _whole(self, form: Form, draft: Draft) -> bool:
        """Whether everything that has to be answered is."""
        missing = [i for i in form.items if not i.optional and draft.answers.get(i.name) is None]
        if missing:
            self._page.refuse(missing[0].name, self._page.words["required"])
        return not missing

    def _pause(self, ready: Ready, lay: Callable[[], None]) -> None:
        """Hears the experimenter; takes the sheet away for as long as they pause."""
        ready()
        if not self._paused():
            return
        self._page.wait("paused")
        while self._paused():
            time.sleep(TICK)
            self._page.look()
            ready()
        lay()

    def _why(self, item: Item) -> str:
        if item.kind in ("scale", "number"):
            return self._page.words["number"].format(low=f"{item.low:g}", high=f"{item.high:g}")
        return self._page.words["required"]

    def _left(
        self, ready: Ready, ways: tuple[str, ...], lay: Callable[[], None], until: float = 0.0
    ) -> str:
        """Lays a sheet, and tells how it is left; not before a time."""
        self._page.await_somebody(ready)
        lay()
        try:
            while True:
                self._pause(ready, lay)
                left = until - time.monotonic()
                for up in self._page.done():
                    if isinstance(up, Leave) and up.how in ways and left <= 0.0:
                        return up.how
                if left > 0.0:
                    self._page.keep(seconds=left)
                time.sleep(TICK)
        finally:
            self._page.wait()


def item_view(item: Item, language: str) -> ItemView:
    """A question as the page gets it."""
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
