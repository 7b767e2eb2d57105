"""The report as one HTML file without scripts or external resources, in light or dark colours."""

from __future__ import annotations

from importlib.resources import files
from math import isfinite
from typing import Any

from models.message import counted
from sandbox.study.report.models.analysis import Analysis
from sandbox.study.report.models.comparisons import Pair, titles_of
from sandbox.study.report.models.exclusions import flow
from sandbox.study.report.models.family import Family
from sandbox.study.report.models.quantities import MAIN
from sandbox.study.report.page import formats
from sandbox.study.report.page.methods import methods_section
from sandbox.study.report.page.one_person import of_one_person, one_person_sections
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
)

KINDS = {"real": "Study", "pilot": "Pilot", "simulated": "Simulated"}
TITLES = {
    "real": "{}",
    "pilot": "Pilot of {}",
    "simulated": "{}, simulated",
}
WARNINGS = {
    "simulated": "No person took part. Simulated users did these trials, which show that the study "
    "runs but nothing about people.",
    "pilot": "Data of a pilot. They are not part of the study.",
}
UNKNOWN = (
    "Unknown kind",
    "{}, data of unknown kind",
    "These tables do not show whether people took part.",
)
MOST_FINDINGS = 12


def page(analysis: Analysis, lacking: str = "") -> str:
    """Returns the HTML text of the report.

    Args:
        analysis: What is shown.
        lacking: What the tables lack, in sentences for the top of the page.
    """
    from jinja2 import Environment

    here = files("sandbox.study.report.page")
    template = Environment(autoescape=True).from_string(
        here.joinpath("page.html").read_text(encoding="utf-8")
    )
    css = here.joinpath("page.css").read_text(encoding="utf-8")
    told = head(analysis)
    told["warning"] = " ".join(filter(None, (told["warning"], lacking)))
    return template.render(css=_Safe(css), sections=_sections(analysis), **told)


class _Safe(str):
    """Text that is already HTML and is not escaped."""

    def __html__(self) -> str:
        return str(self)


def head(analysis: Analysis) -> dict[str, Any]:
    """Values of the head of the page: title, warning, facts and findings."""
    data = analysis.data
    mode = data.mode if data.mode in KINDS else "unknown"
    kind, title, warning = UNKNOWN
    if mode != "unknown":
        kind, title, warning = KINDS[mode], TITLES[mode], WARNINGS.get(mode, "")
    upgraded = (
        "The study was changed after people had begun; the last section says what and why."
        if data.upgrades
        else ""
    )
    return {
        "mode": mode,
        "kind": kind,
        "title": title.format(data.name),
        "warning": " ".join(filter(None, (warning, data.rehearsed, upgraded))),
        "facts": _facts(analysis),
        "findings": [] if of_one_person(analysis.data) else _findings(analysis),
    }


def _sections(analysis: Analysis) -> list[Section]:
    if of_one_person(analysis.data):
        return one_person_sections(analysis)
    return [
        time_section(analysis),
        success_section(analysis),
        *asked_sections(analysis),
        people_section(analysis),
        practice_section(analysis),
        questionnaire_section(analysis),
        exclusions_section(analysis),
        others_section(analysis),
        methods_section(analysis),
    ]


def _facts(analysis: Analysis) -> list[tuple[str, str, str]]:
    data = analysis.data
    steps = flow(data)
    began, used = steps[0], steps[-1]
    count = next(s for s in steps if s.what == "trials that count")
    gone = f"; {data.withdrawn} more withdrew" if data.withdrawn else ""
    facts = [
        ("Participants used", str(used.participants), f"of {began.participants} who began{gone}"),
        ("Trials used", str(used.trials), f"of {count.trials} that count"),
    ]
    if analysis.success:
        rate = float(data.used["success"].mean())
        won = int(data.used["success"].sum())
        facts.append(
            ("Success", formats.percent(rate), f"{won} of {counted(len(data.used), 'trial')}")
        )
    if analysis.time:
        middle = float(data.used.loc[~data.used["censored"], "time_s"].median())
        facts.append(
            ("Median completion time", f"{formats.number(middle)} s", "of trials that succeeded")
        )
    return facts


def _findings(analysis: Analysis) -> list[str]:
    """Sentences on the tests of the main factor in time and success, and on all other findings.

    What is exploratory is said to be so, and is an estimate and no finding.
    """
    main = analysis.main.name if analysis.main else ""
    family = analysis.family
    out = []
    for d in analysis.leading:
        if d.pair.factor.name == main:
            ends = formats.interval(formats.change(d.estimate.low), formats.change(d.estimate.high))
            out.append(
                f"{d.pair.second} took {formats.less_or_more(d.estimate, 'less', 'more')} time "
                f"than {d.pair.first} ({_certainty(ends, _verdict(family, 'time_s', d.pair))})."
            )
    if out and analysis.with_unseen:
        out[-1] += " Trials without success are assumed to take longer than they lasted."
    for s in analysis.success.shares if analysis.success else []:
        if s.pair.factor.name == main and not isfinite(s.estimate.value):
            out.append(
                f"Success with {s.pair.second} and with {s.pair.first} is not compared, as nobody "
                "did both."
            )
        elif s.pair.factor.name == main:
            ends = formats.interval(formats.points(s.estimate.low), formats.points(s.estimate.high))
            out.append(
                f"{s.pair.second} succeeded in {formats.percent(s.second.value)} of trials, "
                f"{s.pair.first} in {formats.percent(s.first.value)}: "
                f"{formats.points(s.estimate.value)} points "
                f"({_certainty(ends, _verdict(family, 'success', s.pair))})."
            )
    out += [
        f"{title}: {test.outcome} differs ({_verdict(family, test.outcome, test.pair)})."
        for title, test in zip(titles_of(family.findings), family.findings, strict=True)
        if test.outcome not in MAIN
    ]
    if len(out) > MOST_FINDINGS:
        return [*out[:MOST_FINDINGS], "The other pairs are in the tables below."]
    return out


_NO_SPREAD = "as there are too few people or all of them differ alike"


def _certainty(ends: str, verdict: str) -> str:
    """What follows from a difference: its interval and verdict, or nothing without an interval."""
    if ends == formats.UNKNOWN:
        return f"no interval, {_NO_SPREAD}, so that nothing follows for others"
    return f"95 % interval {ends}; {verdict}"


def _verdict(family: Family, outcome: str, pair: Pair) -> str:
    """Verdict of the test of a pair, in a few words."""
    test = family.test(outcome, pair)
    if test is None:
        return "exploratory"
    if not isfinite(test.p_holm):
        return f"no test, {_NO_SPREAD}"
    said = f"p, Holm {formats.p_value(test.p_holm)}"
    return said if test.found else f"{said}: there may be no difference"
