"""Reads a study's tables from a folder, selects the trials to use, and averages them by person.

Only the CSV files are read, so a report can be made from any copy of the tables. The codebook has
the name and kind of the study, the number of people who withdrew, and changes of the design.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from hashlib import sha256
from math import inf, nan
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.arithmetic import Array
from models.errors import StudyError
from models.message import counted
from sandbox.study.design.fields import JOINED, LISTED
from sandbox.study.tables.column import (
    CHANGE,
    CLOCK_STEPS,
    CONDITIONS,
    EXPERIMENT,
    FACTOR,
    MODE,
    ORDERS,
    PRIMARY,
    STUDY,
    TABLES,
    TITLE,
    UXF_NAMES,
    WITHDRAWALS,
    WORDING,
)

if TYPE_CHECKING:
    from pandas import DataFrame, Series

    from sandbox.study.report.numbers import Estimate

NEEDED = ("ppid", "trial_num", "counted", "practice", "excluded", "success", "time_s")
"""Required columns of `trials.csv`."""
NUMBERS = (
    "session_num",
    "trial_num",
    "counted",
    "practice",
    "excluded",
    "success",
    "time_s",
    "attempt",
    "block_num",
    "trial_num_in_block",
    "repetition",
    "limit_s",
)
RATIO_UNITS = ("s", "m", "mm", "m/s", "bit/s", "ms")
"""Units of measures that are compared by ratios if all values are above 0. They are used for
columns whose scale the codebook does not have."""
LABEL_TRUTH, SIMULATED_USER = "label_truth", "simulated user"
"""Column with the source of the true fingers, and its value for trials of a simulated user."""
FRAMES = "frames"
"""Column with the file of the frames."""
SIMULATED = "simulated"
"""Kind of the data of a study with simulated participants."""
RECORDS = "*/S[0-9][0-9][0-9]/session.jsonl"
"""Journals from which the tables of a study are derived."""
SESSION = "session"
"""Name of the factor that is added if participants do the same levels in several sessions."""


def _empty() -> DataFrame:
    import pandas as pd

    return pd.DataFrame()


@dataclass(frozen=True)
class ObservedFactor:
    """A factor of the design.

    Attributes:
        name: Name as in the design.
        levels: Levels in the design's order.
        within: True if at least one participant did more than one of the levels.
    """

    name: str
    levels: tuple[str, ...]
    within: bool

    @property
    def column(self) -> str:
        """Name of the factor's column in tables."""
        return FACTOR + self.name

    @property
    def place(self) -> str:
        """Name of the column of `StudyData.used` with the place of a trial's level in its order."""
        return "place of " + self.name

    @property
    def round(self) -> str:
        """Name of the column of `StudyData.used` with the round; each round has its own order."""
        return "round of " + self.name


@dataclass(frozen=True)
class Measure:
    """An outcome, and the scale on which it is averaged and compared.

    Attributes:
        name: Column of `trials.csv`, or name of a questionnaire, scale or question.
        title: Title in the report.
        unit: Unit of the values; empty for counts and indices.
        means: Definition in one line.
        better: high or low, the better direction; empty if neither is better.
        low, high: Smallest and largest possible value.
        scale: `limit`, a time with a limit; `share`, 0 or 1; `count`; `log`, a number whose ratios
            are compared; `plain`, any other number; `score`, of a questionnaire.
    """

    name: str
    title: str
    unit: str = ""
    means: str = ""
    better: str = ""
    low: float = -inf
    high: float = inf
    scale: str = "plain"

    @property
    def label(self) -> str:
        """Title with unit."""
        if self.scale == "share":
            return f"{self.title} (% of trials)"
        return f"{self.title} ({self.unit})" if self.unit else self.title

    @property
    def forward_limits(self) -> tuple[float, float]:
        """Smallest and largest possible value on the scale of the means."""
        return (-inf, inf) if self.scale == "log" else (self.low, self.high)

    def forward(self, values: Array) -> Array:
        """Converts values to the scale on which they are averaged."""
        return np.log(values) if self.scale == "log" else values

    def in_unit(self, mean: Estimate) -> Estimate:
        """Converts a mean on that scale back to the unit.

        A difference of logarithms becomes a ratio.
        """
        if self.scale != "log":
            return mean
        value, low, high = (float(np.exp(v)) for v in (mean.value, mean.low, mean.high))
        return replace(mean, value=value, low=low, high=high)


