"""Tables derived from journals: rebuilt whole and atomically, never the only place of anything."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from sandbox.recording.recording_file import stored
from sandbox.study.design.design import Design
from sandbox.study.design.plan import Step
from sandbox.study.measures.measures import MEASURES
from sandbox.study.measures.throughput import throughput
from sandbox.study.record.files import write_atomically
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.journal import Record
from sandbox.study.record.kept_sessions import all_sessions, planned_trials
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import Attempt, SessionState
from sandbox.study.tables.codebook import codebook
from sandbox.study.tables.exclusions import PERSON, exclude_person, excluded_by_rule
from sandbox.study.tables.frames import STEMS, read_measures
from sandbox.study.tables.scoring_table import score_columns, score_rows
from sandbox.trial.result import KeptIn, kept_fields

UXF = ("experiment", "ppid", "session_num", "trial_num", "block_num", "trial_num_in_block",
       "start_time", "end_time")  # fmt: skip
"""The first columns, as users of UXF know them."""
OURS = ("mode", "participant_number", "hand", "hand_size", "attempt", "counted", "practice",
        "repetition", "excluded", "exclusion_reason")  # fmt: skip
RESULTS = kept_fields(KeptIn.TABLE)
MEASURED = tuple(m.name for m in MEASURES if m.name not in RESULTS)
FILES = ("trial_recording_location_0", "hand_pose_location_0", "touches_location_0")

Row = dict[str, Any]

QUESTIONNAIRE = ("experiment", "ppid", "session_num", "mode", "instrument", "block_num", "item",
                 "answer", "language", "time")  # fmt: skip
PEOPLE = ("ppid", "number", "hand", "hand_size", "language", "mode", "simulated", "consent",
          "sessions_done", "trials_done", "trials_planned", "complete", "excluded",
          "exclusion_reason")  # fmt: skip


def trial_columns(design: Design) -> list[str]:
    """Columns of `trial_results.csv`, the same in every session of a study."""
    factors = [f"factor_{f.name}" for f in design.factors]
    return [*UXF, *OURS, *factors, *RESULTS, *MEASURED, *FILES]


def trial_rows(design: Design, state: SessionState, session: Path | None = None) -> list[Row]:
    """One row for every finished attempt; exactly one of each trial counts.

    Args:
        design: Of the study.
        state: What the session's journal says.
        session: Its folder, for the measures that are made of 60 Hz tables.
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
    _tell_throughput(rows)
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
        **dict.fromkeys(RESULTS),
        **result.kept_in(KeptIn.TABLE),
        **(result.measures or {}),
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


def _tell_throughput(rows: list[Row]) -> None:
    """Puts the effective throughput of each combination of levels into all of its rows."""
    cells: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        levels = tuple(v for name, v in row.items() if name.startswith("factor_"))
        cells.setdefault((row["task"], *levels), []).append(row)
    for some in cells.values():
        moves = [
            r for r in some
            if r["counted"] and not r["practice"] and not r["excluded"] and r["success"]
            and r.get("move_error_m") is not None
        ]  # fmt: skip
        found = throughput([r["move_amplitude_m"] for r in moves],
                           [r["move_error_m"] for r in moves],
                           [r["time_s"] for r in moves])  # fmt: skip
        for row in some:
            row["throughput_bit_s"] = found


def answer_rows(state: SessionState) -> list[Row]:
    """One row for every answer."""
    return [
        {
            "experiment": state.start["experiment"],
            "ppid": state.start["ppid"],
            "session_num": state.start["session"],
            "mode": state.start["mode"],
            "instrument": record["form"],
            "block_num": record["block"],
            **{f"factor_{k}": v for k, v in record["levels"].items()},
            "item": item,
            "answer": answer,
            "language": state.start["language"],
            "time": record["time"],
        }
        for record in state.answers.values()
        for item, answer in record["answers"].items()
    ]


def answer_columns(design: Design) -> list[str]:
    """Columns of `questionnaires.csv`."""
    factors = [f"factor_{f.name}" for f in design.factors]
    return [*QUESTIONNAIRE[:6], *factors, *QUESTIONNAIRE[6:]]


def person_row(
    design: Design, states: Sequence[SessionState], planned: int, rows: Sequence[Row],
    sessions: int = 1,
) -> Row:  # fmt: skip
    """A participant's row in `participants.csv`, or in the one of a single session.

    Args:
        design: Of the study.
        states: Of the sessions that were begun, at least one.
        planned: Trials of all sessions.
        rows: Of `trial_results.csv`, of these sessions.
        sessions: How many sessions there are to be.
    """
    start = states[0].start
    reasons = [r["exclusion_reason"] for r in rows if r["exclusion_reason"].startswith(PERSON)]
    # Where nothing was finished there are no rows.
    reasons += [s.excluded_participant for s in states if s.excluded_participant]
    reason = reasons[0].removeprefix(PERSON) if reasons else ""
    asked = [r for s in states for r in s.answers.values() if r["form"] == "demographics"]
    ended = sum(state.complete for state in states)
    return {
        **{
            name: start[name]
            for name in ("ppid", "number", "hand", "hand_size", "language", "mode")
        },
        "simulated": start["user"] is not None,
        "consent": next((s.consent for s in states if s.consent is not None), None),
        "sessions_done": ended,
        "trials_done": sum(s.counted(t) is not None for s in states for t in s.attempts),
        "trials_planned": planned,
        "complete": ended == sessions,
        "excluded": bool(reason),
        "exclusion_reason": reason,
        **(asked[-1]["answers"] if asked else {}),
    }


