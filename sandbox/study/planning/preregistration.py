"""The text of a preregistration, from a design and what its study is locked to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from models.errors import StudyError
from models.messages.wording import counted
from sandbox.study.design.balance import cycle_line
from sandbox.study.design.conditions import combinations, tasks_of
from sandbox.study.design.design import END, START, Design, Exclusion, Factor
from sandbox.study.design.plan import duration, session_plan, trials_of
from sandbox.study.design.planned import PlannedTests, family_size, planned_tests
from sandbox.study.planning.needed import TO_WRITE
from sandbox.study.record.build import build_of
from sandbox.study.record.files import write_new
from sandbox.study.record.folder import StudyFolder


def write_preregistration(
    file: Path, design: Design, participants: int, power: Sequence[str]
) -> None:
    """Writes the text; an existing file is never overwritten.

    Args:
        file: The file.
        design: Design of the study.
        participants: Number of participants.
        power: Lines about power.

    Raises:
        StudyError: The file exists or cannot be written, or the study beside the design is locked
            to another one.
    """
    write_new(file, preregistration(design, participants, power, lock_of(design)))


def lock_of(design: Design) -> dict[str, Any]:
    """What the study is locked to: that of the folder with this design, or of this program.

    Raises:
        StudyError: The design beside a study is not the one it is locked to.
    """
    folder = design.path.resolve().parent
    if not (folder / "study.json").is_file():
        return build_of(design)
    build = StudyFolder.at(folder).build
    if build["design"] != design.digest:
        raise StudyError(
            "the study is locked to another design",
            where=str(design.path),
            got=design.digest,
            expected=str(build["design"]),
            remedy="Restore the design that the study began with",
        )
    return build


def preregistration(
    design: Design, participants: int, power: Sequence[str], lock: dict[str, Any]
) -> str:
    """The text, as Markdown."""
    tests = planned_tests(design)
    steps = [session_plan(design, 0, s + 1) for s in range(design.sessions)]
    practice = sum(t.practice for some in steps for t in trials_of(some))
    trials = sum(len(trials_of(some)) for some in steps) - practice
    minutes = max(duration(design, some) for some in steps) / 60
    count = sum(1 for _ in combinations(design))
    parts = {
        f"Preregistration: {design.title or design.name}": [
            f"Question and hypotheses: {TO_WRITE}. Name the direction of each expected difference, "
            "and which result would speak against it."
        ],
        "Design": [
            *(_factor(factor) for factor in design.factors),
            f"- Conditions: {count}; repetitions: {design.repetitions}; sessions: "
            f"{design.sessions}; trials of each participant: {trials}, and {practice} of practice, "
            f"which are not analysed. {_limits(design)}",
            f"- Starts and goals: {'shared by all' if design.seeds == 'shared' else 'own'}; all "
            f"chance follows from seed {design.seed}. A session takes about {minutes:.0f} min.",
            f"- {cycle_line(design)}.",
            *(_form(design, i) for i in range(len(design.questionnaires))),
        ],
        "Participants": [
            f"- {participants} participants finish all sessions. Who does not consent, is excluded "
            "by the experimenter or withdraws, is replaced by the next participant with the same "
            "orders. Data collection ends with that number, whatever the results are.",
            f"- Recruitment, and who may take part: {TO_WRITE}.",
        ],
        "Power": [f"- {line.strip()}" for line in power],
        "Exclusions": [
            *(_exclusion(rule) for rule in design.exclusions),
            "- The experimenter excludes a trial or participant during the session only, with a "
            "reason that is logged; excluded data are kept, and the report counts them.",
            "- Trials without success are not excluded: they count as failures, and their times as "
            "longer than they lasted.",
        ],
        "Analysis": _analysis(design, tests),
        "Locked": [
            "- The study refuses to go on with anything else, unless the change is logged with its "
            "reason.",
            *(f"- {name}: {_told(value)}" for name, value in sorted(lock.items())),
        ],
    }
    levels = ["#", *("##" for _ in parts)]
    return (
        "\n\n".join(
            f"{level} {title}\n\n" + "\n".join(lines)
            for level, (title, lines) in zip(levels, parts.items(), strict=False)
        )
        + "\n"
    )


def _limits(design: Design) -> str:
    own = {
        name: task.time_limit
        for name, task in tasks_of(design).items()
        if task.time_limit < design.time_limit
    }
    most = f"A trial ends with success or after {design.time_limit:g} s at the latest"
    if not own:
        return f"{most}."
    shorter = ", ".join(f"of {name} after {limit:g} s" for name, limit in own.items())
    return f"{most}, {shorter}, which is the task's own limit."


def _factor(factor: Factor) -> str:
    who = "between" if factor.order == "between" else "within"
    names = ", ".join(level.name for level in factor.levels)
    inside = f", inside of {factor.outer}" if factor.outer else ""
    return f"- Factor {factor.name}: {names}; {who} participants, order {factor.order}{inside}."


def _form(design: Design, index: int) -> str:
    form = design.questionnaires[index]
    when = {START: "at the start", END: "at the end"}.get(form.at, f"after each level of {form.at}")
    score = f"its score is {form.scales[0].name}" if form.scales else "described only"
    return f"- Questionnaire {form.name}, {when}: {counted(len(form.items), 'question')}; {score}."


def _exclusion(rule: Exclusion) -> str:
    bounds = [
        f"{word} {bound:g}"
        for word, bound in (("below", rule.below), ("above", rule.above))
        if bound is not None
    ]
    what = "trial" if rule.of == "trial" else "participant (mean over counted trials)"
    return f"- {rule.name}: a {what} with {rule.measure} {' or '.join(bounds)} is excluded."


def _analysis(design: Design, tests: Sequence[PlannedTests]) -> list[str]:
    listed = [
        f"- {test.outcome} by {test.factor.name}: {test.pairs} "
        f"{'comparison' if test.pairs == 1 else 'comparisons'} of levels."
        for test in tests
    ]
    outcomes = {test.outcome for test in tests}
    named = (
        "These primary outcomes are tested, and are confirmatory:"
        if design.primary
        else "No outcome is named as primary, so all that is compared is tested:"
    )
    methods = []
    if "time_s" in outcomes:
        methods.append(
            "- Completion time: differences of log time between levels, averaged over the other "
            "factors. If any trial has no success, by a lognormal Tobit model in which its time is "
            "longer than it lasted, with errors by the jackknife over people; otherwise by a "
            "linear mixed model with random effects of person and person x factor."
        )
    if "success" in outcomes:
        methods.append(
            "- Success: differences of people's own shares, with p values by permutation over "
            "people and limits from Wilson's."
        )
    forms = {form.name for form in design.questionnaires}
    if outcomes & forms:
        methods.append("- Scores of questionnaires: paired t tests; between groups, Welch's.")
    if outcomes - forms - {"time_s", "success"}:
        methods.append(
            "- Other measures: linear mixed models, of logarithms for lengths, times and speeds; "
            "of 0 and 1 as for success."
        )
    return [
        f"{named}\n",
        *listed,
        f"- P values of all {family_size(list(tests))} tests are adjusted together (Holm 1979); "
        "the threshold is 0.05, two-sided. Intervals are 95 %.",
        *methods,
        "- Everything else is exploratory: estimates with intervals, without tests. That includes "
        "interactions and simple effects.",
        "- `sandbox study report` makes this analysis.",
    ]


def _told(value: object) -> str:
    if isinstance(value, dict):
        return "; ".join(f"{k} {_told(v)}" for k, v in sorted(value.items()) if v not in ("", None))
    return str(value)