@dataclass(frozen=True)
class Values:
    """An outcome of every person under every condition.

    Attributes:
        factors: Factors whose combinations of levels are the conditions.
        names: Names of the conditions.
        levels: For each condition, the level of each factor by the factor's name.
        means: (people, conditions) means of each person's trials, on the outcome's scale; nan for
            a person without values. The people are `StudyData.ppids`, in order.
        trials: (people, conditions) numbers of trials.
        limits: Time limits of the trials of each condition, s.
    """

    factors: tuple[ObservedFactor, ...]
    names: tuple[str, ...]
    levels: tuple[dict[str, str], ...]
    means: Array
    trials: Array
    limits: tuple[frozenset[float], ...] = ()

    def cells_of(self, factor: ObservedFactor, level: str) -> list[int]:
        """Indices of the conditions that have this level."""
        return [i for i, of in enumerate(self.levels) if of.get(factor.name) == level]

    def by_level(self, factor: ObservedFactor) -> Array:
        """Means of every person under each level of a factor, (people, levels)."""
        return np.column_stack(
            [row_means(self.means[:, self.cells_of(factor, x)]) for x in factor.levels]
        )

    def matched(self, factor: ObservedFactor, first: str, second: str) -> list[tuple[int, int]]:
        """Pairs of conditions that differ only in these two levels of a factor."""

        def apart_from_it(cell: int) -> dict[str, str]:
            return {name: x for name, x in self.levels[cell].items() if name != factor.name}

        return [
            (a, b)
            for a in self.cells_of(factor, first)
            for b in self.cells_of(factor, second)
            if apart_from_it(a) == apart_from_it(b)
        ]

    def limit(self, cell: int) -> frozenset[float]:
        """Time limits of the trials of a condition, s."""
        return self.limits[cell] if self.limits else frozenset()


def row_means(values: Array) -> Array:
    """Mean of the finite values in each row, (n,); nan for a row without finite values."""
    known = np.isfinite(values)
    count = known.sum(axis=1)
    sums = np.where(known, values, 0.0).sum(axis=1)
    means: Array = np.where(count > 0, sums / np.maximum(count, 1), nan)
    return means


