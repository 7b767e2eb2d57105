"""The design of a study: what is varied, in which order, and what else a session consists of."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.study.design.reading import Text
from sandbox.study.design.scoring import Scale
from sandbox.study.design.showing import Showing

SCHEMA = 1
"""Version of the file's layout."""

ORDERS = ("latin", "blocked", "random", "factorial", "between")
"""How a factor's levels follow each other. `latin`: a balanced Latin square (each level equally
often at each place and after each other one); `blocked`: as listed, for everybody; `random`: by
seed; `factorial`: every possible order equally often; `between`: everybody gets one level only."""

START, END = "start", "end"

ITEMS = ("choice", "scale", "number", "text")


@dataclass(frozen=True)
class Level:
    """A level of a factor: its name in tables, and the settings it means."""

    name: str
    settings: dict[str, Any]


@dataclass(frozen=True)
class Factor:
    """What is varied.

    Attributes:
        name: Column in tables.
        order: One of `ORDERS`.
        levels: All of them; of a nested factor, those of all outer levels.
        outer: Name of the factor in whose levels this one's are nested; empty for a crossed one.
        nested: Levels by name of the outer factor's level; empty for a crossed one.
        one_a_session: Every session has one of its levels, in the order's order.
    """

    name: str
    order: str
    levels: tuple[Level, ...]
    outer: str = ""
    nested: dict[str, tuple[Level, ...]] | None = None
    one_a_session: bool = False

    def within(self, chosen: dict[str, Level]) -> tuple[Level, ...]:
        """The levels that occur where outer factors have the levels chosen."""
        if self.nested is None:
            return self.levels
        return self.nested[chosen[self.outer].name]


@dataclass(frozen=True)
class Item:
    """One question.

    Attributes:
        name: Column or row in tables.
        kind: One of `ITEMS`.
        ask: The question.
        choices: Of a choice, as they are kept.
        low, high, step: Of a scale or a number.
        ends: What both ends of a scale mean.
        optional: It may be left out.
        means: What the choices are called, in their order; none: by what is kept.
        shuffle: It changes places with its neighbours that are shuffled, too, and its choices with
            each other, by chance and anew for everybody.
    """

    name: str
    kind: str
    ask: Text
    choices: tuple[str, ...] = ()
    low: float = 0.0
    high: float = 100.0
    step: float = 1.0
    ends: tuple[Text, Text] | None = None
    optional: bool = False
    means: tuple[Text, ...] = ()
    shuffle: bool = False

    def called(self, choice: str, language: str) -> str:
        """What a choice is called in a language."""
        return self.means[self.choices.index(choice)][language] if self.means else choice


@dataclass(frozen=True)
class Form:
    """Questions that are asked together.

    Attributes:
        name: Of the instrument.
        title: For the participant.
        items: In order.
        at: `start`, `end`, or the factor after each of whose levels it is asked.
        scales: How answers become scores.
        source: Name and text of the file with its items; None where they are in the design.
        sessions: In which it is asked; none: in all.
    """

    name: str
    title: Text
    items: tuple[Item, ...]
    at: str
    scales: tuple[Scale, ...] = ()
    source: tuple[str, str] | None = None
    sessions: tuple[int, ...] = ()


@dataclass(frozen=True)
class Instruction:
    """A text, at `start`, at `end`, or before each new level of a factor (or one level of it); in
    some sessions, or in all."""

    text: Text
    at: str
    level: str = ""
    sessions: tuple[int, ...] = ()


@dataclass(frozen=True)
class Exclusion:
    """A rule by which trials, or participants, are left out; nothing is ever deleted.

    Attributes:
        name: In tables.
        of: `trial` or `participant`.
        measure: Column of the trial results; of a participant, its mean over counted trials.
        below, above: It holds beyond these.
    """

    name: str
    of: str
    measure: str
    below: float | None = None
    above: float | None = None

    def holds(self, value: float) -> bool:
        """Whether a value is to be left out."""
        return (self.below is not None and value < self.below) or (
            self.above is not None and value > self.above
        )


@dataclass(frozen=True)
class Design:
    """A study as it was designed, without a mistake.

    Attributes:
        name: Of the experiment and its folder.
        title: For people.
        seed: Every chance follows from it.
        participants: How many are wanted.
        sessions: How often everybody comes.
        languages: The first is the default.
        settings: Of all trials, as options of `sandbox run`.
        factors: From the outermost to the innermost.
        repetitions: Of every combination.
        repeat_inside: Factor inside of whose levels the repetitions go round; empty: innermost.
        practice: Trials before each new level of `practice_each`.
        practice_each: A factor, or empty: once at the start.
        practice_sessions: In which there is practice; none: in all.
        seeds: `own` starts and goals for everybody, or `shared` ones.
        time_limit: s of a trial; the task's own is shorter or counts.
        expected: s that a trial takes, for plans.
        break_every: Trials; 0: none.
        break_time: s, shortest break.
        showing: How trials on the page go.
        consent: Text, and its version; no text: none is asked for.
        instructions, demographics, questionnaires, exclusions: As named.
        digest: Of the file.
        text: The file itself.
        path: Where it was.
    """

    name: str
    title: str
    seed: int
    participants: int
    sessions: int
    languages: tuple[str, ...]
    settings: dict[str, Any]
    factors: tuple[Factor, ...]
    repetitions: int
    repeat_inside: str
    practice: int
    practice_each: str
    practice_sessions: tuple[int, ...]
    seeds: str
    time_limit: float
    expected: float
    break_every: int
    break_time: float
    showing: Showing
    consent: Text
    consent_version: str
    instructions: tuple[Instruction, ...]
    demographics: tuple[Item, ...]
    questionnaires: tuple[Form, ...]
    exclusions: tuple[Exclusion, ...]
    digest: str
    text: str
    path: Path
