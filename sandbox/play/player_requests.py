"""Parts shared by play in a window and on pages: the player's requests, settings and views.

This module also prints to the terminal: notices, how a trial ended, and the latency of touches.
Notices come from the session's thread while a trial runs. The latency of touches is printed as a
table at the end; scripts may set a limit for it.
"""

from __future__ import annotations

import shlex
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from queue import SimpleQueue

from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from encoders.labels.labelling import parse_finger_sets
from models.errors import InputError
from models.frames import FINGERS
from models.person import HANDS
from sandbox.play.own_profile import Learner
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PlayerRequest
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import View
from sandbox.trial.logs import EventLog, LatencyLog, NoticeEvents, Percentiles, Timing
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import TASKS, find_task
from tasks.score import ending

KINDS = {
    "waited": "touch received to step",
    "stepped": "step to frame ready",
    "acknowledged": "frame sent to page received",
    "round_trip": "page to server and back",
    "drawn": "touch event to picture on the page",
    "window": "touch received to picture in the window",
    "picture": "drawing a picture in the window",
}
"""Kind in a `LatencyLog` -> description, in the order from touch to picture."""

END_TO_END = ("window", "drawn")
"""Kinds of latency from a touch to a picture. The limit applies to these kinds."""


def print_latency(log: LatencyLog, console: Console) -> None:
    """Prints the latencies as a table, if there are any."""
    percentiles = log.percentiles()
    shown = [kind for kind in KINDS if kind in percentiles]
    if not shown:
        return
    table = Table("latency (ms)", "n", "p50", "p95", "p99")
    for kind in shown:
        p = percentiles[kind]
        table.add_row(KINDS[kind], str(p.n), *(f"{v:.1f}" for v in (p.p50, p.p95, p.p99)))
    console.print(table)
    console.print("[dim]The delay of the display itself is not measured.[/]")


def checked_limit(limit: float | None) -> float | None:
    """Checks a limit in ms and returns it.

    Raises:
        InputError: The limit is not positive and finite.
    """
    if limit is not None and not 0.0 < limit < float("inf"):
        raise InputError("not a latency", where="--max-latency", got=limit, expected="ms above 0")
    return limit


def judge_latency(log: LatencyLog, limit: float | None, console: Console) -> int:
    """Returns 0 if the 95th percentile of the latency from touch to picture is within the limit.

    Returns 1 if it exceeds the limit, or if no latency was measured.

    Args:
        log: Log of the session.
        limit: ms; None sets no limit.
        console: Console for the result.
    """
    if limit is None:
        return 0
    percentiles = log.percentiles()
    ways: dict[str, Percentiles] = {
        kind: percentiles[kind] for kind in END_TO_END if kind in percentiles
    }
    if not ways:
        console.print("[red]latency: no picture followed a touch, so nothing was measured[/]")
        return 1
    late = {kind: p for kind, p in ways.items() if p.p95 > limit}
    for kind, p in ways.items():
        colour, word = ("red", "above") if kind in late else ("green", "within")
        console.print(
            f"[{colour}]{KINDS[kind]}: p95 {p.p95:.1f} ms, {word} the limit of {limit:g} ms[/]"
        )
    return int(bool(late))


class NoticePrinter:
    """Prints notices. A stopped terminal (Ctrl-S) does not delay the session.

    Args:
        console: Console of the program.
        wrap: False lets the terminal break long lines.
    """

    def __init__(self, console: Console, wrap: bool = True) -> None:
        self._console, self._wrap = console, wrap
        self._waiting: SimpleQueue[str] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._said = self._printed = 0

    def say(self, notice: str) -> None:
        """Queues a notice for printing; may be called from the session's thread."""
        self._said += 1
        self._waiting.put(notice)
        if self._thread is None:
            self._thread = threading.Thread(target=self._print, name="notices", daemon=True)
            self._thread.start()

    @property
    def waiting(self) -> int:
        """Number of notices that are not printed yet."""
        return self._said - self._printed

    def wait(self, seconds: float = 1.0) -> None:
        """Waits until all notices are printed, for at most `seconds`."""
        end = time.monotonic() + seconds
        while self.waiting and time.monotonic() < end:
            time.sleep(0.01)

    def _print(self) -> None:
        while True:
            text = Text(self._waiting.get(), style="yellow")
            self._console.print(text, soft_wrap=not self._wrap)
            self._printed += 1


def address_line(address: str) -> str:
    """Returns a line with a device's address: a link to open, or an address to send TUIO to."""
    action = "open" if "://" in address else "listening for TUIO on"
    return f"{action} [bold]{address}[/]"