@dataclass(frozen=True)
class Words:
    """The answers to a question whose answers are texts or choices.

    Attributes:
        form, item: Names of the questionnaire and the question.
        ask: The question.
        is_choice: True if the answers are choices.
        answers: (person, condition, answer) of each answer, in the order of the table.
    """

    form: str
    item: str
    ask: str
    is_choice: bool
    answers: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class StudyData:
    """A study's tables.

    Attributes:
        name: Name of the study.
        mode: real, pilot, simulated, or unknown.
        factors: Factors in the design's order.
        trials: Every finished attempt, as in the table, with numbers converted.
        used: Counted attempts, without practice and excluded trials. These columns are added:
            `condition`;
            `cell`, the index of the condition;
            `position`, the number of the participant's trial, from 1, without practice (counted
            within the session if `by_session`);
            `censored`, True without success: the time to success would have been longer;
            and, for every factor, the round, and the place of the level in the order of the round,
            both from 1. Excluded trials also count for `position` and for places, since people
            learn from them, too.
        conditions: Names of all combinations of levels that were used, in the design's order.
        people: `participants.csv`, or participants derived from the trials.
        answers: `answers.csv`; may be empty.
        scores: `scores.csv`; may be empty.
        primary: Confirmatory outcomes of the design: measures, and questionnaires for their scores.
            Empty if the design names none.
        by_session: True if the session was added as a factor.
        wordings: Notes in the codebook on questionnaires whose wording is not the published
            wording, by questionnaire.
        digest: SHA-256 of `trials.csv`.
        withdrawn: Number of people who withdrew, whose data were deleted; None if the codebook does
            not have it.
        upgrades: Sentences on every `--force-upgrade` after the first participation.
        events: `events.csv`; may be empty.
        columns: Rows of the codebook about factors, measures and questions, by name.
        has_records: True if the journals from which the tables follow are in the folder.
        title: Title of the design; empty if it has none.
        unused: Combinations of the design without a used trial, with a level for each of `factors`;
            empty if the codebook does not have the design's combinations.
    """

    name: str
    mode: str
    factors: tuple[ObservedFactor, ...]
    trials: DataFrame
    used: DataFrame
    conditions: tuple[str, ...]
    people: DataFrame
    answers: DataFrame
    scores: DataFrame
    primary: tuple[str, ...] = ()
    by_session: bool = False
    digest: str = ""
    wordings: dict[str, str] = field(default_factory=dict)
    withdrawn: int | None = None
    upgrades: tuple[str, ...] = ()
    events: DataFrame = field(default_factory=_empty)
    columns: dict[str, dict[str, str]] = field(default_factory=dict)
    has_records: bool = True
    title: str = ""
    unused: tuple[tuple[str, ...], ...] = ()

    @property
    def orders(self) -> str:
        """Text on the number of participants in a full cycle of orders; empty if unknown."""
        return self.columns.get(ORDERS, {}).get("meaning", "")

    @property
    def unused_conditions(self) -> tuple[str, ...]:
        """Names of the combinations without a used trial.

        A name has the levels of factors with several used levels, as in `conditions`. If a used
        condition has the same name, the name has the levels of all factors.
        """
        several = [i for i, f in enumerate(self.factors) if len(f.levels) > 1]
        names = [JOINED.join(levels[i] for i in several) for levels in self.unused]
        return tuple(
            JOINED.join(levels) if name in self.conditions or not name else name
            for name, levels in zip(names, self.unused, strict=True)
        )

    def unused_levels(self, factor: ObservedFactor) -> list[str]:
        """Levels of a factor of the design without a used trial."""
        place = self.factors.index(self.factor(factor.name))
        seen = self.used[factor.column].unique() if len(self.used) else ()
        return list(dict.fromkeys(x[place] for x in self.unused if x[place] not in seen))

    @property
    def ppids(self) -> list[str]:
        """Participants with used trials, in order of first appearance."""
        return list(dict.fromkeys(self.used["ppid"]))

    @property
    def clock_steps(self) -> list[str]:
        """A line about steps of the wall clock during sessions; none without steps."""
        if CLOCK_STEPS not in self.people:
            return []
        steps = {
            person: steps
            for person, steps in zip(self.people["ppid"], self.people[CLOCK_STEPS], strict=True)
            if steps
        }
        if not steps:
            return []
        told = ", ".join(f"{person} {steps} s" for person, steps in steps.items())
        return [
            f"The wall clock was set during sessions ({told}). No time in this report depends on "
            "it: all times come from a clock that cannot be set"
        ]

    @property
    def rehearsed(self) -> str:
        """Sentence on trials that a simulated user played in a study of people, such as in a
        rehearsal; empty without such trials."""
        if self.mode == SIMULATED or LABEL_TRUTH not in self.used:
            return ""
        # The source is empty for a trial without touches.
        telling = [source for source in self.used[LABEL_TRUTH] if source]
        count = telling.count(SIMULATED_USER)
        if not count:
            return ""
        if count == len(telling):
            return "No person took part: a simulated user played all trials."
        return f"A simulated user, and no person, played {count} of {len(self.used)} trials."

    @property
    def withdrawals(self) -> str:
        """Sentence on people who withdrew; empty if their number is unknown."""
        if self.withdrawn is None:
            return ""
        if not self.withdrawn:
            return "Nobody withdrew."
        return (
            f"{counted(self.withdrawn, 'person', 'people')} withdrew. All their data were deleted, "
            "and no other number in this report includes them."
        )

    @property
    def without_frames(self) -> list[str]:
        """A line about counted trials whose frames are missing; none without such trials."""
        used = self.trials[self.trials["counted"] == 1]
        missing = int((used[FRAMES] == "").sum()) if FRAMES in used else 0
        if not missing:
            return []
        return [
            f"{counted(missing, 'trial has', 'trials have')} no frames, so that their measures of "
            "movements and contacts are empty"
        ]

    def factor(self, name: str) -> ObservedFactor:
        """Finds a factor by its name."""
        return next(f for f in self.factors if f.name == name)

    @property
    def measures(self) -> list[str]:
        """Names of the measures that have a title in the codebook, in order."""
        return [name for name, row in self.columns.items() if row.get("title")]

    def measure(self, name: str, must: bool = False) -> Measure | None:
        """A measure of the trials used; None if its column has no numbers.

        Args:
            name: Name of the column.
            must: True raises an error instead of returning None.

        Raises:
            StudyError: The column does not exist, or has no numbers; only if `must`.
        """
        if name not in self.trials.columns:
            if not must:
                return None
            numbers = [c for c in self.trials if to_numbers(self.trials[c]).notna().any()]
            near = get_close_matches(name, numbers, 1)
            raise StudyError(
                "no such measure in this study",
                where="--measure",
                got=name,
                expected="a column of trials.csv with numbers",
                remedy=f"Did you mean {near[0]}?" if near else None,
            )
        values = to_numbers(self.used[name]).dropna()
        if not len(values):
            if must:
                raise StudyError(
                    "the measure has no numbers in the trials used",
                    where="--measure",
                    got=name,
                    remedy="Name another column of trials.csv, or leave it out",
                )
            return None
        row = self.columns.get(name, {})
        unit = row.get("unit", "") or ("s" if name == "time_s" else "")
        low, high = (number_in(row.get(end, ""), nothing) for end, nothing in ENDS)
        title = row.get("title") or name.replace("_", " ").capitalize()
        what = Measure(
            name, title, unit, row.get("meaning", ""), row.get("better", ""), low, high, "plain"
        )
        if name == "time_s":
            limit = float(self.used["limit_s"].max()) if len(self.used) else inf
            return replace(what, title="Time to success", scale="limit", low=0.0, high=limit)
        scale = row.get("scale") or _guessed_scale(name, unit, values)
        if scale == "share":
            return replace(what, scale=scale, low=0.0, high=1.0)
        if scale == "log" and (values > 0.0).all():
            return replace(what, scale=scale)
        if scale == "count":
            return replace(what, scale=scale, low=max(0.0, low))
        return what


