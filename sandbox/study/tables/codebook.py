"""`codebook.csv`: unit and meaning of every column, written beside the tables."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.study.design.design import Design
from sandbox.study.tables.answer_table import answer_columns
from sandbox.study.tables.column import Column, csv_bytes
from sandbox.study.tables.frame_columns import FRAMES, TOUCHES
from sandbox.study.tables.people_table import person_columns
from sandbox.study.tables.scoring_table import score_columns
from sandbox.study.tables.trial_table import trial_columns


def codebook(design: Design) -> bytes:
    """The codebook of a study's tables, as a table itself."""
    language = design.languages[0]
    items = [
        Column(f"item {form.name}/{item.name}", "", item.ask[language])
        for form in design.questionnaires
        for item in form.items
    ]
    tables: dict[str, Sequence[Column]] = {
        "trial_results.csv": trial_columns(design),
        "questionnaires.csv": [*answer_columns(design), *items],
        "questionnaire_scores.csv": score_columns(design),
        "participants.csv": person_columns(design),
        "trackers/frames_*": FRAMES,
        "trackers/touches_*": TOUCHES,
    }
    rows = [
        {"table": table, "column": c.name, "unit": c.unit, "meaning": c.meaning}
        for table, columns in tables.items()
        for c in columns
    ]
    return csv_bytes(rows, ["table", "column", "unit", "meaning"])
