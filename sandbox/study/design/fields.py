"""Every key of a design file, with its default, meaning, unit and range.

The reader takes defaults and ranges from this module, and `python -m tools.docs.design_fields`
prints `docs/design-file.md` from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite
from typing import Any

SCHEMA = 1
"""Version of the file's layout."""

START, END = "start", "end"

LISTED, JOINED = ", ", " / "
"""Separators of names in tables: between levels or conditions of a list, and between the levels of
one condition."""

ORDERS = {
    "latin": "a balanced Latin square (Williams 1949): each level is equally often at each place, "
    "and equally often right after each other level; n orders for even n, 2 n for odd n",
    "blocked": "the order of the list for everybody; nothing is balanced",
    "random": "an order drawn with the seed, and drawn again inside each outer level",
    "factorial": "all n! orders equally often, for up to 5 levels",
    "between": "one level for each participant",
}
"""Orders of the levels of a factor."""

LEARNING = {
    "trial": "every trial begins without layouts of fingers from earlier trials",
    "session": "a trial begins with the layouts from the earlier trials of its session",
}
"""How long measured layouts of five fingers stay in use. They help to label fewer fingers."""

SEEDS = {
    "own": "starts and goals differ between participants, conditions and sessions",
    "shared": "starts and goals of a task are the same for all participants, conditions and "
    "sessions",
}
"""How the starts and goals of trials are drawn."""

SHOWS = {
    "task": "the name of the task",
    "goal": "goal of the task",
    "time": "the time of the trial",
    "progress": "how much of the goal is reached",
    "fingers": "names, colours and forces at the rings under the fingers",
    "sound": "sounds of contacts",
    "demo": "a simulated user on the same table, before a session's first trial of a task",
    "hint": "a text on how the task is done, until the task is well under way",
    "result": "after a trial its time, or the condition of the goal that was missed",
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
    "own": "the study's own words; there is no published questionnaire with other words",
    "published": "as published in this language",
    "paraphrase": "a paraphrase of a published questionnaire; the participant's page, the codebook "
    "and the report mention it",
    "translation": "a translation of a published questionnaire; the participant's page, the "
    "codebook and the report mention it",
}
"""Where the wording of a questionnaire comes from."""

ITEMS = {
    "choice": "one of `choices`",
    "scale": "a value from `low` to `high` in steps of `step`",
    "number": "any number from `low` to `high`",
    "text": "a text in the participant's own words",
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
    "trial": "single trials, by their own value",
    "participant": "participants, by the mean over their trials that count",
}
"""What an exclusion rule excludes."""


