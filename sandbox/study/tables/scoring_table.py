"""`questionnaire_scores.csv`: one row for every scale of every answered questionnaire."""

from __future__ import annotations

from collections import Counter
from typing import Any

from sandbox.study.design.design import Design
from sandbox.study.design.scoring import scores
from sandbox.study.record.state import SessionState

Row = dict[str, Any]

BEFORE = ("experiment", "ppid", "session_num", "mode", "instrument", "block_num", "place")
AFTER = ("scale", "score", "items_missing", "score_low", "score_high", "language", "time")

COLUMNS = {
    "place": ("", "1, 2, ...: the how manyeth time that this participant answered this "
              "questionnaire"),
    "scale": ("", "of the questionnaire; docs/questionnaires.md tells how it is computed"),
    "score": ("", "empty where an answer is missing: nothing is filled in"),
    "items_missing": ("", "answers that the score needs and that were not given"),
    "score_low": ("", "the lowest score there can be"),
    "score_high": ("", "the highest score there can be"),
}  # fmt: skip
"""For the codebook: unit and meaning of the columns that no other table has."""


def score_columns(design: Design) -> list[str]:
    """Columns of `questionnaire_scores.csv`."""
    return [*BEFORE, *(f"factor_{f.name}" for f in design.factors), *AFTER]


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