def report_end(result: TrialResult, console: Console) -> None:
    """Prints how a trial ended, and after a divergence the file with the last states."""
    if result.diverged:
        console.print(f"[red]the simulation diverged: {result.diverged}[/]")
    if result.dump:
        line = shlex.join(["sandbox", "replay", result.dump])
        console.print(f"to see its last states: {escape(line)}", soft_wrap=True)
    elif result.dump_error:
        console.print(f"[yellow]{escape(result.dump_error)}[/]", soft_wrap=True)
    colour = "green" if result.success else "red"
    what = ending(result.status, result.success)
    line = f"[bold {colour}]{result.task}: {what}[/] after {result.time_s:.1f} s"
    if result.scored is False:
        line += ", not scored: the table was scaled"
    if result.reason:
        # A trial continues for a moment after success, and the goal state may be lost again.
        line += f"{'; afterwards, ' if result.success else ', '}{escape(result.reason)}"
    console.print(line)


@dataclass
class PlayerRequests:
    """The person's requests for this trial and the next one.

    Attributes:
        task: Name of the task, or place of a task that is not built in.
        sides: `right` or `left`, for every hand.
        finger_sets: Sets of fingers that the person uses; None uses those of the settings.
        trial: Number of trials so far.
        again: True if a new trial is requested.
        paused: True if a pause is requested.
        demonstrate: True if a demonstration of the trial is requested.
        seated: Number of changes of the players' pages so far, at the start of this trial.
        hands: Index of the hand of every page.
        own: The first task: its name in the page's menu, and its name or place.
    """

    task: str
    sides: tuple[str, ...]
    own: tuple[str, str] = ("", "")
    finger_sets: str | None = None
    trial: int = 0
    again: bool = False
    paused: bool = False
    demonstrate: bool = False
    seated: int = 0
    hands: tuple[int, ...] = (0, 1)

    @classmethod
    def of(cls, settings: Settings) -> PlayerRequests:
        """Requests with the task and the hands of some settings."""
        sides = tuple(hand.side for hand in settings.hands)
        return cls(settings.task, sides, (find_task(settings.task).name, settings.task))

    def take(self, requests: Sequence[PlayerRequest], hand: int = 0) -> None:
        """Applies the requests from the page of a hand; invalid requests are ignored."""
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
                case "fingers" if _are_sets(request.value):
                    self.finger_sets, self.again = request.value, True
                case "pause" | "resume":
                    self.paused = request.what == "pause"
                case "demo":
                    self.demonstrate = True

    def next_trial(self) -> None:
        """Increases the number of trials, and clears requests to pause, repeat or demonstrate."""
        self.trial += 1
        self.again = self.paused = self.demonstrate = False

    def applied_to(self, settings: Settings) -> Settings:
        """The settings with the requested task, hands and fingers, and the seed of this trial.

        A task that needs more fingers than were requested is played with any fingers.
        """
        hands = tuple(hand.on(side) for hand, side in zip(settings.hands, self.sides, strict=False))
        changed = replace(
            settings,
            task=self.task,
            hands=hands + settings.hands[len(hands) :],
            seed=settings.seed + self.trial,
        )
        if self.finger_sets is None or not can_choose_fingers(settings):
            return changed
        enough = _fingers_in(self.finger_sets) >= find_task(self.task).fewest_fingers
        return changed.changed(finger_sets=self.finger_sets if enough else "")


def can_choose_fingers(settings: Settings) -> bool:
    """True if a player may choose sets of fingers.

    False for the paper's labels, a robot hand, and hands in the air.
    """
    known = settings.pipeline.labels != "paper" and not settings.physics.robot
    return known and not settings.in_air


def _fingers_in(sets: str) -> int:
    """Number of different fingers in sets of fingers; empty sets mean any fingers."""
    return len({f for each in parse_finger_sets(sets) for f in each}) if sets else len(FINGERS)


def _are_sets(text: str) -> bool:
    """True for sets of fingers as in the settings; empty for any fingers."""
    try:
        return _fingers_in(text) > 0
    except InputError:
        return False


@dataclass
class Play:
    """Base class of play: one trial after another, as the player requests.

    Attributes:
        options: Options of the scene.
        servers: Servers of the pages that show the trials.
        events: Log of events.
        console: Console for messages.
        learner: Adds layouts of five fingers to the player's profile; None adds none.
        requests: The player's requests, from a page or the window.
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
        """File of this trial's recording; from the second trial on, its name has a number."""
        path, trial = self.options.record, self.requests.trial
        return path.with_stem(f"{path.stem}-{trial + 1}") if path and trial else path

    def make_views(self, session: Session, timing: Timing) -> list[View]:
        """Views of a trial: for the latency of touches, for notices, and for pages."""
        notices = NoticeEvents(self.events, self.notices.say)

        def on_pages(snapshot: Snapshot) -> None:
            for server in self.servers:
                server.publish(snapshot)

        return [timing.stepped, notices.show, on_pages]
