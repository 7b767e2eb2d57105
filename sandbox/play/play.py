"""What play in a window and on pages share: the player's requests, settings and views."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rich.console import Console

from models.person import HANDS
from sandbox.play.own_profile import Learner
from sandbox.play.reports import NoticePrinter
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PlayerRequest
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import View
from sandbox.trial.events import EventLog, NoticeEvents
from sandbox.trial.latency import Timing
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import TASKS, find_task


@dataclass
class PlayerRequests:
    """The person's requests for this trial and the next one.

    Attributes:
        task: Name, or place of a task of the player's own.
        sides: `right` or `left`, of every hand.
        trial: Number of trials so far.
        again: True if a new trial is requested.
        paused: True if the trial is to pause.
        seated: Count of changes of the player's page at the start of this trial.
        hands: Index of the hand of every page.
        own: Name in the page's menu of the task that play began with, and its name or place.
    """

    task: str
    sides: tuple[str, ...]
    own: tuple[str, str] = ("", "")
    trial: int = 0
    again: bool = False
    paused: bool = False
    seated: int = 0
    hands: tuple[int, ...] = (0, 1)

    @classmethod
    def of(cls, settings: Settings) -> PlayerRequests:
        """The task and the hands of settings."""
        sides = tuple(hand.side for hand in settings.hands)
        return cls(settings.task, sides, (find_task(settings.task).name, settings.task))

    def take(self, requests: Sequence[PlayerRequest], hand: int = 0) -> None:
        """Applies the requests from the page of a hand; invalid ones are ignored."""
        for request in requests:
            match request.what:
                case "retry":
                    self.again = True
                case "task" if request.value == self.own[0]:
                    self.task, self.again = self.own[1], True
                case "task" if request.value in TASKS:
                    self.task, self.again = request.value, True
                case "hand" if request.value in HANDS:
                    self.sides = (*self.sides[:hand], request.value, *self.sides[hand + 1 :])
                    self.again = True
                case "pause" | "resume":
                    self.paused = request.what == "pause"

    def next_trial(self) -> None:
        """Counts a trial; the next one is neither paused nor over."""
        self.trial += 1
        self.again = self.paused = False

    def applied_to(self, settings: Settings) -> Settings:
        """The settings with the requested task and hands, and the seed of this trial."""
        hands = tuple(hand.on(side) for hand, side in zip(settings.hands, self.sides, strict=False))
        return replace(
            settings,
            task=self.task,
            hands=hands + settings.hands[len(hands) :],
            seed=settings.seed + self.trial,
        )


@dataclass
class Play:
    """Base class of play: one trial after another, as the player requests.

    Attributes:
        options: Options of the scene.
        servers: Servers of the pages that show the trials.
        events: Log of events.
        console: Console for messages.
        learner: Keeps layouts of five fingers in the player's profile; None keeps none.
        requests: What the player requests, on a page or in the window.
    """

    options: TrialOptions
    servers: tuple[PageServer, ...]
    events: EventLog
    console: Console
    learner: Learner | None = None
    requests: PlayerRequests = field(init=False)

    def __post_init__(self) -> None:
        self.requests = PlayerRequests.of(self.first_settings)
        self.notices = NoticePrinter(self.console)

    @property
    def first_settings(self) -> Settings:
        """Settings of the options, before any request."""
        return trial_settings(replace(self.options, record=None))

    @property
    def record(self) -> Path | None:
        """File of this trial's recording; later trials get a number, so that none is replaced."""
        path, trial = self.options.record, self.requests.trial
        return path.with_stem(f"{path.stem}-{trial + 1}") if path and trial else path

    def make_views(self, session: Session, timing: Timing) -> list[View]:
        """Views of a trial: its timing, its notices, and its pages."""
        notices = NoticeEvents(self.events, self.notices.say)

        def on_pages(snapshot: Snapshot) -> None:
            for server in self.servers:
                server.publish_step(session, snapshot)

        return [timing.stepped, notices.show, on_pages]