def _guessed_scale(name: str, unit: str, values: Series) -> str:
    """Scale of a column without a scale in the codebook, such as in an older table."""
    if name == "success" or unit == "0/1":
        return "share"
    if unit in RATIO_UNITS:
        return "log"
    return "count" if not unit and ((values >= 0.0) & (values % 1.0 == 0.0)).all() else "plain"


ENDS = (("low", -inf), ("high", inf))
"""Columns of the codebook with the smallest and the largest possible value of a measure, each with
the value for an empty cell."""


def number_in(text: str, nothing: float = nan) -> float:
    """The number in a cell; `nothing` if the cell has none."""
    try:
        return float(text)
    except ValueError:
        return nothing


def trial_numbers(data: StudyData, what: Measure) -> Array:
    """Values (n,) of a measure in the trials used, on the scale of the means; nan without a value.

    A time with a limit is the limit in trials without success.
    """
    used = data.used
    numbers = to_numbers(used[what.name]).to_numpy(float)
    if what.scale == "limit":
        limits = used["limit_s"].to_numpy(float)
        shorter = np.where(np.isfinite(limits), np.minimum(numbers, limits), numbers)
        return np.where(used["censored"], limits, shorter)
    return what.forward(np.where(numbers > 0.0, numbers, nan)) if what.scale == "log" else numbers


def trial_values(data: StudyData, what: Measure) -> Values:
    """Person means of a measure by condition.

    A time with a limit is the limit in a trial without success, so its mean is the restricted mean.
    """
    used, numbers = data.used, trial_numbers(data, what)
    factors = tuple(f for f in data.factors if len(f.levels) > 1)
    seen = used.drop_duplicates("cell").sort_values("cell")
    levels = tuple({f.name: row[f.column] for f in factors} for _, row in seen.iterrows())
    means, trials = _by_person(data, used["ppid"], used["cell"].tolist(), numbers, len(levels))
    of = [frozenset(used.loc[used["cell"] == i, "limit_s"].dropna()) for i in range(len(levels))]
    return Values(factors, data.conditions, levels, means, trials, tuple(of))


