"""`trial_results.csv`: one row for every finished attempt of a trial."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from sandbox.recording.recording import stored
from sandbox.study.design.design import Design
from sandbox.study.measures.compute import measure_result, measure_trials
from sandbox.study.measures.kept import DIFFERS
from sandbox.study.measures.registry import find_measure, measure_columns, measures
from sandbox.study.record.state import Attempt, SessionState
from sandbox.study.tables.column import (
    FACTOR,
    NO_EARLIER,
    Column,
    Earlier,
    Row,
    factor_columns,
)
from sandbox.study.tables.exclusions import exclude_person, excluded_by_rule
from sandbox.study.tables.measures_file import read_measures
from sandbox.trial.result import KeptIn, fields, kept_fields

UXF = (
    Column("experiment", "", "name of the study"),
    Column("ppid", "", "pseudonym of the participant; the last character is a check character"),
    Column("session_num", "", "session number of this participant, from 1"),
    Column("trial_num", "", "number of the trial in the session, from 1, practice included"),
    Column(
        "block_num",
        "",
        "number of the block, which grows where the level of a factor changes; where those of two "
        "factors change at once, a number is left out",
    ),
    Column(
        "trial_num_in_block",
        "",
        "number of the trial in its block, from 1; practice is counted by itself",
    ),
    Column(
        "start_time",
        "s",
        "time from the start of the session to the start of the trial (monotonic clock)",
    ),
    Column(
        "end_time",
        "s",
        "time from the start of the session to the end of the trial (monotonic clock)",
    ),
)
"""First columns, named as in UXF (Unity Experiment Framework)."""
SESSION = (
    Column(
        "mode", "", "kind of data: real, pilot or simulated; a study folder holds one kind only"
    ),
    Column(
        "participant_number",
        "",
        "order of arrival, which determines the order of levels; from 0, while `sandbox study "
        "plan` and `sheet` count from 1",
    ),
    Column("hand", "", "hand that the participant uses: left or right"),
    Column(
        "hand_size", "", "length of the hand relative to the hand that the encoders were trained on"
    ),
    Column(
        "attempt",
        "",
        "number of the attempt at this trial, from 1; attempts that were broken off are only in "
        "session_info/log.csv",
    ),
    Column("counted", "0/1", "1: this attempt counts; use only these rows"),
    Column("practice", "0/1", "1: a practice trial; not part of the results"),
    Column(
        "repetition",
        "",
        "number of the trial among trials with the same levels, from 1; 0 in practice trials",
    ),
    Column("excluded", "0/1", "1: excluded by a rule or by the experimenter; the data are kept"),
    Column("exclusion_reason", "", "`rule NAME`, the experimenter's words, or `participant: ...`"),
)
FILES = (
    Column(
        "trial_recording_location_0", "", "file of the recording; `sandbox replay FILE` plays it"
    ),
    Column(
        "hand_pose_location_0",
        "",
        "file of the 60 Hz table; also written as .parquet if pyarrow is installed",
    ),
    Column(
        "touches_location_0", "", "file of all touches: one row for each contact at each moment"
    ),
)
REPLAYS = (
    Column(
        DIFFERS,
        "",
        "empty, or what differed where the trial was last replayed and its states were not the "
        "recorded ones: its measures are those of before, and measures that were added are empty",
    ),
)
FILE_NAMES = tuple(column.name for column in FILES)
RESULT = tuple(
    Column(name, fields()[name].unit, fields()[name].meaning) for name in kept_fields(KeptIn.TABLE)
)
"""Fields of the trial's result."""


def trial_columns(design: Design, earlier: Earlier = NO_EARLIER) -> list[Column]:
    """Columns of `trial_results.csv`, the same in every session of a study whose factors stay."""
    measured = [m for m in measures() if m.name in measure_columns()]
    return [
        *UXF,
        *SESSION,
        *factor_columns(design, earlier),
        *(Column(c.name, c.unit, meaning_of(c)) for c in RESULT),
        *(Column(m.name, m.unit, m.meaning) for m in measured),
        *REPLAYS,
        *FILES,
    ]


def meaning_of(column: Column) -> str:
    """Meaning of a field of the result, with the source of the measure of that name, if any."""
    measure = find_measure(column.name)
    return column.meaning if measure is None else measure.meaning


def trial_rows(
    design: Design,
    state: SessionState,
    session: Path | None = None,
    say: Callable[[str], object] = lambda text: None,
) -> list[Row]:
    """One row for every finished attempt; exactly one attempt of each trial counts.

    Args:
        design: Design of the study.
        state: State of the session.
        session: Folder of the session, from which measures of 60 Hz tables are read; None leaves
            their cells empty.
        say: Called with a line for every failed measure over several trials.
    """
    if not state.start:
        return []
    rows = [
        _trial_row(design, state, attempt, attempt is state.counted(trial), session)
        for trial, attempts in sorted(state.attempts.items())
        for attempt in attempts
        if attempt.end is not None
    ]
    exclude_person(design, [state], rows)
    _measure_combinations(rows, say)
    return rows


def session_cells(state: SessionState) -> Row:
    """Cells that are equal in all rows of a session, in every table."""
    start = state.start
    return {
        "experiment": start["experiment"],
        "ppid": start["ppid"],
        "session_num": start["session"],
        "mode": start["mode"],
    }


def level_cells(levels: Mapping[str, str]) -> Row:
    """Cells of the columns of factors."""
    return {FACTOR + name: level for name, level in levels.items()}


def _trial_row(
    design: Design, state: SessionState, attempt: Attempt, counted: bool, folder: Path | None
) -> Row:
    start, end, result = attempt.start, attempt.end or {}, attempt.result
    session = state.start
    trial = start["trial"]
    row: Row = {
        **session_cells(state),
        "trial_num": trial,
        "block_num": start["block"],
        "trial_num_in_block": start["in_block"],
        # Of an attempt whose records were lost nobody knows when it was.
        "start_time": None if "taken_in" in start else state.seconds[start["n"]],
        "end_time": None if "taken_in" in start else state.seconds[end["n"]],
        "participant_number": session["number"],
        "hand": session["hand"],
        "hand_size": session["hand_size"],
        "attempt": start["attempt"],
        "counted": counted,
        "practice": start["practice"],
        "repetition": start["repetition"],
        **level_cells(start["levels"]),
        **result.kept_in(KeptIn.TABLE),
        **measure_result(result).values,
        "trial_recording_location_0": start["file"],
    }
    stem = Path(start["file"]).stem
    if folder is not None:
        row |= read_measures(folder / "trackers", stem)
        file = stored(folder / start["file"])
        row["trial_recording_location_0"] = file.relative_to(folder).as_posix()
    row["hand_pose_location_0"] = f"trackers/frames_{stem}.csv.gz"
    row["touches_location_0"] = f"trackers/touches_{stem}.csv.gz"
    reason = state.excluded.get(trial, "") or excluded_by_rule(design, row)
    return {**row, "excluded": bool(reason), "exclusion_reason": reason}


def _measure_combinations(rows: list[Row], say: Callable[[str], object]) -> None:
    """Adds the measures over several trials to all rows with the same task and levels."""
    cells: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        levels = tuple(v for name, v in row.items() if name.startswith(FACTOR))
        cells.setdefault((row["task"], *levels), []).append(row)
    for some in cells.values():
        used = [
            row
            for row in some
            if row["success"] and row["counted"] and not (row["practice"] or row["excluded"])
        ]
        measured = measure_trials(used)
        for notice in measured.notices:
            say(notice)
        for row in some:
            row |= measured.values
