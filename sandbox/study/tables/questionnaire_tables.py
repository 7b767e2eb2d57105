"""`questionnaires.csv`, one row for every answer, and `questionnaire_scores.csv`, one row for every
scale of every answered questionnaire."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

from sandbox.study.design.design import Design
from sandbox.study.design.scoring import scores
from sandbox.study.record.chain import Record
from sandbox.study.record.state import SessionState
from sandbox.study.tables.column import NO_EARLIER, Column, Earlier, Row, factor_columns
from sandbox.study.tables.trial_table import SESSION, UXF, level_cells, session_cells

_COMMON = {column.name: column for column in (*UXF, *SESSION)}
ABOUT = (
    *(_COMMON[name] for name in ("experiment", "ppid", "session_num", "mode")),
    Column("instrument", "", "name of the questionnaire"),
    _COMMON["block_num"],
)
"""First columns of both tables."""
PLACE = Column(
    "place",
    "",
    "1, 2, ...: how often the participant had answered this questionnaire, this time included; in "
    "the tables of one session, how often in this session",
)
ANSWER = (
    Column("item", "", "name of the question"),
    Column("answer", "", "the participant's answer, unchanged"),
)
SCORE = (
    Column("scale", "", "scale of the questionnaire; docs/questionnaires.md has its formula"),
    Column("score", "", "score; empty if an answer is missing (no answer is imputed)"),
    Column("items_missing", "", "number of answers that the score needs and that are missing"),
    Column("score_low", "", "lowest possible score"),
    Column("score_high", "", "highest possible score"),
)
WHEN = (
    Column("language", "", "language of the questions"),
    Column("time", "", "time at which the questionnaire was completed, UTC"),
)
"""Last columns of both tables."""


def answer_columns(design: Design, earlier: Earlier = NO_EARLIER) -> list[Column]:
    """Columns of `questionnaires.csv`."""
    return [*ABOUT, *factor_columns(design, earlier), *ANSWER, *WHEN]


def score_columns(design: Design, earlier: Earlier = NO_EARLIER) -> list[Column]:
    """Columns of `questionnaire_scores.csv`."""
    return [*ABOUT, PLACE, *factor_columns(design, earlier), *SCORE, *WHEN]


def answer_rows(state: SessionState) -> list[Row]:
    """Rows of `questionnaires.csv` for a session."""
    return [
        {**common, "item": item, "answer": answer}
        for record, common in _forms(state)
        for item, answer in record["answers"].items()
    ]


def score_rows(states: Sequence[SessionState], designs: Callable[[str], Design]) -> list[Row]:
    """Rows of `questionnaire_scores.csv`; forms without scales have none.

    Answers are scored by the form as it was asked: a later design may ask, and score, otherwise.

    Args:
        states: States of a participant's sessions, over which places are counted.
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
        ranges = {scale.name: scale.range for scale in form.scales}
        rows += [
            {
                **common,
                "place": places[form.name],
                "scale": score.scale,
                "score": score.value,
                "items_missing": score.missing,
                "score_low": ranges[score.scale][0],
                "score_high": ranges[score.scale][1],
            }
            for score in scores(form.scales, record["answers"])
        ]
    return rows


def _forms(state: SessionState) -> Iterator[tuple[Record, Row]]:
    """The record of every answered form of a session, with the cells that both tables share."""
    for record in state.answers.values():
        yield (
            record,
            {
                **session_cells(state),
                **level_cells(record["levels"]),
                "instrument": record["form"],
                "block_num": record["block"],
                "language": state.start["language"],
                "time": record["time"],
            },
        )
