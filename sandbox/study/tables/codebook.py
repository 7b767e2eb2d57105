"""Columns of all tables of a study, and the table `codebook.csv`, which describes these columns.

The codebook has the type, unit and meaning of each column, marks primary outcomes, and has the
title, scale and limits of each measure. Its first rows are facts about the study, such as changes
by `--force-upgrade` after the first participation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isinf
from types import MappingProxyType

from models.message import counted
from sandbox.study.design.balance import cycle_line
from sandbox.study.design.conditions import combinations
from sandbox.study.design.design import Design, Form
from sandbox.study.design.fields import JOINED, LISTED
from sandbox.study.measures.measures import Measure, find_measure
from sandbox.study.record.folder import StudyFolder, withdrawals_of
from sandbox.study.record.notes import ANONYMISED, UPGRADE
from sandbox.study.tables.column import (
    CHANGE,
    CLOCK_STEPS,
    CONDITIONS,
    EXPERIMENT,
    FACTOR,
    MODE,
    ORDERS,
    PRIMARY,
    STUDY,
    TITLE,
    WITHDRAWALS,
    WORDING,
    Column,
    Row,
    csv_bytes,
)
from sandbox.study.tables.frame_table import FRAMES
from sandbox.study.tables.rows import EVENT, answer_columns, participant_columns, score_columns
from sandbox.study.tables.trial_table import PLACE, trial_columns

COLUMNS = (
    *("table", "column", "type", "unit", "meaning", "role"),
    *("title", "better", "scale", "low", "high"),
)
"""Columns of the codebook. The last five have values only for measures that a report shows."""
INTEGERS = (
    *("session", "trial", "block", "trial_in_block", "position", "respawned", "states"),
    *("number", "attempt", "repetition", "place", "items_missing", "seed", "step"),
    *("sessions_done", "trials_done", "trials_planned"),
)
NUMBERS = ("hand_size", "score", "score_low", "score_high")
"""Columns of numbers without a unit that are not measures."""
ITEM_TYPES = {"text": "text", "choice": "factor", "scale": "number", "number": "number"}
"""Type of the answers to an item, by its kind."""
TOLD = {"paraphrase": "a paraphrase", "translation": "a translation that nobody has validated"}
"""Descriptions of the wordings that readers of a study must know about."""


def columns_by_table(
    design: Design, rows: Mapping[str, Sequence[Row]] = MappingProxyType({})
) -> dict[str, list[Column]]:
    """All columns of the tables, by table.

    Columns of an earlier design are included if rows have them.
    """
    return {
        "trials.csv": trial_columns(design, rows.get("trials.csv", ())),
        "answers.csv": answer_columns(design, rows.get("answers.csv", ())),
        "scores.csv": score_columns(design, rows.get("scores.csv", ())),
        "participants.csv": participant_columns(design, rows.get("participants.csv", ())),
        "events.csv": list(EVENT),
    }


def _wording(form: Form) -> str:
    """Text about a paraphrased or translated wording; empty for any other wording."""
    told = [f"{TOLD[word]} in {code}" for code, word in form.wording.items() if word in TOLD]
    return f"not the published wording, but {', '.join(told)}" if told else ""


def codebook(
    design: Design,
    tables: Mapping[str, Sequence[Column]],
    names: Mapping[str, str] = MappingProxyType({}),
    study: Mapping[str, str] = MappingProxyType({}),
) -> bytes:
    """Content of `codebook.csv`.

    Args:
        design: Design of the study.
        tables: Columns that the written tables have, by table.
        names: Name in the written tables by our name of the column, for names that differ.
        study: Facts about the study, by name.
    """
    language = design.languages[0]
    about: dict[str, list[Column]] = {name: list(columns) for name, columns in tables.items()}
    about["trials/*.frames.csv.gz"] = list(FRAMES)
    kinds = {("participants.csv", item.name): ITEM_TYPES[item.kind] for item in design.demographics}
    for form in design.questionnaires:
        for item in form.items:
            name = f"item {form.name}/{item.name}"
            kinds["answers.csv", name] = ITEM_TYPES[item.kind]
            about["answers.csv"].append(Column(name, "", item.ask[language]))
    about["answers.csv"] += [
        Column(f"{WORDING}{form.name}", "", told)
        for form in design.questionnaires
        if (told := _wording(form))
    ]
    # The first scale of a questionnaire is its score.
    scored = {
        f"score {f.name}/{f.scales[0].name}": f.name for f in design.questionnaires if f.scales
    }
    about["scores.csv"] += [
        Column(name, "", f"the score of {form}") for name, form in scored.items()
    ]
    primary = {
        *(("trials.csv", name) for name in design.primary),
        *(("scores.csv", name) for name, form in scored.items() if form in design.primary),
    }
    about["trials.csv"].append(Column(ORDERS, "", cycle_line(design)))
    own = design.own_measure
    rows = [
        {
            "table": table,
            "column": names.get(c.name, c.name) if table in tables else c.name,
            "type": kinds.get((table, c.name)) or type_of(c, find_measure(c.name, own)),
            "unit": c.unit,
            "meaning": c.meaning,
            "role": PRIMARY if (table, c.name) in primary else "",
            **(_measured(find_measure(c.name, own)) if table == "trials.csv" else {}),
        }
        for table, columns in about.items()
        for c in columns
    ]
    facts = [
        {"table": STUDY, "column": name, "type": "text", "meaning": fact}
        for name, fact in study.items()
    ]
    return csv_bytes([*facts, *rows], COLUMNS)


def _measured(measure: Measure | None) -> Row:
    """Cells about a measure that a report shows; empty for any other column."""
    if measure is None or measure.words or not measure.in_report:
        return {}
    low, high = (None if isinf(end) else end for end in measure.limits)
    return {
        "title": measure.title,
        "better": measure.better,
        "scale": measure.scale,
        "low": low,
        "high": high,
    }


def type_of(column: Column, measure: Measure | None = None) -> str:
    """Type of a column's cells: number, integer, logical (0 and 1), factor or text.

    Args:
        column: The column.
        measure: The measure with the column's name, if there is one.
    """
    if column.name.startswith(FACTOR):
        return "factor"
    if column.name == CLOCK_STEPS:
        return "text"
    if column.unit == "0/1":
        return "logical"
    if column.name in INTEGERS or column.name.startswith(PLACE):
        return "integer"
    numeric = column.unit or (measure is not None and not measure.words) or column.name in NUMBERS
    return "number" if numeric else "text"


def facts_of(study: StudyFolder) -> dict[str, str]:
    """Facts about a study that its report needs and that no table has, by name, for `codebook`."""
    return {
        EXPERIMENT: study.design.name,
        **({TITLE: study.design.title} if study.design.title else {}),
        MODE: study.mode,
        CONDITIONS: LISTED.join(
            JOINED.join(level.name for level in levels.values())
            for levels in combinations(study.design)
        ),
        WITHDRAWALS: str(withdrawals_of(study.records())),
        **{f"{CHANGE}{i}": text for i, text in enumerate(_upgrades_of(study), start=1)},
    }


def _upgrades_of(study: StudyFolder) -> tuple[str, ...]:
    """Returns sentences, from the notes, on every change that was forced after the first
    participation."""
    notes = study.records()
    if any(note["kind"] == ANONYMISED for note in notes):
        return tuple(_of_anonymous_copy(study))
    sentences = []
    for note in notes:
        if note["kind"] != UPGRADE or not note["people"]:
            continue
        what = ", ".join(str(name) for name in note["changed"])
        before, after = (_design(study, note[k].get("design", "")) for k in ("before", "after"))
        sentences.append(
            f"After {counted(note['people'], 'participant')} had begun, the study was changed "
            f"(--force-upgrade): {what}. The reason given: {note['reason']}."
            f"{_differences(before, after)}"
        )
    return tuple(sentences)


def _of_anonymous_copy(study: StudyFolder) -> Iterator[str]:
    """Sentences on changes of the design, for an anonymous copy.

    Such a copy has neither the reasons of the changes nor the order of participants.
    """
    for digest in sorted({*study.session_designs()} - {study.design.digest}):
        yield (
            f"Some sessions were run by an earlier design ({digest}), before the study was "
            f"changed (--force-upgrade).{_differences(_design(study, digest), study.design)}"
        )


def _design(study: StudyFolder, digest: str) -> Design | None:
    """The design with a digest; None if no session has it or it cannot be read."""
    found = study.design_of(digest)
    return found if found.digest == digest else None


def _differences(before: Design | None, after: Design | None) -> str:
    """Sentences on the differences of two designs that change the meaning of results.

    Each begins with a space.
    """
    known = _meanings(before, after) if before and after else ()
    return "".join(f" {sentence}." for sentence in known)


def _meanings(before: Design, after: Design) -> Iterator[str]:
    """Yields sentences on changed primary outcomes, and on levels whose settings have changed under
    the same name."""
    if before.primary != after.primary:
        names = [", ".join(design.primary) or "none" for design in (before, after)]
        yield f"Primary outcomes were {names[0]} before and are {names[1]}"
    known = {(f.name, level.name): level.settings for f in before.factors for level in f.levels}
    for factor in after.factors:
        for level in factor.levels:
            had = known.get((factor.name, level.name), level.settings)
            for name in sorted({*had, *level.settings}):
                one, other = had.get(name), level.settings.get(name)
                if one != other:
                    yield (
                        f"Trials of {factor.name} {level.name} had {name} {_value(one)} before and "
                        f"{_value(other)} after, under one name"
                    )


def _value(value: object) -> str:
    return "as in all trials" if value is None else str(value) or "nothing"
