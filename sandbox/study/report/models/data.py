"""Reads a study's tables from a folder, and selects the used trials.

Only the CSV files are read, so that a report can be made from any copy; `study.json`, if present,
only gives the name and kind of a study without trials, and `study.jsonl` the number of people who
withdrew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct

from models.errors import StudyError
from models.json_input import decoded, read_bytes
from models.message import counted
from sandbox.study.measures.kept import DIFFERS, WORDING, kept_lines
from sandbox.study.measures.measure import PRIMARY, SIMULATED_USER
from sandbox.study.record.folder import SIMULATED, STUDY_JOURNAL, withdrawals_of
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_clock import CLOCK_STEPS
from sandbox.study.report.models.upgrades import upgrades_of

if TYPE_CHECKING:
    from pandas import DataFrame, Series

NEEDED = ("ppid", "trial_num", "counted", "practice", "excluded", "success", "time_s")
"""Required columns of `trial_results.csv`."""
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
)
LABEL_TRUTH = "label_truth"
"""Column with the source of the true fingers."""
FACTOR = "factor_"
SESSION = "session"
"""Name of the factor that is added if participants repeat the same levels in several sessions."""
BETWEEN_NAMES = " / "
"""Separator of levels in the name of a condition; ASCII only, for spreadsheets."""
BETWEEN_LISTED = ", "
"""Separator of levels in the codebook."""
TIMEOUT = "timeout"


@dataclass(frozen=True)
class ObservedFactor:
    """A factor of the design.

    Attributes:
        name: Name as in the design.
        levels: Levels in the design's order.
        within: True if at least one participant did more than one of them.
    """

    name: str
    levels: tuple[str, ...]
    within: bool

    @property
    def column(self) -> str:
        """Name of its column in tables."""
        return FACTOR + self.name

    @property
    def place(self) -> str:
        """Name of the column of `StudyData.used` with the place of its level in its order."""
        return "place of " + self.name

    @property
    def round(self) -> str:
        """Name of the column of `StudyData.used` with the round, whose order is its own."""
        return "round of " + self.name

    @property
    def count(self) -> str:
        """Name of the column of `StudyData.used` with the number of the trial with its level."""
        return "count of " + self.name


@dataclass(frozen=True)
class StudyData:
    """A study's tables.

    Attributes:
        name: Name of the study.
        mode: real, pilot, simulated, or unknown.
        factors: Factors in the design's order.
        trials: Every finished attempt, as in the table, with numbers converted.
        used: Counted attempts, without practice and excluded trials. Added columns: `condition`,
            `cell` (its number), `position` (number of the participant's trial, from 1, without
            practice; in its session, where `by_session`), `censored` (no success, so that it would
            have taken longer), and for every factor the round, the place of its level in the order
            of the round, and the number of the participant's trial with its level, all from 1.
            Excluded trials count in them and in `position`, since they were practice as well.
        conditions: Names of all combinations of levels that were used, in the design's order.
        people: `participants.csv`, or participants derived from the trials.
        answers: `questionnaires.csv`; may be empty.
        scores: `questionnaire_scores.csv`; may be empty.
        codebook: Unit and meaning of columns of `trial_results.csv`.
        primary: Confirmatory outcomes of the design: measures, and questionnaires for their scores.
            Empty if it names none.
        by_session: True if the session was added as a factor.
        wordings: What the codebook says of questionnaires that have not the published wording.
        digest: SHA-256 of `trial_results.csv`.
        withdrawn: Number of people who withdrew, and of whom nothing else is here; None if the
            folder has no sound journal of the study.
        upgrades: Sentences on every `--force-upgrade` after somebody had taken part.
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
    codebook: dict[str, tuple[str, str]] = field(default_factory=dict)
    primary: tuple[str, ...] = ()
    by_session: bool = False
    digest: str = ""
    wordings: dict[str, str] = field(default_factory=dict)
    withdrawn: int | None = None
    upgrades: tuple[str, ...] = ()

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
            f"The wall clock made steps during sessions ({told}), and no time here depends on it: "
            "all come from a clock that nobody sets"
        ]

    @property
    def rehearsed(self) -> str:
        """Sentence on trials that a simulated user played although these are not simulated data, as
        in a rehearsal; empty if there are none."""
        if self.mode == SIMULATED or LABEL_TRUTH not in self.used:
            return ""
        # A trial without touches does not tell.
        telling = [source for source in self.used[LABEL_TRUTH] if source]
        count = telling.count(SIMULATED_USER)
        if not count:
            return ""
        if count == len(telling):
            return "No person took part: a simulated user played all trials."
        return f"A simulated user, and no person, played {count} of {len(self.used)} trials."

    @property
    def withdrawals(self) -> str:
        """Sentence on people who withdrew; empty if the folder does not tell."""
        if self.withdrawn is None:
            return ""
        if not self.withdrawn:
            return "Nobody withdrew."
        return (
            f"{counted(self.withdrawn, 'person', 'people')} withdrew. All their data were deleted, "
            "and no other number here counts them."
        )

    @property
    def kept(self) -> list[str]:
        """One line for every cause for which measures of counted trials were kept as recorded."""
        counted = self.trials[self.trials["counted"] == 1]
        return kept_lines(counted.get(DIFFERS, ()))

    def factor(self, name: str) -> ObservedFactor:
        """Finds a factor by its name."""
        return next(f for f in self.factors if f.name == name)


