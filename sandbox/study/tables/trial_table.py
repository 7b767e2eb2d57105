"""`trial_results.csv`: one row for every finished attempt of a trial."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

from sandbox.recording.recording_file import stored
from sandbox.study.design.design import Design
from sandbox.study.measures.compute import measure_result, measure_trials
from sandbox.study.measures.registry import find_measure, measure_columns, measures
from sandbox.study.record.state import Attempt, SessionState
from sandbox.study.tables.column import Column, Row, factor_columns
from sandbox.study.tables.exclusions import exclude_person, excluded_by_rule
from sandbox.study.tables.frames import STEMS, read_measures
from sandbox.trial.result import KeptIn, fields, kept_fields

UXF = (
    Column("experiment", "", "name of the study"),
    Column("ppid", "", "pseudonym of the participant; its last sign is a check digit"),
    Column("session_num", "", "session number of this participant, from 1"),
    Column("trial_num", "", "number of the trial in the session, from 1, practice included"),
    Column("block_num", "", "number of the block, from 1; a factor's new level begins a block"),
    Column("trial_num_in_block", "", "number of the trial in its block, from 1"),
    Column("start_time", "s", "start, by the wall clock, since the session began"),
    Column("end_time", "s", "end, by the wall clock, since the session began"),
)
"""The first columns, with the names that users of UXF know."""
SESSION = (
    Column("mode", "", "real, pilot or simulated; a folder holds only one of them"),
    Column("participant_number", "", "order of arrival, from 0; it decides the order of levels"),
    Column("hand", "", "hand that touches: left or right"),
    Column("hand_size", "", "length of the hand over that of the hand that encoders learned from"),
    Column(
        "attempt",
        "",
        "number of the attempt of this trial, from 1; session_info/log.csv lists "
        "attempts that were broken off",
    ),
    Column("counted", "0/1", "1: the attempt of the trial that counts; use only these rows"),
    Column("practice", "0/1", "1: a practice trial, which is no part of the results"),
    Column(
        "repetition",
        "",
        "number of the trial among those with the same levels, from 1; 0 in practice",
    ),
    Column("excluded", "0/1", "1: left out by a rule or by the experimenter; never deleted"),
    Column("exclusion_reason", "", "`rule NAME`, the experimenter's words, or `participant: ...`"),
)
FILES = (
    Column("trial_recording_location_0", "", "file of the recording; `sandbox replay FILE`"),
    Column("hand_pose_location_0", "", "file of the 60 Hz table; the extra `study` adds .parquet"),
    Column("touches_location_0", "", "file of all touches, one row for each contact and moment"),
)
FILE_NAMES = tuple(column.name for column in FILES)
RESULT = tuple(
    Column(name, fields()[name].unit, fields()[name].meaning) for name in kept_fields(KeptIn.TABLE)
)
"""Fields of the trial's result."""


def trial_columns(design: Design) -> list[Column]:
    """Columns of `trial_results.csv`, the same in every session of a study."""
    measured = [m for m in measures() if m.name in measure_columns()]
    return [
        *UXF,
        *SESSION,
        *factor_columns(design),
        *(Column(c.name, c.unit, meaning_of(c)) for c in RESULT),
        *(Column(m.name, m.unit, m.meaning) for m in measured),
        *FILES,
    ]


def meaning_of(column: Column) -> str:
    """The meaning of a field of the result; a measure of its name may add a source."""
    measure = find_measure(column.name)
    return column.meaning if measure is None else measure.meaning


def trial_rows(
    design: Design,
    state: SessionState,
    session: Path | None = None,
    say: Callable[[str], object] = lambda text: None,
) -> list[Row]:
    """One row for every finished attempt; exactly one of each trial counts.

    Args:
        design: Design of the study.
        state: State of the session.
        session: Folder of the session, for the measures that come from 60 Hz tables.
        say: Called with a line for every measure of several trials that fails.
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


def _trial_row(
    design: Design, state: SessionState, attempt: Attempt, counted: bool, folder: Path | None
) -> Row:
    start, end, result = attempt.start, attempt.end or {}, attempt.result
    session = state.start
    trial = start["trial"]
    row: Row = {
        "experiment": session["experiment"],
        "ppid": session["ppid"],
        "session_num": session["session"],
        "trial_num": trial,
        "block_num": start["block"],
        "trial_num_in_block": start["in_block"],
        "start_time": _seconds(session["time"], start["time"]),
        "end_time": _seconds(session["time"], end["time"]),
        "mode": session["mode"],
        "participant_number": session["number"],
        "hand": session["hand"],
        "hand_size": session["hand_size"],
        "attempt": start["attempt"],
        "counted": counted,
        "practice": start["practice"],
        "repetition": start["repetition"],
        **{f"factor_{k}": v for k, v in start["levels"].items()},
        **result.kept_in(KeptIn.TABLE),
        **measure_result(result).values,
        "trial_recording_location_0": start["file"],
    }
    stem = Path(start["file"]).stem
    if folder is not None:
        row |= read_measures(folder / "trackers", stem)
        file = stored(folder / start["file"])
        row["trial_recording_location_0"] = file.relative_to(folder).as_posix()
    for column, kind in (("hand_pose_location_0", "frames"), ("touches_location_0", "touches")):
        row[column] = f"trackers/{STEMS[kind]}_{stem}.csv.gz"
    reason = state.excluded.get(trial, "") or excluded_by_rule(design, row)
    return {**row, "excluded": bool(reason), "exclusion_reason": reason}


def _measure_combinations(rows: list[Row], say: Callable[[str], object]) -> None:
    """Puts the measures of several trials into all rows with the same task and levels."""
    cells: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        levels = tuple(v for name, v in row.items() if name.startswith("factor_"))
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


def _seconds(start: str, then: str) -> float:
    return (datetime.fromisoformat(then) - datetime.fromisoformat(start)).total_seconds()
