"""`trials.csv`: one row for every finished attempt at a trial.

Excluded trials are marked, and never deleted.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from models.arithmetic import total
from models.errors import InputError
from sandbox.recording.recording import stored
from sandbox.study.design.conditions import every_values
from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import session_plan, trials_of
from sandbox.study.measures.measures import all_measures, find_measure, measure_trial
from sandbox.study.measures.movement import throughput
from sandbox.study.record.journal import Record
from sandbox.study.record.state import Attempt, SessionState
from sandbox.study.record.trial_files import frames_of
from sandbox.study.tables.column import FACTOR, Column, Row, factor_columns
from sandbox.study.tables.frame_table import read_frames
from sandbox.trial.result import ResultRecord, fields, record_fields
from tasks.registry import find_task

SESSION = (
    Column("study", "", "name of the study"),
    Column(
        "mode", "", "kind of data: real, pilot or simulated; a study folder holds one kind only"
    ),
    Column("site", "", "letter of the place where the session took place"),
    Column(
        "participant", "", "pseudonym of the participant; the last character is a check character"
    ),
    Column("number", "", "number of the participant, from 1, which determines the order of levels"),
    Column("session", "", "session number of this participant, from 1"),
)
"""First columns of all tables whose rows belong to sessions."""
HAND = (
    Column("hand", "", "hand that the participant uses: left or right"),
    Column(
        "hand_size", "", "length of the hand relative to the hand that the encoders were trained on"
    ),
)
TRIAL = (
    Column("trial", "", "number of the trial in the session, from 1, practice included"),
    Column(
        "block",
        "",
        "number of the block; it grows by 1 whenever a level of a factor begins, so a number is "
        "left out where levels of two factors begin at once",
    ),
    Column(
        "trial_in_block",
        "",
        "number of the trial in its block, from 1; practice trials are counted separately",
    ),
    Column(
        "position", "", "number of the trial in the plan of the session, from 1; empty in practice"
    ),
    Column(
        "repetition",
        "",
        "number of the trial among trials with the same levels, from 1; 0 in practice trials",
    ),
    Column("practice", "0/1", "1: a practice trial; not part of the results"),
    Column(
        "attempt",
        "",
        "number of the attempt at this trial, from 1; attempts that were broken off have no row "
        "here, only records in session.jsonl",
    ),
    Column(
        "adopted",
        "0/1",
        "1: the record of the trial's end was lost, and its result comes from the recording; "
        "ended_s is then started_s plus the length of the recording; both are empty if the record "
        "of its start was lost, too",
    ),
    Column("counted", "0/1", "1: this attempt counts; use only these rows"),
    Column("excluded", "0/1", "1: excluded by a rule or by the experimenter; no data are deleted"),
    Column("exclusion_reason", "", "`rule NAME`, the experimenter's words, or `participant: ...`"),
)
TIMES = (
    Column(
        "started_s",
        "s",
        "time from the start of the session to the start of the trial (monotonic clock)",
    ),
    Column(
        "ended_s",
        "s",
        "time from the start of the session to the end of the trial (monotonic clock)",
    ),
)
SURFACE = (
    Column("device", "", "device of the first hand"),
    Column("surface_in", "", "width and height of the touch rectangle, inches"),
    Column("screen_measured", "0/1", "0: the size of the screen is a guess"),
)
FILES = (
    Column("recording", "", "file of the recording, if it exists; `sandbox replay` plays it"),
    Column("frames", "", "file of the frames; docs/measures.md describes how to read them"),
)
PERSON = "participant: "
"""Prefix of the reason if all trials of a participant are excluded."""
MOVED = "moved"
"""Key, in a row, of the amplitude and error of a movement, from which throughput is computed. It
is not a column."""
FILE_NAMES = tuple(column.name for column in FILES)
PLACE, ORDER = "place_", "order_"
"""Prefixes of the names of columns with the place of a level, and with the order of the levels."""
THEN = " > "
"""Separator of the levels in an order."""
LIMIT = Column(
    "limit_s",
    "s",
    "time at which the trial ends at the latest: the limit of the design, or of the task if that "
    "is shorter; empty if the task cannot be loaded any more",
)
RESULT = tuple(
    Column(name, fields()[name].unit, fields()[name].meaning)
    for name in record_fields(ResultRecord.TABLE)
)
"""Fields of the trial's result."""


def trial_columns(design: Design, rows: Sequence[Row] = ()) -> list[Column]:
    """Columns of `trials.csv`. They depend on the design, and on the factors in the rows."""
    of_result = record_fields(ResultRecord.TABLE)
    measured = [m for m in all_measures(design.own_measure) if m.name not in of_result]
    return [
        *SESSION,
        *HAND,
        *TRIAL,
        *factor_columns(design, rows),
        *place_columns(design),
        *TIMES,
        LIMIT,
        *(Column(c.name, c.unit, meaning_of(c)) for c in RESULT),
        *(Column(m.name, m.unit, m.meaning) for m in measured),
        *SURFACE,
        *FILES,
    ]


