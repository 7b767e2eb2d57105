"""What the experimenter asks for while a session runs, and the terminal it is typed in."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import TextIO

COMMANDS = {
    "i": "where the session is",
    "p": "pause, or go on",
    "r": "repeat this trial, or the last one when none runs: r WHY",
    "s": "skip this trial or step: s WHY",
    "x": "exclude this trial or the last one from results: x WHY",
    "X": "exclude the participant from results: X WHY",
    "n": "note: n TEXT",
    "q": "stop here; the session can be resumed",
    "h": "these keys",
}
"""Key -> what it does; typed with Enter."""
NEED_WORDS = "xXn"
"""What is nothing without words."""


@dataclass(frozen=True)
class Command:
    """A key of `COMMANDS`, and words after it."""

    key: str
    words: str = ""


def parse_command(line: str) -> Command | str:
    """A line as a command, or why it is none."""
    line = line.strip().removeprefix("/")
    key, words = line[:1], line[1:].strip()
    if key not in COMMANDS or (line[1:2] not in ("", " ")):
        return "keys: " + ", ".join(f"{k} {about}" for k, about in COMMANDS.items())
    if key in NEED_WORDS and not words:
        return f"{key} needs words: {COMMANDS[key]}"
    return Command(key, words)


class Controls:
    """Commands that wait to be taken by the session's thread.

    Args:
        say: Answers the experimenter.

    Attributes:
        paused: Trials stand still.
    """

    def __init__(self, say: Callable[[str], object] = lambda text: None) -> None:
        self.say = say
        self.paused = False
        self._lines: SimpleQueue[str] = SimpleQueue()

    def type(self, line: str) -> None:
        """A line as it was typed; from any thread."""
        self._lines.put(line)

    def take(self) -> Iterable[Command]:
        """Commands since the last call; help and slips are answered here."""
        while True:
            try:
                line = self._lines.get_nowait()
            except Empty:
                return
            if not line.strip():
                continue
            found = parse_command(line)
            if isinstance(found, str):
                self.say(found)
            elif found.key == "h":
                self.say("\n".join(f"  {key}  {about}" for key, about in COMMANDS.items()))
            else:
                yield found


class Terminal:
    """Lines of the terminal: answers while a form is open, else commands.

    Args:
        controls: Get the commands. While a form is open they begin with `/`.
        source: What is read.
    """

    def __init__(self, controls: Controls, source: TextIO | None = None) -> None:
        self._controls = controls
        self._source = source or sys.stdin
        self._asking = threading.Event()
        self._answers: SimpleQueue[str | None] = SimpleQueue()
        self.ended = False
        self._thread = threading.Thread(target=self._read, name="terminal", daemon=True)
        self._thread.start()

    def ask(self, ready: Callable[[], None] = lambda: None, tick: float = 0.05) -> str | None:
        """Waits for a line that is no command; None where no more can come.

        Args:
            ready: Called again and again meanwhile; may raise.
            tick: s between two calls.
        """
        with self.form():
            while True:
                ready()
                try:
                    return self._answers.get(timeout=tick)
                except Empty:
                    if self.ended and self._answers.empty():
                        return None

    @contextmanager
    def form(self) -> Iterator[None]:
        """Lines are answers as long as this lasts, those between two questions, too."""
        was = self._asking.is_set()
        self._asking.set()
        try:
            yield
        finally:
            if not was:
                self._asking.clear()

    @property
    def asking(self) -> bool:
        """Whether an answer is waited for."""
        return self._asking.is_set() and self._answers.empty()

    def _read(self) -> None:
        for line in iter(self._source.readline, ""):
            text = line.rstrip("\n")
            if self._asking.is_set() and not text.startswith("/"):
                self._answers.put(text)
            else:
                self._controls.type(text)
        self.ended = True
        self._answers.put(None)
