"""Columns of all tables of a study, and `codebook.csv`, which gives unit and meaning of each, and
the role of primary outcomes."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.study.design.balance import cycle_line
from sandbox.study.design.design import Design, Form
from sandbox.study.measures.kept import ORDERS, WORDING
from sandbox.study.measures.measure import PRIMARY
from sandbox.study.tables.column import NO_EARLIER, Column, Earlier, csv_bytes
from sandbox.study.tables.frame_columns import FRAMES, TOUCHES
from sandbox.study.tables.participant_table import participant_columns
from sandbox.study.tables.questionnaire_tables import answer_columns, score_columns
from sandbox.study.tables.trial_table import trial_columns

TOLD = {"paraphrase": "a paraphrase", "translation": "a translation that nobody has validated"}
"""Wordings that readers have to know of, in their words."""


def columns_by_table(design: Design, earlier: Earlier = NO_EARLIER) -> dict[str, list[Column]]:
    """Columns of the tables that exist for each session and for the whole study."""
    return {
        "trial_results.csv": trial_columns(design, earlier),
        "questionnaires.csv": answer_columns(design, earlier),
        "questionnaire_scores.csv": score_columns(design, earlier),
        "participants.csv": participant_columns(design, earlier),
    }


def _wording(form: Form) -> str:
    """Words on a wording that is not the published one, by language; empty for others."""
    told = [f"{TOLD[word]} in {code}" for code, word in form.wording.items() if word in TOLD]
    return f"not the published wording, but {', '.join(told)}" if told else ""


def codebook(design: Design, earlier: Earlier = NO_EARLIER) -> bytes:
    """Content of `codebook.csv`."""
    tables: dict[str, Sequence[Column]] = {
        **columns_by_table(design, earlier),
        "trackers/frames_*": FRAMES,
        "trackers/touches_*": TOUCHES,
    }
    language = design.languages[0]
    items = [
        Column(f"item {form.name}/{item.name}", "", item.ask[language])
        for form in design.questionnaires
        for item in form.items
    ]
    wordings = [
        Column(f"{WORDING}{form.name}", "", told)
        for form in design.questionnaires
        if (told := _wording(form))
    ]
    tables["questionnaires.csv"] = [*tables["questionnaires.csv"], *items, *wordings]
    # The first scale of a questionnaire is its score.
    scored = {
        f"score {f.name}/{f.scales[0].name}": f.name for f in design.questionnaires if f.scales
    }
    scores = [Column(name, "", f"the score of {form}") for name, form in scored.items()]
    tables["questionnaire_scores.csv"] = [*tables["questionnaire_scores.csv"], *scores]
    primary = {
        *(("trial_results.csv", name) for name in design.primary),
        *(
            ("questionnaire_scores.csv", name)
            for name, form in scored.items()
            if form in design.primary
        ),
    }
    orders = Column(ORDERS, "", cycle_line(design))
    tables["trial_results.csv"] = [*tables["trial_results.csv"], orders]
    rows = [
        {
            "table": table,
            "column": c.name,
            "unit": c.unit,
            "meaning": c.meaning,
            "role": PRIMARY if (table, c.name) in primary else "",
        }
        for table, columns in tables.items()
        for c in columns
    ]
    return csv_bytes(rows, ["table", "column", "unit", "meaning", "role"])