@dataclass(frozen=True)
class Field:
    """A key of a table of the design file.

    Attributes:
        name: The key.
        kind: Kind of the value, in words.
        means: Meaning of the key.
        default: Value if the key is absent. None if the key is required, or if `means` describes
            its absence.
        unit: Unit of a number.
        low, high: Smallest and largest number.
        options: Allowed words, with their meanings; empty if every value of its kind is allowed.
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
_SESSIONS = Field(
    "sessions", SESSIONS, "sessions in which it comes, such as `[1]`; by default all sessions"
)

_TABLES: dict[str, tuple[Field, ...]] = {
    "": (
        Field("schema", WHOLE, "version of the layout of this file", SCHEMA, low=1, high=SCHEMA),
        Field("name", NAME, "name of the study, in its folder's name and in every table"),
        Field("title", TEXT, "heading of pages and copies; participants do not see it", ""),
        Field("seed", WHOLE, "seed of all random numbers", 0, low=0, high=2**53),
        Field("participants", WHOLE, "planned number of participants", 12, low=1, high=10_000),
        Field("sessions", WHOLE, "number of sessions of each participant", 1, low=1, high=99),
        Field(
            "languages",
            LIST,
            "tags such as en or pt-BR; the first is the default; with several languages, every "
            "text is a table with one text for each of them: `text.en`, `text.de`",
            ("en",),
        ),
        Field(
            "settings",
            TABLE,
            'settings of all trials, such as `encoder = "linear"`, or `vary = "size=0.7"`, '
            "in the form of `sandbox run --vary`",
            {},
        ),
        Field("factors", TABLES, "the varied factors, from the outermost to the innermost"),
        Field("trials", TABLE, "number, practice, time and display of trials", {}),
        Field("tasks", TABLES, "names and goals of tasks on the page", ()),
        Field(
            "words",
            TABLE,
            "words of the page by language: for a language that the page lacks, or instead of the "
            "page's own words",
            {},
        ),
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
            "setting",
            STRING,
            "the setting whose values are the levels; by default the one with the factor's name",
            "",
        ),
        Field("order", CHOICE, "order of the levels", "blocked", options=ORDERS),
        Field(
            "inside",
            STRING,
            "the outer factor in which this factor is nested; it must stand above this one",
            "",
        ),
        Field(
            "levels",
            LIST,
            'values of the setting, or tables that give several settings: `{name = "gentle", '
            'contact = "soft", impulse = "safe"}`; for a nested factor, a table with such a list '
            "for each level of the outer factor",
        ),
        Field(
            "one_a_session",
            FLAG,
            "each session has one of the levels, in the factor's order",
            False,
        ),
    ),
    "trials": (
        Field("repetitions", WHOLE, "trials of every combination of levels", 1, low=1, high=1000),
        Field(
            "repeat_inside",
            STRING,
            "a factor: inside each of its levels, the repetitions are rounds through all inner "
            "levels; without it, the repetitions of a combination of levels follow each other",
            "",
        ),
        Field(
            "practice",
            WHOLE,
            "number of trials in each practice; the report leaves them out",
            0,
            low=0,
            high=100,
        ),
        Field(
            "practice_each",
            STRING,
            "a factor: practice comes before each of its levels; without it, once at the start",
            "",
        ),
        Field("practice_sessions", SESSIONS, "sessions with practice; without it, all sessions"),
        Field("seeds", CHOICE, "how starts and goals are drawn", "own", options=SEEDS),
        Field(
            "learning",
            CHOICE,
            "how long measured layouts of fingers stay in use",
            "trial",
            options=LEARNING,
        ),
        Field(
            "time_limit_s",
            NUMBER,
            "time after which a trial ends, unless the task's own limit is shorter",
            600.0,
            "s",
            0.05,
            3600.0,
        ),
        Field(
            "expected_s", NUMBER, "how long a trial takes, for the plan", 20.0, "s", 0.05, 3600.0
        ),
        Field("shows", LIST, "what the page shows or plays", ("task", "goal"), options=SHOWS),
        Field("starts", CHOICE, "when a trial's time starts", "touch", options=STARTS),
        Field(
            "when_gone", CHOICE, "what happens while the page is away", "pause", options=WHEN_GONE
        ),
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
            "number of trials between breaks, practice not counted; 0 for no breaks. If practice "
            "and a break are due at the same time, practice comes first",
            0,
            low=0,
            high=10_000,
        ),
        Field("least_s", NUMBER, "shortest duration of a break", 30.0, "s", 0.0, 7200.0),
    ),
    "consent": (
        Field("text", TEXT, "the consent form; without it `run` takes no real participant"),
        Field("version", STRING, "version of the text, recorded with each consent", "1"),
    ),
    "instructions": (
        _AT,
        Field("level", STRING, "a level of the factor: the text comes before this level only", ""),
        Field("text", TEXT, "the text"),
        _SESSIONS,
    ),
    "questionnaires": (
        Field("name", NAME, "name in tables; without it, the value of `use`"),
        Field("use", STRING, "a questionnaire of the program, such as `nasa-tlx` or `sus`", ""),
        Field("file", STRING, "a TOML file beside the design with the keys below", ""),
        Field("at", CHOICE, "`start`, `end`, or a factor: after each of its levels", END),
        _SESSIONS,
        Field("title", TEXT, "heading for the participant"),
        Field("items", TABLES, "the questions"),
        Field(
            "every_item",
            TABLE,
            "keys of all questions that do not have their own, such as the ends of a scale",
            {},
        ),
        Field("scales", TABLES, "the scores; the report tests the first one", ()),
        Field("wording", CHOICE, "source of the wording", "own", options=WORDINGS),
        Field(
            "schema",
            WHOLE,
            "version of the layout of a questionnaire's own file",
            SCHEMA,
            low=1,
            high=SCHEMA,
        ),
    ),
    "items": (
        Field(
            "name",
            NAME,
            "name of the answer: of a column of `participants.csv`, or of rows of `answers.csv`",
        ),
        Field("kind", CHOICE, "kind of the question", "text", options=ITEMS),
        Field("ask", TEXT, "the question"),
        Field("choices", LIST, "values that are stored for a choice, equal in all languages", ()),
        Field("means", LIST, "texts of the choices for the participant, in the same order", ()),
        Field("low", NUMBER, "smallest answer", 0.0, low=-1e9, high=1e9),
        Field("high", NUMBER, "largest answer", 100.0, low=-1e9, high=1e9),
        Field("step", NUMBER, "step of a scale, which must reach `high`", 1.0, low=1e-9, high=1e9),
        Field("low_means", TEXT, "words at the low end of a scale; without it, no words"),
        Field("high_means", TEXT, "words at the high end; required with `low_means`"),
        Field("optional", FLAG, "the participant may leave the question out", False),
        Field(
            "shuffle",
            FLAG,
            "neighbouring questions with `shuffle` come in random order, as do their choices",
            False,
        ),
    ),
    "scales": (
        Field("name", NAME, "name of the score"),
        Field("rule", CHOICE, "how it is computed", "sum", options=RULES),
        Field("items", LIST, "names of its items, of kind scale or number"),
        Field(
            "reverse", LIST, "items of opposite meaning: `low + high - answer` is used instead", ()
        ),
        Field("from_zero", FLAG, "the item's `low` is subtracted from each answer", False),
        Field(
            "factor", NUMBER, "factor by which the result is multiplied", 1.0, low=-1e6, high=1e6
        ),
        Field(
            "pairs",
            LIST,
            "for rule `weighted`: items of kind choice, whose choices are names of this scale's "
            "items",
            (),
        ),
    ),
    "exclusions": (
        Field("name", NAME, "name of the rule in tables"),
        Field("of", CHOICE, "what is excluded; nothing is deleted", "trial", options=OF),
        Field("measure", STRING, "column of `trials.csv` with numbers"),
        Field(
            "below", NUMBER, "smaller values are excluded; without it, no bound", low=-1e9, high=1e9
        ),
        Field(
            "above", NUMBER, "larger values are excluded; without it, no bound", low=-1e9, high=1e9
        ),
    ),
    "analysis": (
        Field(
            "primary",
            LIST,
            "the outcomes that are tested: names of measures, and of questionnaires for their "
            "scores; without it, `time_s`, `success` and the score of every questionnaire that is "
            "asked at a factor",
        ),
        Field(
            "own_measure",
            STRING,
            "the study's own measure, in a file in the folder of the design: `FILE.py:NAME`",
            "",
        ),
    ),
}

FIELDS: dict[str, dict[str, Field]] = {
    table: {each.name: each for each in some} for table, some in _TABLES.items()
}
"""Fields by table and key. Questions of all tables are under `items`."""


def field_of(path: tuple[str | int, ...], key: str) -> Field:
    """The field of a key of the table at this path of a file.

    Args:
        path: Names and places in lists, from the outermost. For a questionnaire's own file, the
            first name is `questionnaires`, as for a questionnaire in the design.
        key: The key.
    """
    names = [part for part in path if isinstance(part, str)]
    table = "items" if names[-1:] == ["demographics"] else names[-1] if names else ""
    return FIELDS[table][key]
