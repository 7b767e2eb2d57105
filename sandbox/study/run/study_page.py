"""The participant's page during a session: current sheet, connection and inputs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import msgspec

from sandbox.server.page_server import PageServer
from sandbox.server.protocol import (
    LIFT_STRIP_PX,
    ItemAnswer,
    ItemView,
    Leave,
    PageScreen,
    Refusal,
    Sheet,
    StudyView,
)
from sandbox.server.screen import room
from sandbox.server.web import WebDevice
from sandbox.study.design.design import PageSettings
from sandbox.study.run.players import PlayedAttempt, TrialPlayer, TrialRequest
from sandbox.words import words_in

SLACK = 0.02
"""Share by which a screen may be smaller than the touch rectangle, since the screen is measured by
hand, with a bank card."""
TICK = 0.02
"""Time (s) between two checks of inputs of the participant and the experimenter."""
GONE = 3.0
"""Time (s) without a message after which the page counts as gone. A page sends two messages a
second."""

Given = str | float | None


class StudyPage:
    """The page of a participant, which shows forms and trials during a whole session.

    Args:
        server: Server of the page.
        language: Language of the participant.
        say: Prints a line for the experimenter.
        own: The design's own words in this language, by key.
        whose: Name of the page in lines for the experimenter.

    Attributes:
        server: Server of the page.
        whose: Name of the page in lines for the experimenter.
        texts: Texts of the page in the participant's language, by key.
        beside: Page of the second hand, for trials with two hands; None without one. It shows no
            forms.
        device: Device of the running trial; None if it does not use the page.
        needed_in: Size of the touch rectangle that trials need, inches; None for any size.
        needed_lifts: True if a trial also needs the lift control next to the touch rectangle.
        record: Function that records that the page was opened, was lost, came back or changed its
            size.
    """

    def __init__(
        self,
        server: PageServer,
        language: str,
        say: Callable[[str], object] = lambda text: None,
        own: dict[str, str] | None = None,
        whose: str = "the participant's page",
    ) -> None:
        self.server, self.say, self.whose = server, say, whose
        self.texts = words_in(language, own)
        self.device: WebDevice | None = None
        self.beside: StudyPage | None = None
        self.needed_in: tuple[float, float] | None = None
        self.needed_lifts = False
        self.record: Callable[..., object] = lambda **values: None
        self._recorded: PageScreen | None = None
        self._measured_at = -1
        self._screen: PageScreen | None = None
        self._small = self._went_on = False
        self._sheet = Sheet(0, "wait", "", self.texts["wait"], [], {}, 0.0)
        self._gone = False
        self._came = False
        self.wait()

    @property
    def pages(self) -> tuple[StudyPage, ...]:
        """This page, and the page of the second hand if there is one."""
        return (self,) if self.beside is None else (self, self.beside)

    def show_sheet(
        self,
        kind: str,
        title: str = "",
        text: str = "",
        items: Sequence[ItemView] = (),
        answers: dict[str, Given] | None = None,
        seconds: float = 0.0,
        note: str = "",
        picture: str = "",
    ) -> None:
        """Shows a sheet to the participant, which replaces the previous one."""
        self._sheet = Sheet(
            self._sheet.sheet + 1,
            kind,  # type: ignore[arg-type]
            title,
            text,
            list(items),
            dict(answers or {}),
            seconds,
            note,
            picture,
        )
        self.server.show_sheet(self._sheet)

    def wait(self, word: str = "wait") -> None:
        """Shows a text while the participant has to wait."""
        self.show_sheet("wait", text=self.texts[word])

    def hide_sheet(self) -> None:
        """Hides the sheet, so that the scene is visible."""
        self.show_sheet("none")

    def update_sheet(
        self, answers: dict[str, Given] | None = None, seconds: float | None = None
    ) -> None:
        """Updates the sheet for a page that reconnects. The open page already shows the update."""
        values: dict[str, object] = {}
        if answers is not None:
            values["answers"] = dict(answers)
        if seconds is not None:
            values["seconds"] = seconds
        self._sheet = msgspec.structs.replace(self._sheet, **values)
        self.server.show_sheet(self._sheet, tell=False)

    def reject_answer(self, item: str, text: str) -> None:
        """Shows the reason why an answer is not accepted."""
        self.server.refuse(Refusal(self._sheet.sheet, item, text))

    def take_inputs(self) -> list[ItemAnswer | Leave]:
        """Returns the participant's unchecked inputs on this sheet since the last call.

        Inputs on an earlier sheet are ignored.
        """
        inputs = [up for up in self.server.take_inputs() if up.sheet == self._sheet.sheet]
        self._went_on = self._went_on or bool(inputs)
        self.check_connection()
        return inputs

    def use_device(self, device: WebDevice) -> WebDevice:
        """Sets the device of the running trial, and returns it."""
        self.device = device
        return device

    @property
    def gone(self) -> bool:
        """True if the page has sent no message for `GONE` seconds."""
        return self._gone

    def check_connection(self) -> None:
        """Checks the connection to the page, and prints changes for the experimenter."""
        silent = self.server.silence
        if (silent > GONE) != self._gone:
            self._gone = silent > GONE
            if self._came and self._gone:
                self.say(f"{self.whose} is gone; reload it, or open it again")
                self._note_screen("gone")
            elif self._came:
                self.say(f"{self.whose} is back")
                self._note_screen("back")
        if silent <= GONE and not self._came:
            self._came = True
            self.say(f"{self.whose} is open")
            self._note_screen("open")
        if self._came and self.server.screen != self._recorded:
            self._note_screen("changed")
        self._check_screen()
        if self.beside is not None:
            self.beside.check_connection()

    def _note_screen(self, event: str) -> None:
        """Records a change of the page, with its screen."""
        screen = self._recorded = self.server.screen
        about = {} if screen is None else msgspec.structs.asdict(screen)
        about.pop("fit", None)
        self.record(page=self.whose, event=event, **about, browser=self.server.browser)

    @property
    def is_unmeasured(self) -> bool:
        """True if the size of this page's screen is a guess that was not accepted yet."""
        screen = self.server.screen
        known = screen is None or screen.calibrated
        return not known and self._measured_at != self.server.seated

    def leave_guessed(self) -> None:
        """Accepts the guessed size of this screen, until another device becomes this page."""
        if self.is_unmeasured:
            self._measured_at = self.server.seated

    def _check_screen(self) -> None:
        """Prints for the experimenter that the screen is too small for the trials, or that it has
        become large enough.

        A guessed size is checked only after the first input on the page, since the screen may be
        measured until then.
        """
        screen, wanted = self.server.screen, self.needed_in
        if wanted is None or screen is None or screen == self._screen:
            return
        if not (screen.calibrated or self._went_on):
            return
        self._screen = screen
        before, self._small = self._small, is_too_small(screen, wanted, self.needed_lifts)
        if self._small:
            known = "" if screen.calibrated else " (a guess, since it was not measured)"
            self.say(
                f"the screen of {self.whose} is too small for the trials: it has "
                f"{inches(screen)}{known}, and the design's touch rectangle "
                f"{wanted[0]:g} x {wanted[1]:g} in{lift_size_note(self.needed_lifts)}. "
                "Rotate it, use a larger one, or make the design's `surface` smaller"
            )
        elif before:
            self.say(f"the screen of {self.whose} is large enough for the trials now")

    def wait_until_open(self, poll: Callable[[], None]) -> None:
        """Waits until the page is open.

        Args:
            poll: Called repeatedly meanwhile; its exceptions are passed on.
        """
        announced = False
        while True:
            poll()
            self.check_connection()
            if not self._gone:
                return
            if not announced:
                self.say(f"waiting for {self.whose}")
                announced = True
            time.sleep(TICK)


def is_too_small(screen: PageScreen, wanted: tuple[float, float], lifts: bool = False) -> bool:
    """Returns True if a screen is too small for a touch rectangle, inches.

    With `lifts`, the lift control needs a place next to the rectangle.
    """
    return any(r < w * (1.0 - SLACK) for r, w in zip(room(screen, lifts), wanted, strict=True))


def lift_size_note(lifts: bool) -> str:
    """Text after a size, on the room for the lift control; empty if no lift control is needed."""
    return f", and the lift control needs {LIFT_STRIP_PX:g} pixels of its width" if lifts else ""


def inches(screen: PageScreen) -> str:
    """Size of a screen as text, inches."""
    width, height = screen.width_px / screen.px_per_in, screen.height_px / screen.px_per_in
    return f"{width:.2f} x {height:.2f} in"


class OffPagePlayer:
    """Runs trials outside of the page. The page shows a text meanwhile.

    Args:
        player: Player in a window or in another program.
        page: The participant's page, which shows the forms.
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


def study_view(page: PageSettings, language: str) -> StudyView:
    """Message that sets up a page for a study, in a participant's language."""
    return StudyView(language, page.words.get(language, {}), list(page.shows))