def load_study(folder: Path) -> StudyData:
    """Reads a study's tables.

    Args:
        folder: Folder of the study, which contains `trial_results.csv`.

    Raises:
        StudyError: The table is missing, or is not a table of trials.
    """
    path = folder / "trial_results.csv"
    if not path.is_file():
        raise StudyError(
            "the folder has no trial_results.csv",
            where=str(folder),
            expected="the folder of a study",
            remedy="Give OUT/NAME, OUT/NAME-pilot or OUT/NAME-simulated",
        )
    trials = read_table(path)
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
    meanings, primary = _codebook(folder)
    told = wordings(folder)
    about = _about(folder)
    answers, scores = (
        _optional(folder / name) for name in ("questionnaires.csv", "questionnaire_scores.csv")
    )
    by_session = _did_the_same_again(trials)
    if by_session:
        for table in (trials, answers, scores):
            _name_sessions(table)
        meanings[FACTOR + SESSION] = ("", "session number of this participant, from 1")
    factors = _factors(trials, meanings)
    used, conditions = _used(trials, factors, by_session)
    people = _optional(folder / "participants.csv")
    if "ppid" not in people.columns:
        people = trials[["ppid"]].drop_duplicates().reset_index(drop=True)
    return StudyData(
        name=_only(trials, "experiment", path) or about.experiment or folder.resolve().name,
        mode=_only(trials, "mode", path) or about.mode or "unknown",
        factors=factors,
        trials=trials,
        used=used,
        conditions=conditions,
        people=people,
        answers=answers,
        scores=scores,
        codebook=meanings,
        primary=primary,
        by_session=by_session,
        digest=sha256(path.read_bytes()).hexdigest(),
        wordings=told,
        withdrawn=_withdrawn(folder),
        upgrades=upgrades_of(folder),
    )


def read_table(path: Path) -> DataFrame:
    """Reads a table with all cells as text, since a pseudonym like 12E345 is not a number.

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
            remedy="`sandbox study run` builds the tables again when it opens the study",
        ) from None
    except OSError as error:
        raise StudyError("the table cannot be read", where=str(path), got=error.strerror) from None


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
        )
    return numbers


def _optional(path: Path) -> DataFrame:
    import pandas as pd

    return read_table(path) if path.is_file() else pd.DataFrame()


def _only(trials: DataFrame, column: str, path: Path) -> str:
    """The only value of a column; empty if there is none."""
    values = [x for x in dict.fromkeys(trials.get(column, ())) if x]
    if len(values) > 1:
        raise StudyError(
            "data of different kinds must not be mixed",
            where=f"{path}: {column}",
            got=", ".join(values[:4]),
            expected="the same in every row",
        )
    return str(values[0]) if values else ""


class _StudyInfo(Struct):
    """The fields of `study.json` that a report shows."""

    experiment: str = ""
    mode: str = ""


def _about(folder: Path) -> _StudyInfo:
    """Name and kind of the study from `study.json`; empty if the file is missing or damaged."""
    path, what = folder / "study.json", "the study cannot be read"
    try:
        data = read_bytes(path, StudyError, what=what)
        return decoded(data, _StudyInfo, StudyError, what=what, where=str(path))
    except StudyError:
        return _StudyInfo()


def _withdrawn(folder: Path) -> int | None:
    """Number of people who withdrew; None if the study's journal is missing or damaged."""
    path = folder / STUDY_JOURNAL
    try:
        return withdrawals_of(read_journal(path)) if path.is_file() else None
    except StudyError:
        return None


