"""Sections for a study of which one person's trials are used: that person's results, in two pages.

One person shows nothing about other people, so nothing is compared and nothing has an interval.
"""

from __future__ import annotations

from sandbox.study.report.models.analysis import Analysis
from sandbox.study.report.models.answers import ScaleAnswers
from sandbox.study.report.models.data import StudyData
from sandbox.study.report.models.exclusions import flow, gaps
from sandbox.study.report.page import formats
from sandbox.study.report.page.parts import Section, Table


def of_one_person(data: StudyData) -> bool:
    """True if the trials of one person are used."""
    return len(data.ppids) == 1


def one_person_sections(analysis: Analysis) -> list[Section]:
    """Sections of the page: the person's trials and answers, and what was left out."""
    answers = _answers(analysis)
    sections = [_trials(analysis.data), answers, _used(analysis.data), _source(analysis.data)]
    return [section for section in sections if section.parts]


def _trials(data: StudyData) -> Section:
    section = Section("trials", "Trials")
    section.say(
        "These are the results of one person. They show nothing about other people, so this report "
        "compares no conditions. With two people or more it does.",
        "note",
    )
    rows = []
    for condition in data.conditions:
        own = data.used[data.used["condition"] == condition]
        times = own.loc[~own["censored"], "time_s"]
        shown = [formats.number(float(t)) for t in (times.median(), times.min(), times.max())]
        rows.append([condition, str(len(own)), str(len(times)), *shown])
    section.parts.append(
        Table(
            "Trials by condition",
            ["Condition", "Trials", "Succeeded", "Median time, s", "Shortest, s", "Longest, s"],
            rows,
            "Times are of trials that succeeded.",
        )
    )
    return section


def _answers(analysis: Analysis) -> Section:
    """Scores of questionnaires, and questions without a score, by level."""
    section = Section("questionnaires", "Questionnaires")
    scored = {s.questionnaire for s in analysis.scales if s.score}
    groups: dict[tuple[str, ...], list[ScaleAnswers]] = {}
    for scale in analysis.scales:
        if scale.score or scale.questionnaire not in scored:
            groups.setdefault(scale.levels, []).append(scale)
    for levels, some in groups.items():
        rows = [
            [s.title, *(formats.number(float(v)) for v in s.values[0])]
            for s in some
            if len(s.values) == 1
        ]
        if rows:
            section.parts.append(Table("Answers", ["Questionnaire", *levels], rows))
    if any(len(scale.values) > 1 for scale in analysis.scales):
        section.say(
            "Questionnaires that people whose trials are not used have answered too are left out "
            "here: questionnaire_scores.csv has them.",
            "note",
        )
    if section.parts:
        for name, told in analysis.data.wordings.items():
            section.say(f"{name} has {told}.", "note")
    return section


def _used(data: StudyData) -> Section:
    """Trials that were used and left out, in words."""
    section = Section("exclusions", "Excluded data")
    began, finished, *removed, used = flow(data)
    gone = [f"{step.what}: {step.trials}" for step in removed if not step.remains]
    section.say(
        f"{formats.count(began.participants, 'person', 'people')} began. Of "
        f"{formats.count(finished.trials, 'finished attempt')}, {used.trials} are used"
        + (f". Left out: {'; '.join(gone)}. " if gone else ". ")
        + "Nothing is deleted: trial_results.csv has all trials."
    )
    for sentence in filter(None, (data.withdrawals, *gaps(data))):
        section.say(sentence, "note")
    return section


def _source(data: StudyData) -> Section:
    section = Section("methods", "How this was computed")
    for sentence in data.upgrades:
        section.say(sentence, "note")
    for line in (*data.kept, *data.clock_steps):
        section.say(f"{line}.", "note")
    rows = formats.count(len(data.trials), "row")
    section.say(
        "One attempt of each finished trial counts. Practice trials and excluded trials are not "
        f"used. Computed from {rows} of trial_results.csv (SHA-256 {data.digest[:16]}…). The files "
        "beside this page have all numbers."
    )
    return section
