"""Every key of a design file: its default, what it means, its unit and its range, in one place.

The reader takes defaults and ranges from here, and `docs/design-file.md` is printed from it
(`python -m tools.docs.design_fields`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite
from typing import Any

SCHEMA = 1
"""Version of the file's layout."""

START, END = "start", "end"

ORDERS = {
    "latin": "a balanced Latin square (Williams 1949): each level is equally often at each place, "
    "and equally often right after each other level; n orders for even n, 2 n for odd n",
    "blocked": "the order of the list, for everybody, which balances nothing",
    "random": "an order by the seed, a new one inside of every outer level",
    "factorial": "all n! orders equally often, for up to 5 levels",
    "between": "one level for each participant",
}
"""Orders of the levels of a factor."""

LEARNING = {
    "trial": "every trial begins without layouts of fingers from earlier ones",
    "session": "a trial begins with the layouts of the trials before it in its session",
}
"""How long layouts of five fingers are kept that name fewer fingers."""

SEEDS = {
    "own": "each participant has starts and goals of their own",
    "shared": "starts and goals are the same for all participants and conditions",
}
"""Whose starts and goals trials have."""

SHOWS = {
    "task": "the name of the task",
    "goal": "goal of the task",
    "time": "the time of the trial",
    "progress": "how much of the goal is reached",
    "fingers": "names, colours and forces at the rings under the fingers",
    "sound": "sounds of contacts",
    "demo": "a simulated user on the same table, before a session's first trial of a task",
    "hint": "how the task is done, in words, until it is well under way",
    "result": "after a trial its time, or the missing condition",
}
"""Items that the participant sees or hears."""

STARTS = {
    "touch": "time starts with the first touch",
    "shown": "time starts as soon as the scene is visible",
}
"""When the time of a trial starts on the page."""

WHEN_GONE = {
    "pause": "time stops until the page is back and touched",
    "repeat": "the attempt is broken off, and the trial starts again",
    "mark": "time continues, and the results have the time without the page",
}
"""Behaviour while the page is unreachable."""

WORDINGS = {
    "own": "it was never published in other words",
    "published": "as published in this language",
    "paraphrase": "a paraphrase of a published one; participants, codebook and report say so",
    "translation": "a translation of a published one; participants, codebook and report say so",
}
"""Where the wording of a questionnaire comes from."""

ITEMS = {
    "choice": "one of `choices`",
    "scale": "a value from `low` to `high` in steps of `step`",
    "number": "any number from `low` to `high`",
    "text": "words of the participant's own",
}
"""Kinds of questions."""

RULES = {
    "sum": "sum of the items",
    "mean": "mean of the items",
    "weighted": "mean of the items, each weighted by how often it was chosen in `pairs` (NASA-TLX: "
    "Hart and Staveland 1988)",
}
"""Rules that compute a score from answers."""

OF = {
    "trial": "trials by their own value",
    "participant": "participants by the mean of their trials that count",
}
"""What an exclusion rule excludes."""


@dataclass(frozen=True)
class Field:
    """A key of a table of the design file.

    Attributes:
        name: The key.
        kind: What its value is, in words.
        means: What it means.
        default: The value without the key; None where there is none, so that the key is needed, or
            where its absence has a meaning of its own, which `means` says.
        unit: Unit of a number.
        low, high: Smallest and largest number.
        options: Words that it may be, with what they mean; empty if it may be anything of its kind.
    """

    name: str
    kind: str
    means: str
    default: Any = None
    unit: str = ""
    low: float = -inf
    high: float = inf
    options: Mapping[str, str] = field(default_factory=dict)

    @property
    def range(self) -> str:
        """Smallest and largest number in words, such as `0 to 100`; empty without bounds."""
        bounds = [f"{bound:.16g}" for bound in (self.low, self.high) if isfinite(bound)]
        return " to ".join(bounds)


WHOLE, NUMBER, NAME, STRING = "whole number", "number", "name", "string"
TEXT, FLAG, LIST, TABLES = "text", "true or false", "list", "tables"
CHOICE, TABLE, SESSIONS = "word", "table", "list of sessions"

_AT = Field("at", CHOICE, "`start`, `end`, or a factor: before each of its levels", START)
_SESSIONS = Field("sessions", SESSIONS, "sessions in which it comes, such as `[1]`; all without it")