def _codebook(folder: Path) -> tuple[dict[str, tuple[str, str]], tuple[str, ...]]:
    """Unit and meaning of columns of `trial_results.csv`, and the names of primary outcomes."""
    table = _optional(folder / "codebook.csv")
    if not {"table", "column", "unit", "meaning"} <= set(table.columns):
        return {}, ()
    rows = table[table["table"] == "trial_results.csv"]
    meanings = {row.column: (row.unit, row.meaning) for row in rows.itertuples(index=False)}
    if "role" not in table.columns:
        return meanings, ()
    named = table.loc[table["role"] == PRIMARY, "column"]
    # A score is named `score QUESTIONNAIRE/SCALE`.
    primary = (str(name).removeprefix("score ").partition("/")[0] for name in named)
    return meanings, tuple(primary)


def wordings(folder: Path) -> dict[str, str]:
    """What the codebook says of questionnaires whose wording is not the published one, by name."""
    table = _optional(folder / "codebook.csv")
    if not {"column", "meaning"} <= set(table.columns):
        return {}
    rows = table[table["column"].str.startswith(WORDING)]
    return {r.column.removeprefix(WORDING): r.meaning for r in rows.itertuples(index=False)}


def _did_the_same_again(trials: DataFrame) -> bool:
    """Returns True if a participant had the same levels in two sessions, so that sessions can be
    compared. Otherwise each session has its own levels, and the session is not a factor."""
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


def _factors(trials: DataFrame, meanings: dict[str, tuple[str, str]]) -> tuple[ObservedFactor, ...]:
    main = trials[(trials["counted"] == 1) & (trials["practice"] != 1)]
    factors = []
    for column in trials.columns:
        if not column.startswith(FACTOR):
            continue
        seen = [x for x in dict.fromkeys(main[column]) if x]
        listed = _listed(meanings.get(column, ("", ""))[1].partition(": ")[2], seen)
        # The codebook has the order of the design; levels that it lacks come last.
        levels = [x for x in listed if x in seen] + [x for x in seen if x not in listed]
        within = len(main) > 0 and bool((main.groupby("ppid")[column].nunique() > 1).any())
        factors.append(ObservedFactor(column.removeprefix(FACTOR), tuple(levels), within))
    return tuple(factors)


def _listed(text: str, names: Sequence[str]) -> list[str]:
    """The entries of a list; names may have its separator in them, and the longest one counts."""
    parts = text.split(BETWEEN_LISTED)
    entries: list[str] = []
    while parts:
        lengths = range(len(parts), 0, -1)
        count = next((n for n in lengths if BETWEEN_LISTED.join(parts[:n]) in names), 1)
        entries.append(BETWEEN_LISTED.join(parts[:count]))
        parts = parts[count:]
    return list(dict.fromkeys(entries))


def _rounds(main: DataFrame, within: Sequence[str], factor: ObservedFactor) -> Series:
    """Number of the round of every trial: with `repeat_inside`, levels come back in an order of
    their own; without it there is one round."""
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
    import numpy as np

    order = [name for name in ("session_num", "trial_num") if name in trials.columns]
    main = trials[(trials["counted"] == 1) & (trials["practice"] != 1)]
    main = main.sort_values(order, kind="stable").copy()
    # Excluded trials were practice as well, so they are counted in the position. What is learned
    # from one session to the next is the difference between sessions, where these are compared.
    once = ["ppid", "session_num"] if by_session else ["ppid"]
    main["position"] = main.groupby(once, sort=False).cumcount() + 1
    for i, factor in enumerate(factors):
        within = ["ppid", *(f.column for f in factors[:i])]
        main[factor.round] = _rounds(main, within, factor)
        places = main.groupby([*within, factor.round], sort=False)[factor.column]
        main[factor.place] = places.transform(_first_places)
        main[factor.count] = main.groupby(["ppid", factor.column], sort=False).cumcount() + 1
    used = main[(main["excluded"] != 1) & main["success"].isin([0, 1])].copy()
    used = used.sort_values("ppid", kind="stable").reset_index(drop=True)
    columns = [f.column for f in factors if len(f.levels) > 1]
    used["condition"] = "all"
    if columns and len(used):
        first, *rest = (used[column] for column in columns)
        used["condition"] = first.str.cat(rest, sep=BETWEEN_NAMES) if rest else first
    rank = {f.column: {x: i for i, x in enumerate(f.levels)} for f in factors}
    seen = used[["condition", *columns]].drop_duplicates()
    keys = [tuple(rank[c].get(row[c], -1) for c in columns) for _, row in seen.iterrows()]
    conditions = tuple(
        str(seen["condition"].iloc[i]) for i in sorted(range(len(keys)), key=keys.__getitem__)
    )
    number = {name: i for i, name in enumerate(conditions)}
    used["cell"] = np.array([number[x] for x in used["condition"]], dtype=int)
    used["censored"] = used["success"] != 1
    return used, conditions