def _by_person(
    data: StudyData, ppids: Series, cells: Sequence[int], numbers: Array, count: int
) -> tuple[Array, Array]:
    """Means and numbers of the finite values of each person in each cell, both (people, cells)."""
    row = {ppid: i for i, ppid in enumerate(data.ppids)}
    at = np.array([row.get(ppid, -1) for ppid in ppids], dtype=np.intp)
    known = np.isfinite(numbers) & (at >= 0)
    sums, trials = np.zeros((len(row), count)), np.zeros((len(row), count))
    where = (at[known], np.asarray(cells, dtype=np.intp)[known])
    np.add.at(sums, where, numbers[known])
    np.add.at(trials, where, 1.0)
    return np.where(trials > 0, sums / np.maximum(trials, 1.0), nan), trials


def score_values(data: StudyData, main: bool = True) -> list[tuple[Measure, Values]]:
    """Scores of questionnaires, by person and level.

    Args:
        data: The study.
        main: True returns the first scale of each questionnaire about levels, which is the
            questionnaire's score; False returns all other scales.
    """
    table = data.scores
    if not {"instrument", "scale", "score", "ppid"} <= set(table.columns):
        return []
    firsts = {form: rows["scale"].iloc[0] for form, rows in table.groupby("instrument", sort=False)}
    found = []
    for (form, scale), rows in table.groupby(["instrument", "scale"], sort=False):
        ends = (rows[name].iloc[0] if name in rows else "" for name in ("score_low", "score_high"))
        low, high = (number_in(text, end) for text, end in zip(ends, (-inf, inf), strict=True))
        same = str(scale).lower() in (str(form).lower(), "score", "total", "")
        title = str(form) if same else f"{form}: {scale}"
        name = str(form) if firsts[form] == scale else title
        what = Measure(name, title, "", "", "", low, high, "score")
        values = _answered(data, rows, to_numbers(rows["score"]).to_numpy(float))
        compared = firsts[form] == scale and bool(values.factors)
        if compared is main:
            found.append((what, values))
    return found


def item_values(data: StudyData) -> list[tuple[Measure, Values]]:
    """Answers to single questions whose answers are numbers, by person and level.

    Questions that are a scale by themselves, and questions about the person, are left out.
    """
    table = data.answers
    if not {"ppid", "instrument", "item", "answer"} <= set(table.columns):
        return []
    scores = {what.title for main in (True, False) for what, _ in score_values(data, main)}
    found = []
    for (form, item), rows in table.groupby(["instrument", "item"], sort=False):
        given = rows["answer"].astype(str).str.strip() != ""
        numbers = to_numbers(rows["answer"])
        title = f"{form}: {item}"
        if form == ABOUT_PERSON or title in scores or (f"{form}" in scores and item == form):
            continue
        if given.any() and numbers[given].notna().all():
            what = Measure(title, title, scale="score")
            found.append((what, _answered(data, rows, numbers.to_numpy(float))))
    return found


ABOUT_PERSON = "demographics"
"""Name of the form with questions about the person."""


def _answered(data: StudyData, rows: DataFrame, numbers: Array) -> Values:
    """Answers by person and by the levels that they are about."""
    factors = tuple(f for f in data.factors if f.column in rows and rows[f.column].nunique() > 1)
    asked = [tuple(row) for row in rows[[f.column for f in factors]].itertuples(index=False)]
    rank = {f.name: {x: i for i, x in enumerate(f.levels)} for f in factors}

    def order(levels: tuple[str, ...]) -> tuple[int, ...]:
        pairs = zip(factors, levels, strict=True)
        return tuple(rank[f.name].get(level, len(f.levels)) for f, level in pairs)

    cells = sorted(set(asked), key=order) if factors else [()]
    at = [cells.index(levels) for levels in asked] if factors else [0] * len(rows)
    means, trials = _by_person(data, rows["ppid"], at, numbers, len(cells))
    levels = tuple({f.name: x for f, x in zip(factors, c, strict=True)} for c in cells)
    names = tuple(JOINED.join(c) or "all" for c in cells)
    return Values(factors, names, levels, means, trials)


def words(data: StudyData) -> list[Words]:
    """All answers that are texts or choices, by question."""
    table = data.answers
    if not {"ppid", "instrument", "item", "answer"} <= set(table.columns):
        return []
    columns = [f.column for f in data.factors if f.column in table.columns]
    found = []
    for (form, item), rows in table.groupby(["instrument", "item"], sort=False):
        row = data.columns.get(f"item {form}/{item}") or data.columns.get(f"{item}") or {}
        given = rows[rows["answer"].astype(str).str.strip() != ""]
        kind = row.get("type", "")
        if not kind and to_numbers(given["answer"]).isna().any():
            kind = "text"
        if kind not in ("text", "factor") or not len(given):
            continue
        answers = [
            (r["ppid"], JOINED.join(x for x in (r[c] for c in columns) if x), r["answer"])
            for _, r in given.iterrows()
        ]
        ask = row.get("meaning", "")
        found.append(Words(str(form), str(item), ask, kind == "factor", tuple(answers)))
    return found


