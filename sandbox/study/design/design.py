"""The design of a study: factors, orders, trials, forms and texts of its sessions."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from models.arithmetic import total
from models.errors import StudyError
from sandbox.study.design.reading import Text
from sandbox.study.measures.measures import Measure

DEMOGRAPHICS = "demographics"
"""Name of the form with the questions about the person."""

FILLED = (
    *("participant_id", "participant", "ppid", "study", "experiment", "mode", "site", "number"),
    *("group", "date", "hand", "hand_size", "language", "simulated"),
    *("device", "surface_in", "screen_measured", "software"),
    *("consent", "sessions_done", "trials_done", "trials_planned", "complete"),
    *("excluded", "exclusion_reason", "clock_steps"),
)
"""Columns of the tables of participants that the program fills. No question about the person may
have one of these names."""


@dataclass(frozen=True)
class Level:
    """A level of a factor: its name in tables, and its settings."""

    name: str
    settings: dict[str, Any]


@dataclass(frozen=True)
class Factor:
    """A factor of the design.

    Attributes:
        name: Name of the column in tables.
        order: One of `fields.ORDERS`.
        levels: All levels; for a nested factor, those within all levels of the outer factor.
        outer: Name of the outer factor of a nested factor; empty for a crossed factor.
        nested: Levels by level of the outer factor; None for a crossed factor.
        one_a_session: True if each session has one of the levels, in the factor's order.
    """

    name: str
    order: str
    levels: tuple[Level, ...]
    outer: str = ""
    nested: dict[str, tuple[Level, ...]] | None = None
    one_a_session: bool = False

    @property
    def lists(self) -> tuple[tuple[Level, ...], ...]:
        """Lists of levels: one for each outer level of a nested factor, otherwise a single one."""
        return tuple(self.nested.values()) if self.nested else (self.levels,)

    def within(self, chosen: dict[str, Level]) -> tuple[Level, ...]:
        """The levels that occur together with the chosen levels of outer factors."""
        if self.nested is None:
            return self.levels
        return self.nested[chosen[self.outer].name]


@dataclass(frozen=True)
class Item:
    """One question; its attributes are the keys of the table `items` in `fields`, and `ends`.

    Attributes:
        ends: Texts at both ends of a scale; None without them.
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
        """Text of a stored choice in a language."""
        return self.means[self.choices.index(choice)][language] if self.means else choice


@dataclass(frozen=True)
class Scale:
    """A scale: the rule that computes one number from answers.

    Attributes:
        name: Name in tables.
        rule: One of `fields.RULES`.
        items: Names of the items, whose answers are numbers.
        bounds: Lowest and highest answer of each item.
        reverse: Items that are reversed: low + high - answer is used.
        from_zero: True subtracts the lowest possible answer of an item from each answer.
        factor: Factor by which the result is multiplied.
        pairs: For `weighted`: names of the comparisons, whose answers are names of `items`.
    """

    name: str
    rule: str
    items: tuple[str, ...]
    bounds: tuple[tuple[float, float], ...]
    reverse: frozenset[str] = frozenset()
    from_zero: bool = False
    factor: float = 1.0
    pairs: tuple[str, ...] = ()

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest possible score."""
        lows = [0.0 if self.from_zero else low for low, _ in self.bounds]
        highs = [high - (low if self.from_zero else 0.0) for low, high in self.bounds]
        if self.rule == "sum":
            ends = (total(lows), total(highs))
        elif self.rule == "mean":
            ends = (total(lows) / len(lows), total(highs) / len(highs))
        else:
            ends = (min(lows), max(highs))
        low, high = sorted((ends[0] * self.factor, ends[1] * self.factor))
        return low, high


@dataclass(frozen=True)
class Form:
    """A questionnaire: questions that are asked together; `fields` describes its keys.

    Attributes:
        source: Name and text of the file with the items; None if they are in the design.
        wording: One of `fields.WORDINGS` for each language.
    """

    name: str
    title: Text
    items: tuple[Item, ...]
    at: str
    scales: tuple[Scale, ...] = ()
    source: tuple[str, str] | None = None
    sessions: tuple[int, ...] = ()
    wording: Text = field(default_factory=dict)


@dataclass(frozen=True)
class Instruction:
    """A text for the participant; `fields` describes its keys. Empty `sessions` mean all."""

    text: Text
    at: str
    level: str = ""
    sessions: tuple[int, ...] = ()


@dataclass(frozen=True)
class Exclusion:
    """A rule that excludes trials or participants from the report; no data are deleted.

    `fields` describes its keys.
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
class PageSettings:
    """Settings of trials on the page.

    Attributes:
        shows: Items of `fields.SHOWS` that the participant sees or hears.
        starts: One of `fields.STARTS`.
        when_gone: One of `fields.WHEN_GONE`.
        names, goals: Names and goals of tasks as shown to the participant, by task.
        words: The design's own words for the page, by language and key.
    """

    shows: tuple[str, ...] = ("task", "goal")
    starts: str = "touch"
    when_gone: str = "pause"
    names: dict[str, Text] = field(default_factory=dict)
    goals: dict[str, Text] = field(default_factory=dict)
    words: dict[str, dict[str, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Design:
    """A valid design of a study.

    Most attributes are keys of the file; `fields` has their meaning, unit and range. These differ
    from the keys:

    Attributes:
        time_limit, expected, break_time: Times, s: `time_limit_s`, `expected_s` of `[trials]`,
            `least_s` of `[breaks]`.
        break_every: Number of trials between breaks; 0 for no breaks.
        page: Settings of trials on the participant's page.
        consent: Text of the consent form; empty if the study asks for no consent.
        primary: Confirmatory outcomes; if empty, all outcomes of the report are tested.
        own_measure: The study's own measure; None without one.
        own_source: Name and text of the file with the own measure, in the folder of the design.
        digest: Digest of the file, and of the files in its folder that it names.
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
    learning: str
    time_limit: float
    expected: float
    break_every: int
    break_time: float
    page: PageSettings
    consent: Text
    consent_version: str
    instructions: tuple[Instruction, ...]
    demographics: tuple[Item, ...]
    questionnaires: tuple[Form, ...]
    exclusions: tuple[Exclusion, ...]
    primary: tuple[str, ...]
    own_measure: Measure | None
    own_source: tuple[str, str] | None
    digest: str
    text: str
    path: Path

    def language_of(self, asked: str) -> str:
        """The language `asked`, if the design has it; the first language if `asked` is empty.

        Raises:
            StudyError: The design has no texts in the language.
        """
        if asked and asked not in self.languages:
            raise StudyError(
                "the design has no texts in this language",
                where="--language",
                got=asked,
                expected=", ".join(self.languages),
            )
        return asked or self.languages[0]