def rebuild_session(session: SessionFolder, durable: bool = True) -> None:
    """Writes a session's tables anew.

    Raises:
        StudyError: One cannot be written; the older one is still there.
    """
    write_session(session.study, session.path, session.state, session.steps,
                  session.journal.records, durable)  # fmt: skip


def write_session(
    study: StudyFolder, path: Path, state: SessionState, steps: Sequence[Step],
    records: Sequence[Record], durable: bool = True,
) -> None:  # fmt: skip
    """Writes the tables of a session that need not be open.

    Args:
        study: It belongs to.
        path: Of the session.
        state: What its journal says.
        steps: Its plan.
        records: Its journal.
        durable: They are on the disk when this returns.

    Raises:
        StudyError: One cannot be written; the older one is still there.
    """
    design = study.design
    rows = trial_rows(design, state, path)
    files = {
        "trial_results.csv": csv_bytes(rows, trial_columns(design)),
        "questionnaires.csv": csv_bytes(answer_rows(state), answer_columns(design)),
        "questionnaire_scores.csv": csv_bytes(score_rows(design, state), score_columns(design)),
        "codebook.csv": codebook(design, trial_columns(design), answer_columns(design)),
        "session_info/settings.json": json.dumps(
            {"settings": design.settings, "build": study.build, "design": design.digest},
            indent=1, sort_keys=True,
        ).encode() + b"\n",
        "session_info/participant_details.csv": csv_bytes(
            [person_row(design, [state], state.done(steps)[1], rows)], person_columns(design)
        ),
        "session_info/log.csv": log_bytes(records),
    }  # fmt: skip
    for name, data in files.items():
        write_atomically(path / name, data, durable)


def rebuild_study(study: StudyFolder) -> dict[str, int]:
    """Writes the tables of all participants anew, reading everybody's journal.

    Returns:
        How many participants, trials that count, and trials left out there are.

    Raises:
        StudyError: A journal is damaged, or a table cannot be written.
    """
    design = study.design
    trials: list[Row] = []
    answers: list[Row] = []
    scored: list[Row] = []
    people: list[Row] = []
    with study.lock():
        for person, sessions in all_sessions(study):
            mine: list[Row] = []
            for session in sessions:
                for row in trial_rows(design, session.state, session.path):
                    inside = session.path.relative_to(study.path).as_posix()
                    mine.append(row | {name: f"{inside}/{row[name]}" for name in FILES})
                answers += answer_rows(session.state)
                scored += score_rows(design, session.state)
            states = [session.state for session in sessions]
            exclude_person(design, states, mine)
            trials += mine
            people.append(person_row(design, states, planned_trials(study, person), mine,
                                     design.sessions))  # fmt: skip
        for name, data in {
            "participants.csv": csv_bytes(people, person_columns(design)),
            "trial_results.csv": csv_bytes(trials, trial_columns(design)),
            "questionnaires.csv": csv_bytes(answers, answer_columns(design)),
            "questionnaire_scores.csv": csv_bytes(scored, score_columns(design)),
            "codebook.csv": codebook(design, trial_columns(design), answer_columns(design)),
        }.items():
            write_atomically(study.path / name, data)
    counted = [row for row in trials if row["counted"] and not row["practice"]]
    return {"participants": len(people), "trials": len(counted),
            "excluded": sum(row["excluded"] for row in counted)}  # fmt: skip


def person_columns(design: Design) -> list[str]:
    """Columns of `participants.csv`."""
    return [*PEOPLE, *(item.name for item in design.demographics)]


def log_bytes(records: Iterable[Record]) -> bytes:
    """UXF's log: time, kind, and the record itself."""
    rows = [
        {"timestamp": r["time"], "log_type": r["kind"],
         "message": json.dumps({k: v for k, v in r.items() if k not in ("time", "kind")},
                               ensure_ascii=False)}
        for r in records
    ]  # fmt: skip
    return csv_bytes(rows, ["timestamp", "log_type", "message"])


def csv_bytes(rows: Iterable[Row], columns: Sequence[str]) -> bytes:
    """A table as every program reads it: UTF-8, commas, points, 1 and 0, empty for nothing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_cell(row.get(name)) for name in columns])
    return text.getvalue().encode()


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return repr(round(value, 6))
    if isinstance(value, str):
        # A lone carriage return is put in quotation marks by nobody, and ends a row for many.
        return value.replace("\r\n", "\n").replace("\r", "\n")
    return value


def _seconds(start: str, then: str) -> float:
    return (datetime.fromisoformat(then) - datetime.fromisoformat(start)).total_seconds()
