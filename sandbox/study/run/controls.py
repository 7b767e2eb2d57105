"""Commands that the experimenter types in the terminal during a session."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import TextIOWrapper, UnsupportedOperation
from queue import Empty, SimpleQueue
from typing import TextIO

from models.errors import StudyError
from sandbox.study.record.journal import plain_text
from sandbox.study.run.answers import choice_of, chosen

COMMANDS = {
    "i": "show the progress of the session",
    "p": "pause or continue",
    "r": "repeat this trial, or the last one if none is running: r REASON",
    "s": "skip this trial or step: s REASON",
    "x": "exclude this trial, or the last one if none is running: x REASON",
    "X": "exclude the participant from the results: X REASON",
    "n": "write a note: n TEXT",
    "q": "stop; the session can be resumed later",
    "h": "show these keys",
}
"""Description of each command, by its key. Enter confirms a command."""
YES_OR_NO = ("yes", "no")
NEED_WORDS = "xXn"
"""Keys that must be followed by a text."""


@dataclass(frozen=True)
class Command:
    """A command: a key of `COMMANDS` and the text after it."""

    key: str
    words: str = ""


def parse_command(line: str) -> Command | str:
    """Parses a typed line; returns an error message if the line is not a command."""
    line = line.strip().removeprefix("/")
    key, words = line[:1], line[1:].strip()
    if key not in COMMANDS or (line[1:2] not in ("", " ")):
        return "keys: " + ", ".join(f"{k} {about}" for k, about in COMMANDS.items())
    if key in NEED_WORDS and not words:
        return f"{key} needs a text: {COMMANDS[key]}"
    try:
        plain_text(words, f"the text of {key}")
    except StudyError as error:
        return str(error)
    return Command(key, words)


class Controls:
    """Queue of the experimenter's commands for the session's thread.

    Args:
        say: Prints a line in the experimenter's terminal.

    Attributes:
        paused: True while the session is paused.
    """

    def __init__(self, say: Callable[[str], object] = lambda text: None) -> None:
        self.say = say
        self.paused = False
        self._lines: SimpleQueue[str] = SimpleQueue()

    def type(self, line: str) -> None:
        """Adds a typed line; may be called from any thread."""
        self._lines.put(line)

    def take(self) -> Iterable[Command]:
        """Yields the commands since the last call.

        Prints the keys for `h`, and an error message for an invalid line.
        """
        while True:
            try:
                line = self._lines.get_nowait()
            except Empty:
                return
            if not line.strip():
                continue
            command = parse_command(line)
            if isinstance(command, str):
                self.say(command)
            elif command.key == "h":
                self.show_keys()
            else:
                yield command

    def show_keys(self) -> None:
        """Prints all keys with their descriptions."""
        self.say("\n".join(f"  {key}  {about}" for key, about in COMMANDS.items()))


class Terminal:
    """Reads lines from the terminal: answers while a question is open, otherwise commands.

    A line that begins with `/` is always a command. If participants answer in the terminal, only
    such lines are commands, so that an answer that is typed too early cannot stop the session or
    skip a step.

    Args:
        controls: Queue for the commands.
        source: Text stream to read; None reads standard input.
        answers: True if participants answer in this terminal. Lines that are typed while no
            question is open are then discarded. Lines from a file or a pipe arrive before the
            questions, so they are stored as answers to the next questions.
    """

    def __init__(
        self, controls: Controls, source: TextIO | None = None, answers: bool = False
    ) -> None:
        self._controls, self._for_answers = controls, answers
        self._source = source or sys.stdin
        if isinstance(self._source, TextIOWrapper):
            # Bytes that are invalid in the system's encoding must not end the reading.
            with suppress(UnsupportedOperation):  # the stream has been read from already
                self._source.reconfigure(errors="replace")
        self._asking = threading.Event()
        self._answers: SimpleQueue[str | None] = SimpleQueue()
        self.ended = False
        self._thread = threading.Thread(target=self._read, name="terminal", daemon=True)
        self._thread.start()

    def ask(self, poll: Callable[[], None] = lambda: None, tick: float = 0.05) -> str | None:
        """Waits for an answer and returns it; returns None at the end of the input.

        Args:
            poll: Called repeatedly while waiting; its exceptions are passed on.
            tick: Time between two calls, s.
        """
        with self.form():
            while True:
                poll()
                try:
                    return self._answers.get(timeout=tick)
                except Empty:
                    if self.ended and self._answers.empty():
                        return None

    def choose(
        self,
        options: Sequence[str],
        show: Callable[[str], object],
        poll: Callable[[], None] = lambda: None,
        ended: Callable[[], StudyError] = lambda: StudyError(
            "the input has ended before an option was chosen",
            where="the terminal",
            remedy="Start the command again, in a terminal",
        ),
        experimenter: bool = False,
    ) -> int:
        """Waits until an option is typed, as its word or its number; returns its index.

        Args:
            options: Words of the options.
            show: Prints the prompt with the options, before each try.
            poll: See `ask`.
            ended: Creates the error for the end of the input.
            experimenter: True if the question is for the experimenter, before the session begins.
                The key h then shows the keys, as it does during the session.

        Raises:
            StudyError: The input has ended.
        """
        with self.form():
            while True:
                help_too = ", h for the keys of a session" if experimenter else ""
                show(f"type {choice_of(options)}{help_too}, then Enter")
                text = self.ask(poll)
                if text is None:
                    raise ended()
                place = chosen(text, options)
                if place is not None:
                    return place
                if experimenter and text.strip() == "h":
                    self._controls.show_keys()

    @contextmanager
    def form(self) -> Iterator[None]:
        """Context in which typed lines are answers, also between two questions of a form."""
        was = self._asking.is_set()
        self._asking.set()
        try:
            yield
        finally:
            if not was:
                self._asking.clear()

    def _read(self) -> None:
        try:
            for line in self._lines():
                text = line.rstrip("\n")
                if text.strip() == "/h":
                    # The keys can be shown without waiting for the session's thread.
                    self._controls.show_keys()
                elif text.startswith("/") or not (self._asking.is_set() or self._for_answers):
                    self._controls.type(text)
                elif self._asking.is_set() or not self._source.isatty():
                    self._answers.put(text)
                elif text.strip():
                    self._controls.say(
                        "no question is open, so this line was discarded; commands begin with /, "
                        "such as /h"
                    )
        finally:
            self.ended = True
            self._answers.put(None)

    def _lines(self) -> Iterator[str]:
        with suppress(OSError):  # the terminal was closed
            yield from iter(self._source.readline, "")
