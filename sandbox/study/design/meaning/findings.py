"""What a design that is right in form may get wrong: errors and warnings, one line a cause."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sandbox.study.design.design import Design
from sandbox.study.design.meaning.claims import claim_flaws
from sandbox.study.design.meaning.comparisons import comparison_flaws
from sandbox.study.design.meaning.conduct.choosing import choosing_flaws
from sandbox.study.design.meaning.conduct.concluding import concluding_flaws
from sandbox.study.design.meaning.conduct.during import during_flaws
from sandbox.study.design.meaning.conduct.owing import owing_flaws
from sandbox.study.design.meaning.consent import consent_flaws
from sandbox.study.design.meaning.detection import detection_flaws
from sandbox.study.design.meaning.exclusions import exclusion_flaws, joint_flaws
from sandbox.study.design.meaning.expectations import expectation_flaws
from sandbox.study.design.meaning.groups import group_flaws
from sandbox.study.design.meaning.guardians import guardian_flaws
from sandbox.study.design.meaning.languages import language_flaws
from sandbox.study.design.meaning.outcomes import outcome_flaws
from sandbox.study.design.meaning.people import people_flaws
from sandbox.study.design.meaning.practice import practice_flaws
from sandbox.study.design.meaning.promises import promise_flaws
from sandbox.study.design.meaning.questions.answering import answering_flaws
from sandbox.study.design.meaning.questions.answers import answer_flaws
from sandbox.study.design.meaning.questions.comparing import comparing_flaws
from sandbox.study.design.meaning.questions.double import double_flaws
from sandbox.study.design.meaning.questions.ends import end_flaws
from sandbox.study.design.meaning.questions.gain import gain_flaws
from sandbox.study.design.meaning.questions.scales import scale_flaws
from sandbox.study.design.meaning.questions.unknown import unknown_flaws
from sandbox.study.design.meaning.session import session_flaws
from sandbox.study.design.meaning.teaching import teaching_flaws
from sandbox.study.design.meaning.translations import translation_flaws
from sandbox.study.design.reading import Mistake
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.toml_lines import TomlLines


@dataclass(frozen=True)
class Finding:
    """A finding of the check.

    Attributes:
        mistake: Line, place, what is wrong, and the remedy.
        error: True if the study cannot give results as it is; False for a warning.
    """

    mistake: Mistake
    error: bool = False

    def __str__(self) -> str:
        return f"{'error' if self.error else 'warning'}, {self.mistake}"


def findings(design: Design) -> list[Finding]:
    """All findings of a design without mistakes of form, by line."""
    lines = TomlLines(design.text)
    found = []
    for flaw in _all(design):
        where = ""
        for part in flaw.path:
            where += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if where else part
        mistake = Mistake(lines.of(flaw.path), where, flaw.what, flaw.remedy)
        found.append(Finding(mistake, flaw.error))
    return sorted(found, key=lambda finding: finding.mistake.line)


def _all(design: Design) -> Iterator[Flaw]:
    yield from session_flaws(design)
    yield from practice_flaws(design)
    yield from comparison_flaws(design)
    yield from group_flaws(design)
    yield from teaching_flaws(design)
    yield from detection_flaws(design)
    yield from outcome_flaws(design)
    yield from people_flaws(design)
    yield from consent_flaws(design)
    yield from guardian_flaws(design)
    yield from choosing_flaws(design)
    yield from during_flaws(design)
    yield from owing_flaws(design)
    yield from concluding_flaws(design)
    yield from claim_flaws(design)
    yield from promise_flaws(design)
    yield from expectation_flaws(design)
    yield from answer_flaws(design)
    yield from comparing_flaws(design)
    yield from end_flaws(design)
    yield from double_flaws(design)
    yield from scale_flaws(design)
    yield from answering_flaws(design)
    yield from unknown_flaws(design)
    yield from gain_flaws(design)
    yield from language_flaws(design)
    yield from translation_flaws(design)
    yield from joint_flaws(design)
    for i, rule in enumerate(design.exclusions):
        yield from exclusion_flaws(design, ("exclusions", i), rule)
