"""A participant's page: what lies on it now, who is there, and what they did with it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import msgspec

from sandbox.server.page_server import PageServer
from sandbox.server.protocol.protocol import (
    Answer,
    ItemView,
    Leave,
    Refusal,
    Screen,
    Sheet,
    StudyView,
)
from sandbox.server.web import WebDevice
from sandbox.study.run.page_texts import texts_in
from sandbox.study.run.players import PlayedAttempt, TrialPlayer, TrialRequest

SLACK = 0.02
"""Share by which a screen may be smaller than the touch rectangle: bank cards are held by hand."""
TICK = 0.02
"""s between two looks at what the participant and the experimenter want."""
GONE = 3.0
"""s without a word from the page, which beats twice a second, after which it is gone."""

Given = str | float | None


class StudyPage:
    """One page for a whole session, and the same for forms and for trials.

    Args:
        server: Of the page, opened for a study.
        language: The participant's.
        say: Tells the experimenter something.

    Attributes:
        server: As given.
        words: In the participant's language.
        device: Of the trial that runs; see `opened`.
        wanted: Inches of the touch rectangle that trials want of the page's screen; None: any.
    """

    def __init__(
        self, server: PageServer, language: str, say: Callable[[str], object] = lambda text: None
    ) -> None:
        self.server, self.say = server, say
        self.words = texts_in(language)
        self.device: WebDevice | None = None
        self.wanted: tuple[float, float] | None = None
        self._screen: Screen | None = None
        self._sheet = Sheet(0, "wait", "", self.words["wait"], [], {}, 0.0)
        self._gone = False
        self._came = False
        self.wait()

    def lay(
        self,
        kind: str,
        title: str = "",
        text: str = "",
        items: Sequence[ItemView] = (),
        answers: dict[str, Given] | None = None,
        seconds: float = 0.0,
    ) -> None:
        """Puts a sheet before the participant, in place of what was there."""
        self._sheet = Sheet(
            self._sheet.sheet + 1,
            kind,  # type: ignore[arg-type]
            title,
            text,
            list(items),
            dict(answers or {}),
            seconds,
        )
        self.server.lay(self._sheet)

    def wait(self, word: str = "wait") -> None:
        """Nothing to do for the moment."""
        self.lay("wait", text=self.words[word])

    def reveal(self) -> None:
        """The scene is seen."""
        self.lay("none")

    def keep(self, answers: dict[str, Given] | None = None, seconds: float | None = None) -> None:
        """What a page that comes back is to show of the sheet; the present one knows it."""
        values: dict[str, object] = {}
        if answers is not None:
            values["answers"] = dict(answers)
        if seconds is not None:
            values["seconds"] = seconds
        self._sheet = msgspec.structs.replace(self._sheet, **values)
        self.server.lay(self._sheet, tell=False)

    def refuse(self, item: str, text: str) -> None:
        """Says why an answer is none."""
        self.server.refuse(Refusal(self._sheet.sheet, item, text))

    def done(self) -> list[Answer | Leave]:
        """What the participant did with the sheet since the last call; not checked.

        What was meant for an earlier sheet is passed over.
        """
        self.look()
        return [up for up in self.server.filled() if up.sheet == self._sheet.sheet]

    def opened(self, device: WebDevice) -> WebDevice:
        """Remembers the device of a trial."""
        self.device = device
        return device

    @property
    def gone(self) -> bool:
        """Whether nothing has been heard of the page for so long that nobody can be there."""
        return self._gone

    def look(self) -> None:
        """Sees whether the page is there, and tells the experimenter when that changes."""
        silent = self.server.silence
        if (silent > GONE) != self._gone:
            self._gone = silent > GONE
            if self._came and self._gone:
                self.say("the participant's page is gone; it comes back, or is opened anew")
            elif self._came:
                self.say("the participant's page is back")
        if silent <= GONE and not self._came:
            self._came = True
            self.say("the participant's page is open")
        self._look_at_screen()

    def _look_at_screen(self) -> None:
        """Tells early that trials will be refused, while nobody has done any."""
        screen, wanted = self.server.screen, self.wanted
        if wanted is None or screen is None or screen == self._screen:
            return
        self._screen = screen
        if lacks_room(screen, wanted):
            known = "" if screen.calibrated else ", by a guess, for it was not measured"
            self.say(
                f"this screen is too small for the trials: it has {inches(screen)}{known}, and the "
                f"design's touch rectangle {wanted[0]:g} x {wanted[1]:g} in. "
                "Turn it, or take a larger one"
            )

    def await_somebody(self, ready: Callable[[], None]) -> None:
        """Waits until the page is open; `ready` is called meanwhile, and may raise."""
        told = False
        while True:
            ready()
            self.look()
            if not self._gone:
                return
            if not told:
                self.say("waiting for the participant's page")
                told = True
            time.sleep(TICK)


def lacks_room(screen: Screen, wanted: tuple[float, float]) -> bool:
    """Whether a touch rectangle of so many inches does not go onto a screen."""
    room = screen.width_px / screen.px_per_in, screen.height_px / screen.px_per_in
    return any(r < w * (1.0 - SLACK) for r, w in zip(room, wanted, strict=True))


def inches(screen: Screen) -> str:
    """How large a screen is, for a person."""
    width, height = screen.width_px / screen.px_per_in, screen.height_px / screen.px_per_in
    return f"{width:.2f} x {height:.2f} in"


class OffPagePlayer:
    """A player whose trials are elsewhere: the page says so meanwhile.

    Args:
        player: In a window, or seen by another program.
        page: The participant's, for forms.
    """

    def __init__(self, player: TrialPlayer, page: StudyPage) -> None:
        self._player, self._page = player, page

    def play(self, request: TrialRequest) -> PlayedAttempt:
        """See `sandbox.study.run.players.TrialPlayer`."""
        self._page.wait("elsewhere")
        try:
            return self._player.play(request)
        finally:
            self._page.wait()

    def close(self) -> None:
        """Closes the player."""
        self._player.close()


def study_view(language: str, shows: Sequence[str]) -> StudyView:
    """What a page has to know that it is a study's."""
    return StudyView(language, texts_in(language), list(shows))
