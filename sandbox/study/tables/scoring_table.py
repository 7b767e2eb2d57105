"""`questionnaire_scores.csv`: one row for every scale of every answered questionnaire."""

from __future__ import annotations

from collections import Counter

from sandbox.study.design.design import Design
from sandbox.study.design.scoring import scores
from sandbox.study.record.state import SessionState
from sandbox.study.tables.answer_table import ASKED, FORM
from sandbox.study.tables.column import Column, Row, factor_columns

PLACE = Column("place", "", "number of this answer of the participant to the questionnaire, from 1")
SCORE = (
    Column("scale", "", "scale of the questionnaire; docs/questionnaires.md has its formula"),
    Column("score", "", "score; empty where an answer is missing, since nothing is filled in"),
    Column("items_missing", "", "answers that the score needs and that were not given"),
    Column("score_low", "", "lowest possible score"),
    Column("score_high", "", "highest possible score"),
)


def score_columns(design: Design) -> list[Column]:
    """Columns of `questionnaire_scores.csv`."""
    return [*FORM, PLACE, *factor_columns(design), *SCORE, *ASKED]


def score_rows(design: Design, state: SessionState) -> list[Row]:
    """Scores of a session; questionnaires without scales have no rows."""
    forms = {form.name: form for form in design.questionnaires}
    places: Counter[str] = Counter()
    rows: list[Row] = []
    for record in state.answers.values():
        form = forms.get(record["form"])
        if form is None:
            continue
        places[form.name] += 1
        about = {
            "experiment": state.start["experiment"],
            "ppid": state.start["ppid"],
            "session_num": state.start["session"],
            "mode": state.start["mode"],
            "instrument": form.name,
            "block_num": record["block"],
            "place": places[form.name],
            **{f"factor_{k}": v for k, v in record["levels"].items()},
            "language": state.start["language"],
            "time": record["time"],
        }
        ranges = {scale.name: scale.range for scale in form.scales}
        rows += [
            {
                **about,
                "scale": found.scale,
                "score": found.value,
                "items_missing": found.missing,
                "score_low": ranges[found.scale][0],
                "score_high": ranges[found.scale][1],
            }
            for found in scores(form.scales, record["answers"])
        ]
    return rows
