"""`questionnaires.csv`: one row for every answer."""

from __future__ import annotations

from sandbox.study.design.design import Design
from sandbox.study.record.state import SessionState
from sandbox.study.tables.column import Column, Row, factor_columns
from sandbox.study.tables.trial_table import SESSION, UXF

FORM = (
    *UXF[:3],
    SESSION[0],
    Column("instrument", "", "name of the questionnaire"),
    UXF[4],
)
"""The first columns of tables about questionnaires."""
ANSWER = (
    Column("item", "", "name of the question"),
    Column("answer", "", "the answer as it was given"),
)
ASKED = (
    Column("language", "", "language of the texts"),
    Column("time", "", "time of the answers, UTC"),
)


def answer_columns(design: Design) -> list[Column]:
    """Columns of `questionnaires.csv`."""
    return [*FORM, *factor_columns(design), *ANSWER, *ASKED]


def answer_rows(state: SessionState) -> list[Row]:
    """One row for every answer of a session."""
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