_TABLES: dict[str, tuple[Field, ...]] = {
    "": (
        Field("schema", WHOLE, "version of the layout of this file", SCHEMA, low=1, high=SCHEMA),
        Field("name", NAME, "name of the study, of its folder, and in every table"),
        Field("title", TEXT, "heading of pages and copies; participants do not see it", ""),
        Field("seed", WHOLE, "seed of all random numbers", 0, low=0, high=2**53),
        Field("participants", WHOLE, "people wanted", 12, low=1, high=10_000),
        Field("sessions", WHOLE, "times that everybody comes", 1, low=1, high=99),
        Field(
            "languages",
            LIST,
            "tags such as en or pt-BR; the first one is the default, and with several every text "
            "is a table with one text for each: `text.en`, `text.de`",
            ("en",),
        ),
        Field(
            "settings",
            TABLE,
            'settings of all trials, such as `encoder = "linear"`, or `vary = "size=0.7"`, '
            "which is written as after `sandbox run --vary`",
            {},
        ),
        Field("factors", TABLES, "the varied factors, from the outermost to the innermost"),
        Field("trials", TABLE, "number, practice, time and display of trials", {}),
        Field("tasks", TABLES, "names and goals of tasks on the page", ()),
        Field("words", TABLE, "words of the page by language, where it has none or others", {}),
        Field("breaks", TABLE, "breaks between trials", {}),
        Field("consent", TABLE, "the consent form", {}),
        Field("instructions", TABLES, "texts for the participant", ()),
        Field(
            "demographics", TABLES, "questions about the person, at the first session's start", ()
        ),
        Field("questionnaires", TABLES, "questions about levels, or at the start or the end", ()),
        Field("exclusions", TABLES, "rules that exclude trials or participants", ()),
        Field("analysis", TABLE, "outcomes that the report tests", {}),
    ),
    "factors": (
        Field("name", NAME, "name of the factor, and of its column after `factor_`"),
        Field(
            "setting", STRING, "the setting that its levels are values of; `name` without it", ""
        ),
        Field("order", CHOICE, "order of the levels", "blocked", options=ORDERS),
        Field("inside", STRING, "the factor above in which this one is nested", ""),
        Field(
            "levels",
            LIST,
            'values of the setting, or tables that set several things: `{name = "gentle", contact '
            '= "soft", impulse = "safe"}`; of a nested factor a list for each level of that one',
        ),
        Field("one_a_session", FLAG, "each session has one of the levels, in their order", False),
    ),
    "trials": (
        Field("repetitions", WHOLE, "trials of every combination of levels", 1, low=1, high=1000),
        Field(
            "repeat_inside",
            STRING,
            "the factor inside whose levels repetitions go round; without it they follow each "
            "other inside of the innermost one",
            "",
        ),
        Field("practice", WHOLE, "practice trials, which are left out", 0, low=0, high=100),
        Field(
            "practice_each",
            STRING,
            "the factor before each of whose levels practice comes; once at the start without it",
            "",
        ),
        Field("practice_sessions", SESSIONS, "sessions with practice; all without it"),
        Field("seeds", CHOICE, "whose starts and goals trials have", "own", options=SEEDS),
        Field(
            "learning", CHOICE, "how long layouts of fingers are kept", "trial", options=LEARNING
        ),
        Field(
            "time_limit_s",
            NUMBER,
            "time after which a trial ends; a shorter limit of the task comes first",
            600.0,
            "s",
            0.05,
            3600.0,
        ),
        Field(
            "expected_s", NUMBER, "how long a trial takes, for the plan", 20.0, "s", 0.05, 3600.0
        ),
        Field("shows", LIST, "parts that the page shows or plays", ("task", "goal"), options=SHOWS),
        Field("starts", CHOICE, "when time starts on the page", "touch", options=STARTS),
        Field("when_gone", CHOICE, "while the page is away", "pause", options=WHEN_GONE),
    ),
    "tasks": (
        Field("task", STRING, "the task, as in the settings"),
        Field("name", TEXT, "name of the task on the page"),
        Field("goal", TEXT, "goal of the task"),
    ),
    "breaks": (
        Field(
            "every",
            WHOLE,
            "trials between breaks, practice not counted; 0 makes none. Where practice and a "
            "break are due at once, practice comes first",
            0,
            low=0,
            high=10_000,
        ),
        Field("least_s", NUMBER, "shortest duration of a break", 30.0, "s", 0.0, 7200.0),
    ),
    "consent": (
        Field("text", TEXT, "the consent form; without it `run` takes no real participant"),
        Field("version", STRING, "version of the text, which the record has", "1"),
    ),
    "instructions": (
        _AT,
        Field("level", STRING, "the one level of the factor before which it comes", ""),
        Field("text", TEXT, "the text"),
        _SESSIONS,
    ),
    "questionnaires": (
        Field("name", NAME, "name in tables; `use` without it"),
        Field("use", STRING, "a questionnaire of the program, such as `nasa-tlx` or `sus`", ""),
        Field("file", STRING, "a TOML file beside the design with the keys below", ""),
        Field("at", CHOICE, "`start`, `end`, or a factor: after each of its levels", END),
        _SESSIONS,
        Field("title", TEXT, "heading for the participant"),
        Field("items", TABLES, "the questions"),
        Field("scales", TABLES, "the scores; the first one is tested", ()),
        Field("wording", CHOICE, "where its wording comes from", "own", options=WORDINGS),
        Field("schema", WHOLE, "version of the layout of a file", SCHEMA, low=1, high=SCHEMA),
    ),
    "items": (
        Field("name", NAME, "column of `participants.csv`, or row of `answers.csv`"),
        Field("kind", CHOICE, "kind of the question", "text", options=ITEMS),
        Field("ask", TEXT, "the question"),
        Field("choices", LIST, "stored values of a choice, the same in all languages", ()),
        Field("means", LIST, "texts of the choices, in the same order", ()),
        Field("low", NUMBER, "smallest answer", 0.0, low=-1e9, high=1e9),
        Field("high", NUMBER, "largest answer", 100.0, low=-1e9, high=1e9),
        Field("step", NUMBER, "step of a scale, which must reach `high`", 1.0, low=1e-9, high=1e9),
        Field("low_means", TEXT, "words at the low end of a scale; none without it"),
        Field("high_means", TEXT, "words at the high end"),
        Field("optional", FLAG, "the question can be left out", False),
        Field("shuffle", FLAG, "in an order by chance among its neighbours that are, too", False),
    ),
    "scales": (
        Field("name", NAME, "name of the score"),
        Field("rule", CHOICE, "how it is computed", "sum", options=RULES),
        Field("items", LIST, "items of kind scale or number"),
        Field("reverse", LIST, "items that run against the others: low + high - answer", ()),
        Field("from_zero", FLAG, "an answer counts from its item's `low`", False),
        Field("factor", NUMBER, "factor on the result", 1.0, low=-1e6, high=1e6),
        Field("pairs", LIST, "of a weighted scale: choices among its items", ()),
    ),
    "exclusions": (
        Field("name", NAME, "name of the rule in tables"),
        Field("of", CHOICE, "what is excluded; nothing is deleted", "trial", options=OF),
        Field("measure", STRING, "column of `trials.csv` with numbers"),
        Field(
            "below", NUMBER, "smaller values are excluded; no bound without it", low=-1e9, high=1e9
        ),
        Field(
            "above", NUMBER, "larger values are excluded; no bound without it", low=-1e9, high=1e9
        ),
    ),
    "analysis": (
        Field(
            "primary",
            LIST,
            "the outcomes that are tested: measures, and questionnaires for their scores; all of "
            "the report without it",
        ),
        Field("own_measure", STRING, "a measure beside the design: `FILE.py:NAME`", ""),
    ),
}

FIELDS: dict[str, dict[str, Field]] = {
    table: {each.name: each for each in some} for table, some in _TABLES.items()
}
"""Fields by table and key; the table of a question is `items`, wherever it stands."""


def field_of(path: tuple[str | int, ...], key: str) -> Field:
    """The field of a key of the table at this path of a file.

    Args:
        path: Names and places in lists, from the outermost; of a questionnaire's file, its first
            name is `questionnaires`, too.
        key: The key.
    """
    names = [part for part in path if isinstance(part, str)]
    table = "items" if names[-1:] == ["demographics"] else names[-1] if names else ""
    return FIELDS[table][key]