def load_study(folder: Path) -> StudyData:
    """Reads a study's tables.

    Args:
        folder: Folder of the study, which contains `tables/trials.csv`.

    Raises:
        StudyError: The table is missing, or is not a table of trials.
    """
    tables = folder / TABLES
    path = tables / "trials.csv"
    if not path.is_file():
        raise StudyError(
            "the folder has no tables/trials.csv",
            where=str(folder),
            expected="the folder of a study",
            remedy="Give OUT/NAME, OUT/NAME-pilot or OUT/NAME-simulated; `sandbox study tables` "
            "makes the tables",
        )
    trials = _read(path)
    missing = [name for name in NEEDED if name not in trials.columns]
    if missing:
        raise StudyError(
            "columns are missing",
            where=str(path),
            got=", ".join(trials.columns[:8]),
            expected=", ".join(missing),
        )
    for name in NUMBERS:
        if name in trials.columns:
            trials[name] = to_numbers(trials[name], path)
    book = _codebook(tables)
    facts, described = _meanings(book[book["table"] == STUDY]), _described(book)
    answers, scores = (_optional(tables / name) for name in ("answers.csv", "scores.csv"))
    by_session = _did_the_same_again(trials)
    if by_session:
        for table in (trials, answers, scores):
            _name_sessions(table)
    factors = _factors(trials, described)
    used, conditions = _used(trials, factors, by_session)
    people = _optional(tables / "participants.csv")
    if "ppid" not in people.columns:
        people = trials[["ppid"]].drop_duplicates().reset_index(drop=True)
    return StudyData(
        name=_only(trials, EXPERIMENT, path) or facts.get(EXPERIMENT) or folder.resolve().name,
        mode=_only(trials, MODE, path) or facts.get(MODE) or "unknown",
        factors=factors,
        trials=trials,
        used=used,
        conditions=conditions,
        people=people,
        answers=answers,
        scores=scores,
        primary=_primary(book),
        by_session=by_session,
        digest=sha256(path.read_bytes()).hexdigest(),
        wordings=_wordings(book),
        withdrawn=int(facts[WITHDRAWALS]) if WITHDRAWALS in facts else None,
        upgrades=tuple(text for name, text in facts.items() if name.startswith(CHANGE)),
        events=_optional(tables / "events.csv"),
        columns=described,
        has_records=any(folder.glob(RECORDS)),
        title=facts.get(TITLE, ""),
        unused=_unused(facts.get(CONDITIONS, ""), factors, used),
    )


def read_table(path: Path) -> DataFrame:
    """Reads a table with all cells as text, so that a pseudonym like 12E345 stays a text.

    Raises:
        StudyError: The file is not a table.
    """
    import pandas as pd

    try:
        return pd.read_csv(path, dtype=str, keep_default_na=False, encoding="utf-8")
    except (ValueError, pd.errors.ParserError) as error:
        raise StudyError(
            "not a table",
            where=str(path),
            got=str(error).strip()[:120],
            remedy="`sandbox study tables` makes all tables again",
        ) from None
    except OSError as error:
        raise StudyError(
            "the table cannot be read",
            where=str(path),
            got=error.strerror,
            remedy="Give read permission",
        ) from None


def to_numbers(column: Series, path: Path | None = None) -> Series:
    """Converts a column to numbers; empty cells become NaN.

    Args:
        column: The cells.
        path: File of the table; None converts invalid cells to NaN.

    Raises:
        StudyError: A cell is not a number; only if `path` is given.
    """
    import pandas as pd

    texts = column.astype(str).str.strip()
    numbers = pd.to_numeric(texts, errors="coerce").astype(float)
    wrong = numbers.isna() & (texts != "")
    if path is not None and wrong.any():
        row = int(wrong.to_numpy().argmax())
        raise StudyError(
            "not a number",
            where=f"{path}: {column.name}, row {row + 2}",
            got=str(column.iloc[row])[:40],
            expected="a number or an empty cell",
            remedy="`sandbox study tables` makes all tables again",
        )
    return numbers