def place_columns(design: Design) -> list[Column]:
    """Columns, for each factor, of the place of a trial's level and of the order of the levels."""
    columns = []
    for factor in design.factors:
        if len(factor.levels) > 1:
            met = f"in the order in which this participant gets the levels of {factor.name}"
            within = "within the same outer levels; empty in practice"
            columns += [
                Column(PLACE + factor.name, "", f"place of the level {met}, {within}"),
                Column(ORDER + factor.name, "", f"all levels {met}, {within}"),
            ]
    return columns


def meaning_of(column: Column) -> str:
    """Meaning of a field of the result, or of the measure with this name if there is one."""
    measure = find_measure(column.name)
    return column.meaning if measure is None else measure.meaning


def trial_rows(
    design: Design,
    state: SessionState,
    session: Path | None = None,
    empty: Counter[str] | None = None,
    run_by: Design | None = None,
) -> list[Row]:
    """One row for every finished attempt in a session; at most one attempt at a trial counts.

    Args:
        design: Design of the study.
        state: State of the session.
        session: Folder of the session with the frames of trials; None leaves the cells of measures
            by frames empty.
        empty: Counter, by reason, of the trials in which a measure failed or frames are missing.
        run_by: Design by which the session was run; None leaves out the cells that depend on it.
    """
    if not state.start:
        return []
    limits = time_limits(run_by) if run_by else {}
    empty = Counter() if empty is None else empty
    planned = planned_cells(run_by, state) if run_by else {}
    rows = [
        _trial_row(design, state, attempt, attempt is state.counted(trial), session, limits, empty)
        | planned.get(trial, {})
        for trial, attempts in sorted(state.attempts.items())
        for attempt in attempts
        if attempt.end is not None
    ]
    exclude_person(design, [state], rows)
    _add_throughput(rows)
    return rows


def planned_cells(design: Design, state: SessionState) -> dict[int, Row]:
    """Cells of a session's trials that follow from its plan, by number of the trial.

    The place of a level is its place in the order in which the participant gets the levels of its
    factor, within the same outer levels. With `repeat_inside`, each round has its own order.
    """
    plan = trials_of(session_plan(design, state.start["number"], state.start["session"]))
    met: dict[tuple[Any, ...], list[str]] = {}
    cells: dict[int, Row] = {}
    orders: list[tuple[Row, str, list[str]]] = []
    position = 0
    for trial in plan:
        position += not trial.practice
        row: Row = {"position": None if trial.practice else position}
        for i, factor in enumerate(design.factors):
            outer = tuple(trial.levels.get(f.name) for f in design.factors[:i])
            again = trial.repetition if _comes_back(design, i) and not trial.practice else 0
            level = trial.levels.get(factor.name)
            if level is None or trial.practice:
                continue
            order = met.setdefault((factor.name, outer, again), [])
            if level not in order:
                order.append(level)
            row[PLACE + factor.name] = order.index(level) + 1
            orders.append((row, ORDER + factor.name, order))
        cells[trial.number] = row
    for row, name, order in orders:
        row[name] = THEN.join(order)
    return cells


def _comes_back(design: Design, factor: int) -> bool:
    """True if a factor, given by its index, has its own order in every round."""
    names = [f.name for f in design.factors]
    return bool(design.repeat_inside) and factor > names.index(design.repeat_inside)


def time_limits(design: Design) -> dict[str, float]:
    """Time limit, s, of each task of a design, by the task's name in the design.

    Tasks that cannot be loaded are left out.
    """
    limits = {}
    for values in every_values(design):
        name = str(values.get("task", ""))
        if name not in limits:
            with suppress(InputError):
                limits[name] = min(design.time_limit, float(find_task(name).time_limit))
    return limits


def session_cells(state: SessionState) -> Row:
    """Cells that are equal in all rows of a session, in every table."""
    start = state.start
    return {
        "study": start["experiment"],
        "mode": start["mode"],
        "site": start.get("site"),
        "participant": start["ppid"],
        "number": start["number"],
        "session": start["session"],
    }


def level_cells(levels: Mapping[str, str]) -> Row:
    """Cells of the columns of factors."""
    return {FACTOR + name: level for name, level in levels.items()}


