"""Rows of the tables of participants, answers, scores and events."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence

from sandbox.study.design.design import Design
from sandbox.study.design.fields import LISTED
from sandbox.study.design.questionnaires import score
from sandbox.study.design.session_plan import FormStep, session_plan
from sandbox.study.record import records as kinds
from sandbox.study.record.journal import Record
from sandbox.study.record.notes import DECISIONS, INCLUDE, RELEASE, REMARK
from sandbox.study.record.state import SessionState, is_broken
from sandbox.study.record.stored_sessions import StoredSession
from sandbox.study.tables.column import (
    CLOCK_STEPS,
    FACTOR,
    Column,
    Row,
    factor_columns,
    names_of,
)
from sandbox.study.tables.trial_table import (
    HAND,
    SESSION,
    SURFACE,
    TRIAL,
    excluded_person,
    level_cells,
    session_cells,
)

_COMMON = {column.name: column for column in (*SESSION, *HAND, *TRIAL, *SURFACE)}

PARTICIPANT = (
    *(_COMMON[name] for name in ("study", "mode", "site", "participant", "number")),
    Column("group", "", "level of each factor that varies between participants"),
    Column("date", "", "day on which the first session began, UTC"),
    *HAND,
    Column("language", "", "language in which the participant takes part"),
    *SURFACE,
    Column("software", "", "version of the program at the start of the first session"),
    Column("simulated", "0/1", "1: a simulated user, not a person"),
    Column("consent", "0/1", "1: the participant consented; empty: consent was not asked for"),
    Column("sessions_done", "", "sessions that reached their planned end"),
    Column("trials_done", "", "trials with a counted attempt, practice included"),
    Column("trials_planned", "", "planned trials of all sessions, practice included"),
    Column("complete", "0/1", "1: all sessions reached their planned end"),
    Column(
        "excluded", "0/1", "1: a rule or the experimenter excluded all trials of the participant"
    ),
    Column("exclusion_reason", "", "`rule NAME`, or the experimenter's words"),
    Column(
        CLOCK_STEPS,
        "s",
        "steps of the wall clock during the sessions, separated by spaces; empty if there was "
        "none; times of trials come from another clock",
    ),
)


def participant_columns(design: Design, rows: Sequence[Row] = ()) -> list[Column]:
    """Columns of `participants.csv`, and then of questions that only an earlier design had.

    If a question of an earlier design has the name of a column in `PARTICIPANT`, it gets no column
    in this table. Its answers are in `answers.csv`.
    """
    language, filled = design.languages[0], names_of(PARTICIPANT)
    columns = [
        *PARTICIPANT,
        *(Column(x.name, "", x.ask[language]) for x in design.demographics if x.name not in filled),
    ]
    now = names_of(columns)
    earlier = dict.fromkeys(name for row in rows for name in row if name not in now)
    meaning = "answer to a question of an earlier design, empty since then"
    return [*columns, *(Column(name, "", meaning) for name in earlier)]


def participant_row(
    design: Design,
    states: Sequence[SessionState],
    planned: int,
    rows: Sequence[Row],
    sessions: int = 1,
) -> Row:
    """Row of a participant in `participants.csv`, or in the table of a single session.

    Args:
        design: Design of the study.
        states: States of the sessions that have begun, at least one.
        planned: Planned number of trials, practice included.
        rows: Rows of `trials.csv` of these sessions.
        sessions: Planned number of sessions.
    """
    start = states[0].start
    reason = excluded_person(design, states, rows)
    asked = [s.about_person for s in states if s.about_person is not None]
    ended = sum(state.complete for state in states)  # any order: whole numbers
    between = [factor.name for factor in design.factors if factor.order == "between"]
    return {
        # The answers come first, so that a question cannot replace the program's own values.
        **(asked[-1] if asked else {}),
        **{k: cell for k, cell in session_cells(states[0]).items() if k != "session"},
        **{name: start[name] for name in ("hand", "hand_size", "language")},
        "group": LISTED.join(_only(rows, FACTOR + name) for name in between),
        "date": str(start["time"])[:10],
        **{column.name: _only(rows, column.name) for column in SURFACE},
        "software": start.get("versions", {}).get("hand-sandbox"),
        "simulated": start["user"] is not None,
        "consent": next((s.consent for s in states if s.consent is not None), None),
        "sessions_done": ended,
        "trials_done": sum(s.counted(t) is not None for s in states for t in s.attempts),
        "trials_planned": planned,
        "complete": ended >= sessions,
        "excluded": bool(reason),
        "exclusion_reason": reason,
        CLOCK_STEPS: " ".join(f"{step:+g}" for s in states for step in s.clock_steps),
    }


def _only(rows: Sequence[Row], name: str) -> str:
    """The different values of a column, as text."""
    values = dict.fromkeys(row.get(name) for row in rows)
    return LISTED.join(str(int(x) if isinstance(x, bool) else x) for x in values if x is not None)


ABOUT = (*SESSION, Column("instrument", "", "name of the questionnaire"), _COMMON["block"])
"""First columns of `answers.csv` and `scores.csv`."""
PLACE = Column(
    "place",
    "",
    "1, 2, ...: how often the participant had answered this questionnaire, this time included",
)
ANSWER = (
    Column("item", "", "name of the question"),
    Column("answer", "", "the participant's answer, unchanged"),
    Column(
        "seconds",
        "s",
        "time from the previous answer in this form, or from the opening of the form, to this "
        "answer; for an answer that was changed, the times to its changes are added; empty if it "
        "is unknown",
    ),
    Column(
        "form_complete",
        "0/1",
        "0: the participant left the form before its end; this answer was given before that",
    ),
)
SCORE = (
    Column("scale", "", "scale of the questionnaire; docs/studies.md has its formula"),
    Column("score", "", "score; empty if an answer is missing (no answer is imputed)"),
    Column("items_missing", "", "number of missing answers among those that the score needs"),
    Column("score_low", "", "lowest possible score"),
    Column("score_high", "", "highest possible score"),
)
WHEN = (
    Column("language", "", "language of the questions"),
    Column("time", "", "time at which the questionnaire was completed, UTC; empty if it was not"),
)
"""Last columns of `answers.csv` and `scores.csv`."""


def answer_columns(design: Design, rows: Sequence[Row] = ()) -> list[Column]:
    """Columns of `answers.csv`."""
    return [*ABOUT, *factor_columns(design, rows), *ANSWER, *WHEN]


def score_columns(design: Design, rows: Sequence[Row] = ()) -> list[Column]:
    """Columns of `scores.csv`."""
    return [*ABOUT, PLACE, *factor_columns(design, rows), *SCORE, *WHEN]


def answer_rows(session: StoredSession, designs: Callable[[str], Design]) -> list[Row]:
    """Rows of `answers.csv` for a session. Answers in unfinished forms come last.

    Args:
        session: The session.
        designs: Function from a digest to the design, such as `StudyFolder.design_of`.
    """
    state = session.state
    if not state.start:
        return []
    seconds = _seconds(session)
    rows = [
        {
            **common,
            "item": item,
            "answer": answer,
            "seconds": seconds.get((record["step"], item)),
            "form_complete": True,
        }
        for record, common in _forms(state)
        for item, answer in record["answers"].items()
    ]
    start = state.start
    for step in session_plan(designs(state.design), start["number"], start["session"]):
        left = state.drafts.get(step.id, {})
        if not isinstance(step, FormStep) or step.id in state.answers:
            continue
        rows += [
            {
                **_form_cells(state, step.form.name, step.block, step.levels),
                "item": item,
                "answer": answer,
                "seconds": seconds.get((step.id, item)),
                "form_complete": False,
            }
            for item, answer in left.items()
            if answer is not None
        ]
    return rows


def _seconds(session: StoredSession) -> dict[tuple[str, str], float]:
    """Time (s) that each answer took, by step and item, for answers whose time is known."""
    of = session.state.seconds.of
    opened = {
        record["step"]: of[record["n"]] - record["seconds"]
        for record in session.records
        if record["kind"] == kinds.FORM and record["n"] in of and "seconds" in record
    }
    before: dict[str, float] = {}
    seconds: dict[tuple[str, str], float] = {}
    for record in session.records:
        if record["kind"] in kinds.RUNS:
            # The time in which the program did not run does not count.
            before = {}
        if record["kind"] != kinds.ANSWER or record["n"] not in of:
            continue
        key, at = (record["step"], record["item"]), of[record["n"]]
        starts = (before.get(record["step"]), opened.get(record["step"]))
        since = [start for start in starts if start is not None and start <= at]
        before[record["step"]] = at
        if since:
            seconds[key] = round(seconds.get(key, 0.0) + at - max(since), 3)
    return seconds


def score_rows(states: Sequence[SessionState], designs: Callable[[str], Design]) -> list[Row]:
    """Rows of `scores.csv` for a participant; forms without scales have no rows.

    Answers are scored by the design by which they were asked, since a later design may have other
    scales.

    Args:
        states: States of all sessions of the participant. The column `place` counts over them.
        designs: Function from a digest to the design, such as `StudyFolder.design_of`.
    """
    places: Counter[str] = Counter()
    rows: list[Row] = []
    answered = [(state, form) for state in states for form in _forms(state)]
    for state, (record, common) in answered:
        forms = designs(state.asked_by[record["step"]]).questionnaires
        form = next((f for f in forms if f.name == record["form"]), None)
        if form is None:
            continue
        places[form.name] += 1
        for scale in form.scales:
            found, (low, high) = score(scale, record["answers"]), scale.range
            rows.append(
                {
                    **common,
                    "place": places[form.name],
                    "scale": scale.name,
                    "score": found.value,
                    "items_missing": found.missing,
                    "score_low": low,
                    "score_high": high,
                }
            )
    return rows


def _forms(state: SessionState) -> Iterator[tuple[Record, Row]]:
    """Yields the record of each completed form of a session, and the cells about the form that rows
    of answers and of scores share."""
    for record in state.answers.values():
        cells = _form_cells(state, record["form"], record["block"], record["levels"])
        yield record, {**cells, "time": record["time"]}


def _form_cells(state: SessionState, form: str, block: int, levels: Mapping[str, str]) -> Row:
    """Cells about a form, which rows of answers and of scores share."""
    return {
        **session_cells(state),
        **level_cells(levels),
        "instrument": form,
        "block": block,
        "language": state.start["language"],
    }


KINDS = {
    "session_resume": "the session was resumed after an interruption",
    "note": "a note of the experimenter",
    "pause": "the experimenter paused",
    "go_on": "the experimenter ended the pause",
    "repeat": "the experimenter repeats a trial",
    "skip": "the experimenter skipped a step",
    "begin_again": "after a long pause, a block was begun again with its practice",
    "exclude": "the experimenter excluded a trial, or the participant",
    "trial_broken": "an attempt was broken off",
    "clock_step": "the wall clock was set; text has the seconds",
    "page_gone": "the page of the participant, or of the second hand, was gone",
    "page_back": "that page was back",
    "recovered": "a half-written record was cut off",
    "lost": "the experimenter accepted a loss of records",
    "session_end": "the session ended",
    INCLUDE: "an exclusion was taken back after the session",
    RELEASE: "the number of the participant was freed for a new participant",
    REMARK: "a remark that was written after the session",
}
"""Events that have a row, with their meanings."""
EVENT = (
    *SESSION,
    Column("time_s", "s", "time from the start of the session (monotonic clock)"),
    Column("event", "", "; ".join(f"{kind}: {meaning}" for kind, meaning in KINDS.items())),
    Column("trial", "", "number of the trial that the event is about; empty if it is about none"),
    Column("text", "", "words of the experimenter, or the reason"),
)
_TEXTS = ("text", "reason", "why", "seconds")
"""Fields of records that give the text of a row; the first field with a value is used."""


def event_rows(session: StoredSession) -> list[Row]:
    """Rows of `events.csv` for a session."""
    state = session.state
    records = [(event_of(record), record) for record in session.records]
    # Notes about the person, but about no session, are in the rows of the first session.
    mine = (None, session.number) if session.number == 1 else (session.number,)
    notes = [n for n in session.notes if n["kind"] in DECISIONS and n.get("session") in mine]
    return [
        {
            **session_cells(state),
            "time_s": state.seconds.of.get(record.get("n", -1)),
            "event": event,
            "trial": record.get("trial"),
            "text": next((str(record[name]) for name in _TEXTS if record.get(name)), ""),
        }
        for event, record in (*records, *((note["kind"], note) for note in notes))
        if event in KINDS
    ]


def event_of(record: Record) -> str:
    """Name of the event that a record describes."""
    match record["kind"]:
        case "command":
            return str(record["command"])
        case "trial_end" if is_broken(record):
            return "trial_broken"
        case "screen":
            return f"page_{record['event']}"
        case "repaired" if record.get("lost_bytes") is not None:
            return "recovered"
        case "repaired" if record.get("records") is not None:
            return "lost"
        case kind:
            names: dict[str, str] = {"resume": "session_resume", "end": "session_end"}
            return names.get(kind, str(kind))