def _optional(path: Path) -> DataFrame:
    import pandas as pd

    return _read(path) if path.is_file() else pd.DataFrame()


def _read(path: Path) -> DataFrame:
    """Reads a table, and renames its columns to the names of UXF where these differ."""
    return read_table(path).rename(columns=UXF_NAMES)


def _only(trials: DataFrame, column: str, path: Path) -> str:
    """The single value that a column has in all rows; empty if it has none."""
    values = [x for x in dict.fromkeys(trials.get(column, ())) if x]
    if len(values) > 1:
        raise StudyError(
            "data of different kinds must not be mixed",
            where=f"{path}: {column}",
            got=", ".join(values[:4]),
            expected="the same in every row",
        )
    return str(values[0]) if values else ""


def _codebook(tables: Path) -> DataFrame:
    """The codebook, with the names of columns as in UXF; without rows if the file is missing."""
    import pandas as pd

    book = _optional(tables / "codebook.csv")
    if not {"table", "column", "meaning"} <= set(book.columns):
        return pd.DataFrame(columns=["table", "column", "meaning"])
    book["column"] = [UXF_NAMES.get(name, name) for name in book["column"]]
    return book


def _meanings(rows: DataFrame) -> dict[str, str]:
    """Meanings of some rows of the codebook, by name."""
    return dict(zip(rows["column"], rows["meaning"], strict=True))


def _described(book: DataFrame) -> dict[str, dict[str, str]]:
    """Rows about factors, measures and questions, by name; the first row of each name."""
    about = book["table"].isin(["trials.csv", "participants.csv", "answers.csv"])
    found: dict[str, dict[str, str]] = {}
    for _, row in book[about].iterrows():
        found.setdefault(row["column"], dict(row))
    return found


def _primary(book: DataFrame) -> tuple[str, ...]:
    """Names of primary outcomes. The codebook names a score `score QUESTIONNAIRE/SCALE`; the name
    of the questionnaire is returned."""
    named = book.loc[book["role"] == PRIMARY, "column"] if "role" in book else ()
    return tuple(str(name).removeprefix("score ").partition("/")[0] for name in named)


def _wordings(book: DataFrame) -> dict[str, str]:
    """Notes in the codebook on questionnaires without the published wording, by questionnaire."""
    told = _meanings(book[book["column"].astype(str).str.startswith(WORDING)])
    return {name.removeprefix(WORDING): meaning for name, meaning in told.items()}


def _unused(
    conditions: str, factors: Sequence[ObservedFactor], used: DataFrame
) -> tuple[tuple[str, ...], ...]:
    """Combinations of the design without a used trial.

    Args:
        conditions: Combinations of the design, as listed in the codebook. The list does not have
            levels of an earlier design, or sessions.
        factors: Factors of the trials.
        used: The trials used.
    """
    planned = [tuple(name.split(JOINED)) for name in conditions.split(LISTED) if name]
    by_session = bool(factors) and factors[0].name == SESSION
    if by_session:
        planned = [(session, *levels) for session in factors[0].levels for levels in planned]
    if any(len(levels) != len(factors) for levels in planned):
        return ()
    there = set(used[[f.column for f in factors]].itertuples(index=False, name=None))
    return tuple(levels for levels in planned if levels not in there)


def _did_the_same_again(trials: DataFrame) -> bool:
    """Returns True if a participant had the same levels in two sessions.

    Then sessions are compared. Otherwise each session has its own levels, and is not a factor.
    """
    factors = [name for name in trials.columns if name.startswith(FACTOR)]
    if "session_num" not in trials.columns or FACTOR + SESSION in factors:
        return False
    main = trials[(trials["counted"] == 1) & (trials["practice"] != 1)]
    return bool((main.groupby(["ppid", *factors])["session_num"].nunique() > 1).any())


def _name_sessions(table: DataFrame) -> None:
    """Adds the session to a table as its outermost factor."""
    if "session_num" in table.columns:
        numbers = to_numbers(table["session_num"])
        table.insert(0, FACTOR + SESSION, [f"session {n:g}" for n in numbers])