def _trial_row(
    design: Design,
    state: SessionState,
    attempt: Attempt,
    counted: bool,
    folder: Path | None,
    limits: Mapping[str, float],
    empty: Counter[str],
) -> Row:
    start, end, result = attempt.start, attempt.end or {}, attempt.result
    session = state.start
    trial = start["trial"]
    row: Row = {
        **session_cells(state),
        "trial": trial,
        "block": start["block"],
        "trial_in_block": start["in_block"],
        # The time of an attempt whose records were lost is unknown.
        "started_s": None if "taken_in" in start else state.seconds[start["n"]],
        "ended_s": None if "taken_in" in start else _end_time(state, start, end),
        "hand": session["hand"],
        "hand_size": session["hand_size"],
        "attempt": start["attempt"],
        "adopted": "adopted" in end or "taken_in" in end,
        "counted": counted,
        "practice": start["practice"],
        "repetition": start["repetition"],
        **level_cells(start["levels"]),
        LIMIT.name: limits.get(str(start.get("values", {}).get("task", ""))),
        **result.values_for(ResultRecord.TABLE),
        **{column.name: (result.measures or {}).get(column.name) for column in SURFACE},
        "recording": start["file"],
        "frames": frames_of(Path(start["file"])).as_posix(),
    }
    frames = None
    if folder is not None:
        file = stored(folder / start["file"])
        row["recording"] = file.relative_to(folder).as_posix() if file.exists() else None
        frames = read_frames(folder / start["file"])
        if frames is None:
            row["frames"] = None
            empty["measures by frames: the file of the frames is missing or damaged"] += 1
    measured = measure_trial(frames, result, all_measures(design.own_measure))
    empty.update(f"measure {name}: {why}" for name, why in measured.failed.items())
    row |= measured.values
    row[MOVED] = measured.moved
    reason = state.excluded.get(trial, "") or excluded_by_rule(design, row)
    return {**row, "excluded": bool(reason), "exclusion_reason": reason}


def _end_time(state: SessionState, start: Record, end: Record) -> float:
    """Time at which an attempt ended, s.

    For an adopted attempt, this is the start plus the length of the recording, since the record of
    its end was written later.
    """
    recorded = state.seconds[end["n"]]
    if "lasted" not in end:
        return recorded
    return min(recorded, round(state.seconds[start["n"]] + float(end["lasted"]), 6))


def _add_throughput(rows: list[Row]) -> None:
    """Adds the throughput to all rows: one value for all rows with the same task and levels."""
    cells: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        levels = tuple(v for name, v in row.items() if name.startswith(FACTOR))
        cells.setdefault((row["task"], *levels), []).append(row)
    for some in cells.values():
        used = [
            (*row[MOVED], row["time_s"])
            for row in some
            if row["success"]
            and row["counted"]
            and not (row["practice"] or row["excluded"])
            and row[MOVED] is not None
        ]
        amplitudes, errors, times = zip(*used, strict=True) if used else ((), (), ())
        for row in some:
            row["throughput_bit_s"] = throughput(amplitudes, errors, times)


def excluded_by_rule(design: Design, row: Row) -> str:
    """Reason why a rule on trials excludes this row; empty if no rule does."""
    for rule in design.exclusions:
        value = row.get(rule.measure)
        if rule.of == "trial" and value is not None and rule.holds(float(value)):
            return f"rule {rule.name}"
    return ""


def exclude_person(design: Design, states: Sequence[SessionState], rows: Sequence[Row]) -> None:
    """Marks all trials of a participant as excluded, if the participant is excluded.

    The experimenter may have excluded the participant in any session, or a rule on participants may
    apply. Rules apply only when all sessions are complete. A second call changes nothing.

    Args:
        design: Design of the study.
        states: States of the participant's sessions.
        rows: Rows of `trials.csv` of these sessions.
    """
    reason = next((s.excluded_participant for s in states if s.excluded_participant), "")
    if not reason and len(states) >= design.sessions and all(s.complete for s in states):
        reason = _by_rule(design, rows)
    if reason:
        for row in rows:
            row |= {"excluded": True, "exclusion_reason": PERSON + reason}


def excluded_person(design: Design, states: Sequence[SessionState], rows: Sequence[Row]) -> str:
    """Reason why a participant is excluded; empty without an exclusion.

    `exclude_person` must be called before. An experimenter may write a reason for a single trial
    that begins with `participant: `, too. So a rule of the design counts only if it marks all
    trials.
    """
    for state in states:
        if state.excluded_participant:
            return state.excluded_participant
    marks = {row["exclusion_reason"] for row in rows}
    rules = (f"rule {rule.name}" for rule in design.exclusions if rule.of == "participant")
    return next((reason for reason in rules if marks == {PERSON + reason}), "")


def _by_rule(design: Design, rows: Sequence[Row]) -> str:
    """Reason with the first rule on participants that applies to the mean over these trials."""
    counted = [r for r in rows if r["counted"] and not r["practice"] and not r["excluded"]]
    for rule in design.exclusions:
        values = [float(r[rule.measure]) for r in counted if r.get(rule.measure) is not None]
        if rule.of == "participant" and values and rule.holds(total(values) / len(values)):
            return f"rule {rule.name}"
    return ""
