"""The design of a study: what is varied, in which order, and what else a session consists of."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.study.design.page_options import PageOptions
from sandbox.study.design.reading import Text
from sandbox.study.design.scoring import Scale

SCHEMA = 1
"""Version of the file's layout."""

ORDERS = ("latin", "blocked", "random", "factorial", "between")
"""Orders of a factor's levels. `latin`: a balanced Latin square (each level equally
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
    """A factor of the design.

    Attributes:
        name: Column in tables.
        order: One of `ORDERS`.
        levels: All levels; for a nested factor, those in all outer levels.
        outer: Name of the factor in whose levels this one's are nested; empty for a crossed one.
        nested: Levels by name of the outer factor's level; empty for a crossed one.
        one_a_session: True if every session has one of its levels, in the factor's order.
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
        choices: Values of a choice as stored.
        low, high, step: Limits and step of a scale or a number.
        ends: Meanings of both ends of a scale.
        optional: True if it may be left out.
        means: Texts of the choices, in their order; empty uses the stored values.
        shuffle: True puts it, among its neighbours that are shuffled, too, and its choices in a
            random order for each participant.
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
        """Text of a choice in a language."""
        return self.means[self.choices.index(choice)][language] if self.means else choice


@dataclass(frozen=True)
class Form:
    """Questions that are asked together.

    Attributes:
        name: Name of the instrument.
        title: Title for the participant.
        items: Items in order.
        at: `start`, `end`, or a factor, after each of whose levels it is asked.
        scales: Scales, which compute scores from answers.
        source: Name and text of the file with its items; None if they are in the design.
        sessions: Sessions in which it is asked; empty means all.
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
        """True if a value is to be excluded."""
        return (self.below is not None and value < self.below) or (
            self.above is not None and value > self.above
        )


@dataclass(frozen=True)
class Design:
    """A valid design of a study.

    Attributes:
        name: Name of the experiment and its folder.
        title: Title for people.
        seed: Seed of all random choices.
        participants: Number of participants wanted.
        sessions: Number of sessions of every participant.
        languages: The first is the default.
        settings: Settings of all trials, as options of `sandbox run`.
        factors: Factors from the outermost to the innermost.
        repetitions: Repetitions of every combination.
        repeat_inside: Factor inside whose levels the repetitions are made; empty: innermost.
        practice: Number of practice trials before each new level of `practice_each`.
        practice_each: A factor, or empty: once at the start.
        practice_sessions: Sessions with practice; empty means all.
        seeds: `own` starts and goals for each participant, or `shared` ones.
        time_limit: s, limit of a trial; a shorter limit of the task applies.
        expected: s that a trial takes, for plans.
        break_every: Number of trials between breaks; 0 for no breaks.
        break_time: s, shortest break.
        page: Settings of trials on the page.
        consent: Text of the consent form, and its version; empty asks for none.
        instructions, demographics, questionnaires, exclusions: See their types.
        digest: Digest of the file.
        text: Text of the file.
        path: Path of the file.
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
    page: PageOptions
    consent: Text
    consent_version: str
    instructions: tuple[Instruction, ...]
    demographics: tuple[Item, ...]
    questionnaires: tuple[Form, ...]
    exclusions: tuple[Exclusion, ...]
    digest: str
    text: str
    path: Path