def _factors(trials: DataFrame, described: dict[str, dict[str, str]]) -> tuple[ObservedFactor, ...]:
    main = trials[(trials["counted"] == 1) & (trials["practice"] != 1)]
    factors = []
    for column in trials.columns:
        if not column.startswith(FACTOR):
            continue
        seen = [x for x in dict.fromkeys(main[column]) if x]
        listed = _listed(described.get(column, {}).get("meaning", "").partition(": ")[2], seen)
        # The codebook has the design's order. Levels that the codebook does not have come last.
        levels = [x for x in listed if x in seen] + [x for x in seen if x not in listed]
        within = len(main) > 0 and bool((main.groupby("ppid")[column].nunique() > 1).any())
        factors.append(ObservedFactor(column.removeprefix(FACTOR), tuple(levels), within))
    return tuple(factors)


def _listed(text: str, names: Sequence[str]) -> list[str]:
    """Splits a list of names. Names may contain the separator: the longest known name is taken."""
    parts = text.split(LISTED)
    entries: list[str] = []
    while parts:
        lengths = range(len(parts), 0, -1)
        count = next((n for n in lengths if LISTED.join(parts[:n]) in names), 1)
        entries.append(LISTED.join(parts[:count]))
        parts = parts[count:]
    return list(dict.fromkeys(entries))


def _rounds(main: DataFrame, within: Sequence[str], factor: ObservedFactor) -> Series:
    """Number of the round of every trial.

    With `repeat_inside`, the levels recur in each round, in the order of that round. Without it,
    there is one round.
    """
    import pandas as pd

    if "repetition" in main.columns:
        for _, levels in main.groupby(list(within), sort=False)[factor.column]:
            if (levels != levels.shift()).sum() > levels.nunique():
                return to_numbers(main["repetition"]).fillna(1).astype(int)
    return pd.Series(1, index=main.index)


def _first_places(levels: Series) -> Series:
    """Place of every level in the order of their first appearance, from 1."""
    return levels.map({x: i + 1 for i, x in enumerate(dict.fromkeys(levels))}).astype(int)


def _used(
    trials: DataFrame, factors: Sequence[ObservedFactor], by_session: bool
) -> tuple[DataFrame, tuple[str, ...]]:
    order = [name for name in ("session_num", "trial_num") if name in trials.columns]
    main = trials[(trials["counted"] == 1) & (trials["practice"] != 1)]
    main = main.sort_values(order, kind="stable").copy()
    # Excluded trials count for the position, since people learn from them, too. If sessions are
    # compared, learning from session to session is a difference between them, so that the position
    # is counted within each session.
    once = ["ppid", "session_num"] if by_session else ["ppid"]
    main["position"] = main.groupby(once, sort=False).cumcount() + 1
    for i, factor in enumerate(factors):
        within = ["ppid", *(f.column for f in factors[:i])]
        main[factor.round] = _rounds(main, within, factor)
        places = main.groupby([*within, factor.round], sort=False)[factor.column]
        main[factor.place] = places.transform(_first_places)
    used = main[(main["excluded"] != 1) & main["success"].isin([0, 1])].copy()
    used = used.sort_values("ppid", kind="stable").reset_index(drop=True)
    columns = [f.column for f in factors if len(f.levels) > 1]
    used["condition"] = "all"
    if columns and len(used):
        first, *rest = (used[column] for column in columns)
        used["condition"] = first.str.cat(rest, sep=JOINED) if rest else first
    rank = {f.column: {x: i for i, x in enumerate(f.levels)} for f in factors}
    seen = used[["condition", *columns]].drop_duplicates()
    keys = [tuple(rank[c].get(row[c], -1) for c in columns) for _, row in seen.iterrows()]
    conditions = tuple(
        str(seen["condition"].iloc[i]) for i in sorted(range(len(keys)), key=keys.__getitem__)
    )
    number = {name: i for i, name in enumerate(conditions)}
    used["cell"] = np.array([number[x] for x in used["condition"]], dtype=int)
    used["censored"] = used["success"] != 1
    if "limit_s" not in used or used["limit_s"].isna().all():
        # The table has no limits. If some trial failed, the longest time is used as the limit.
        used["limit_s"] = used["time_s"].max() if used["censored"].any() else np.inf
    return used, conditions
