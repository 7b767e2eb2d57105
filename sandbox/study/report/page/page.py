"""The report as one HTML file: no script, nothing fetched, light or dark as the reader wants."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from sandbox.study.report.models.analysis import Analysis
from sandbox.study.report.models.exclusions import flow
from sandbox.study.report.page import formats
from sandbox.study.report.page.methods import methods_section
from sandbox.study.report.page.parts import Section
from sandbox.study.report.page.section_checks import (
    exclusions_section,
    others_section,
    people_section,
    practice_section,
    questionnaire_section,
)
from sandbox.study.report.page.section_results import (
    asked_sections,
    success_section,
    time_section,
    unseen_model,
)

KINDS = {"real": "Study", "pilot": "Pilot", "simulated": "Simulated"}
TITLES = {
    "real": "{}",
    "pilot": "Pilot of {}",
    "simulated": "{}, simulated",
}
WARNINGS = {
    "simulated": "No person took part. Simulated users did these trials: they show that the study "
    "runs, and nothing about people.",
    "pilot": "A rehearsal. These data are no part of the study.",
}
UNKNOWN = (
    "Of unknown kind",
    "{}, data of unknown kind",
    "These tables do not say whether people took part.",
)
MOST_FINDINGS = 12


def page(found: Analysis) -> str:
    """The whole HTML."""
    from jinja2 import Environment

    here = files("sandbox.study.report.page")
    template = Environment(autoescape=True).from_string(
        here.joinpath("page.html").read_text(encoding="utf-8")
    )
    css = here.joinpath("page.css").read_text(encoding="utf-8")
    return template.render(css=_Safe(css), sections=_sections(found), **head(found))


class _Safe(str):
    """Text of our own that is already HTML."""

    def __html__(self) -> str:
        return str(self)


def head(found: Analysis) -> dict[str, Any]:
    """Head of the page above the sections: title, warning, facts and findings."""
    data = found.data
    mode = data.mode if data.mode in KINDS else "unknown"
    kind, title, warning = UNKNOWN
    if mode != "unknown":
        kind, title, warning = KINDS[mode], TITLES[mode], WARNINGS.get(mode, "")
    return {
        "mode": mode,
        "kind": kind,
        "title": title.format(data.name),
        "warning": warning,
        "facts": _facts(found),
        "findings": _findings(found),
    }


def _sections(found: Analysis) -> list[Section]:
    return [
        time_section(found),
        success_section(found),
        *asked_sections(found),
        people_section(found),
        practice_section(found),
        questionnaire_section(found),
        exclusions_section(found),
        others_section(found),
        methods_section(found),
    ]


def _facts(found: Analysis) -> list[tuple[str, str, str]]:
    data = found.data
    steps = flow(data)
    began, used = steps[0], steps[-1]
    count = next(s for s in steps if s.what == "trials that count")
    facts = [
        ("Participants used", str(used.participants), f"of {began.participants} who began"),
        ("Trials used", str(used.trials), f"of {count.trials} that count"),
    ]
    if found.success:
        rate = float(data.used["success"].mean())
        won = int(data.used["success"].sum())
        facts.append(("Success", formats.percent(rate), f"{won} of {len(data.used)} trials"))
    if found.time:
        middle = float(data.used.loc[~data.used["censored"], "time_s"].median())
        facts.append(
            ("Median completion time", f"{formats.number(middle)} s", "of trials that succeeded")
        )
    return facts


def _findings(found: Analysis) -> list[str]:
    """The comparisons in words: every pair of levels of the first factor, time and success."""
    main = found.main.name if found.main else ""
    out = []
    for d in found.leading:
        if d.pair.factor.name == main:
            ends = formats.interval(formats.change(d.estimate.low), formats.change(d.estimate.high))
            clear = d.estimate.low > 0 or d.estimate.high < 0
            doubt = "" if clear else "; it may be none"
            out.append(
                f"{d.pair.second} took {formats.less_or_more(d.estimate, 'less', 'more')} time "
                f"than {d.pair.first} (95 % interval {ends}{doubt})."
            )
    if out and unseen_model(found):
        out[-1] += " Trials without success are taken as longer than they lasted."
    for s in found.success.shares if found.success else []:
        if s.pair.factor.name == main:
            ends = formats.interval(formats.points(s.estimate.low), formats.points(s.estimate.high))
            doubt = "" if s.estimate.low > 0 or s.estimate.high < 0 else "; it may be none"
            out.append(
                f"{s.pair.second} succeeded in {formats.percent(s.second.value)} of trials, "
                f"{s.pair.first} in {formats.percent(s.first.value)}: "
                f"{formats.points(s.estimate.value)} points (95 % interval {ends}{doubt})."
            )
    if len(out) > MOST_FINDINGS:
        return [*out[:MOST_FINDINGS], "The other pairs are in the tables below."]
    return out
