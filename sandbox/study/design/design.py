"""The design of a study: factors, orders, trials, forms and texts of its sessions."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.study.design.page_settings import PageSettings
from sandbox.study.design.reading import Text
from sandbox.study.design.scoring import Scale

SCHEMA = 1
"""Version of the file's layout."""

ORDERS = ("latin", "blocked", "random", "factorial", "between")
"""Orders of the levels of a factor. `latin`: a balanced Latin square (each level equally often at
each place and after each other level); `blocked`: as listed, for all participants; `random`: drawn
from the seed; `factorial`: every possible order equally often; `between`: each participant gets one
level only."""

LEARNING = ("trial", "session")
"""How long layouts of five fingers are kept that name fewer fingers. `trial`: every trial begins
without them; `session`: it begins with those of the trials before it in its session."""

START, END = "start", "end"

WORDINGS = ("own", "published", "paraphrase", "translation")
"""Where the wording of a questionnaire comes from. `own`: it was never published in other words;
`published`: as published in this language; `paraphrase`, `translation`: of a published one, and
participants, codebook and report are told."""

ITEMS = ("choice", "scale", "number", "text")

DEMOGRAPHICS = "demographics"
"""Name of the form with the questions about the person."""

LISTED, JOINED = ", ", " / "
"""Between levels in the list of the codebook, and in the name of a condition in reports."""

FILLED = (
    *("participant_id", "ppid", "number", "hand", "hand_size", "language", "mode", "simulated"),
    *("consent", "sessions_done", "trials_done", "trials_planned", "complete"),
    *("excluded", "exclusion_reason", "clock_steps"),
)
"""Columns of the tables of participants that the program fills; no question about the person may be
named like one of them."""


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
        order: One of `ORDERS`.
        levels: All levels; of a nested factor, the levels within all outer levels.
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

    def within(self, chosen: dict[str, Level]) -> tuple[Level, ...]:
        """The levels that occur with the chosen levels of outer factors."""
        if self.nested is None:
            return self.levels
        return self.nested[chosen[self.outer].name]


@dataclass(frozen=True)
class Item:
    """One question.

    Attributes:
        name: Name of the column or row in tables.
        kind: One of `ITEMS`.
        ask: Text of the question.
        choices: Stored values of a choice.
        low, high, step: Limits and step of a scale or number.
        ends: Texts at both ends of a scale.
        optional: True if the participant may leave it out.
        means: Texts of the choices, in the same order; empty uses the stored values.
        shuffle: True shuffles the choices and the place of the item among adjacent items with
            `shuffle`, for each participant.
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
class Form:
    """A questionnaire: questions that are asked together.

    Attributes:
        name: Name of the instrument.
        title: Title for the participant.
        items: Items in order.
        at: `start`, `end`, or the name of a factor; the form is asked after each of its levels.
        scales: Scales that compute scores from answers.
        source: Name and text of the file with the items; None if they are in the design.
        sessions: Sessions in which it is asked; empty means all.
        wording: One of `WORDINGS` by language.
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
    """A text for the participant.

    Attributes:
        text: The text.
        at: `start`, `end`, or the name of a factor; the text is shown before each of its levels.
        level: The only level of the factor before which it is shown; empty for all levels.
        sessions: Sessions in which it is shown; empty means all.
    """

    text: Text
    at: str
    level: str = ""
    sessions: tuple[int, ...] = ()


@dataclass(frozen=True)
class Exclusion:
    """A rule that excludes trials or participants; their data are never deleted.

    Attributes:
        name: Name of the rule in tables.
        of: `trial` or `participant`.
        measure: Column of the trial results; for a participant, its mean over counted trials.
        below, above: Values below or above these bounds are excluded.
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
        practice_each: Name of a factor; empty for practice once at the start.
        practice_sessions: Sessions with practice; empty means all.
        seeds: `own` starts and goals for each participant, or `shared` ones.
        learning: One of `LEARNING`.
        time_limit: Time limit of a trial, s; a shorter limit of the task has priority.
        expected: Expected duration of a trial, s, for plans.
        break_every: Number of trials between breaks; 0 for no breaks.
        break_time: Shortest duration of a break, s.
        page: Settings of trials on the participant's page.
        consent: Text of the consent form, and its version; empty asks for none.
        instructions, demographics, questionnaires, exclusions: See their types.
        primary: Confirmatory outcomes: measures, and questionnaires for their scores. Only these
            are tested; empty tests all outcomes of the report.
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
    digest: str
    text: str
    path: Path
