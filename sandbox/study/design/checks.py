"""Checks of the numbers and the structure of a design that has no mistakes of form.

The meaning of its texts is not checked. `design_file` finds mistakes of form while it reads the
file.
"""

from __future__ import annotations

import itertools
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib.resources import files

from models.errors import HandSandboxError
from models.message import counted
from sandbox.study.design.balance import confounded, nearest_cycles, whole_cycle
from sandbox.study.design.conditions import combinations, run_settings, tasks_of, values_of
from sandbox.study.design.design import Design, Exclusion, Factor, Item, Level
from sandbox.study.design.power import planned_tests
from sandbox.study.design.reading import Mistake, Path, Text, TomlLines, place_of
from sandbox.study.design.session_plan import (
    BreakStep,
    FormStep,
    InstructionStep,
    Step,
    TrialStep,
    duration,
    in_the_air,
    session_plan,
    trials_of,
)
from sandbox.study.measures.measures import find_measure
from sandbox.words import LANGUAGES, base, words_of_studies

LONGEST_SESSION = 5400.0
"""Longest session without a warning, s. A rule of thumb: in a longer session, fatigue affects the
results."""
LONGEST_STRETCH = 1800.0
"""Longest time without a break that gives no warning, s; also a rule of thumb."""
MOST_PEOPLE = 12
"""Largest number of participants whose sessions are examined."""
FURTHEST = 12
"""Largest change of the number of trials between breaks that is tried for a remedy."""
QUICK = 0.5
"""Share of the expected duration of a trial; a shorter time may be an accident."""
COPIED = 15
"""Number of characters from which on equal texts in two languages are not a coincidence.
"""
NAMED = 4
"""Largest number of missing words that a finding names."""
WITHIN = ("time_s", "completion_s", "first_contact_s", "first_push_s")
"""Measures that are times within a trial, so that its time limit bounds them."""
DEVICES = ("device", "second_device", "webcam", "leap_at")
"""Settings that choose real devices. `run_settings` may give equal settings for different devices.
"""
OF_TOUCHES = ("encoder", "labels")
"""Settings of the conversion of touches to a pose. They have no effect for a hand in the air."""
UNREAD = (
    "Only form and numbers were checked, not the meaning of your texts: print `sandbox study "
    "sheet` and docs/checklist.md for a colleague and the board."
)
"""Last line that a check prints."""


@dataclass(frozen=True)
class Finding:
    """A part of the design that has no mistake of form, but is misleading or useless.

    Attributes:
        path: Place in the design file.
        what: What is wrong.
        remedy: What to do about it.
        error: True if `run` refuses real participants with it; False for a warning.
        line: Line of the place in the file.
    """

    path: Path
    what: str
    remedy: str
    error: bool = False
    line: int = 1

    @property
    def where(self) -> str:
        """The place as text."""
        return place_of(self.path)

    def __str__(self) -> str:
        mistake = Mistake(self.line, self.where, self.what, self.remedy)
        return f"{'error' if self.error else 'warning'}, {mistake}"


def findings(design: Design) -> list[Finding]:
    """All findings of a design without mistakes of form, in the order of their lines."""
    lines = TomlLines(design.text)
    found = [replace(one, line=lines.of(one.path)) for one in _all(design, lines)]
    return sorted(found, key=lambda finding: finding.line)


def _all(design: Design, lines: TomlLines) -> Iterator[Finding]:
    yield from _placeholders(design)
    yield from _words(design)
    yield from _untranslated(design)
    yield from _factors(design)
    yield from _people(design)
    yield from _practice(design)
    yield from _limits(design, lines)
    plans = [session_plan(design, 1, n + 1) for n in range(design.sessions)]
    yield from _never(design, plans)
    yield from _lengths(design, plans)
    yield from _exclusions(design)


def _placeholders(design: Design) -> Iterator[Finding]:
    """Yields a finding for no consent, and for a name or a consent text of the template."""
    template = tomllib.loads(
        files("sandbox.study.design").joinpath("template.toml").read_text(encoding="utf-8")
    )
    if design.name == template["name"]:
        yield Finding(
            ("name",),
            f"the name is still {design.name}, that of the template",
            "Write your study's name, which also names the folder with the data",
            error=True,
        )
    if not design.consent:
        yield Finding(
            ("consent",),
            "participants are not asked for their consent",
            'Add [consent] with text = "..."; without it, `run --pilot` and `simulate` work',
            error=True,
        )
    elif template["consent"]["text"] in design.consent.values():
        yield Finding(
            ("consent", "text"),
            "the consent is still that of the template",
            "Write what your board has approved",
            error=True,
        )


def _words(design: Design) -> Iterator[Finding]:
    """Yields a finding for each language in which the page lacks words."""
    for i, code in enumerate(design.languages):
        own = design.page.words.get(code, {})
        missing = [key for key in words_of_studies(design.page.shows) if key not in own]
        if base(code) not in LANGUAGES and missing:
            some = ", ".join(missing[:NAMED]) + (", ..." if len(missing) > NAMED else "")
            yield Finding(
                ("words", code) if own else ("languages", i),
                f"the page has no words in {code}, so {len(missing)} of them would be in English: "
                f"{some}",
                f"Write them in [words.{code}], or remove {code}; sandbox/words/en.json has the "
                "English texts",
                error=True,
            )


def _untranslated(design: Design) -> Iterator[Finding]:
    """Yields a finding for each text that is the same in two languages, and each choice without a
    text."""
    several = {base(code) for code in design.languages}
    for path, text in _texts(design):
        for (a, one), (b, other) in itertools.combinations(text.items(), 2):
            alike = one.strip() == other.strip() and len(one.strip()) >= COPIED
            if alike and base(a) != base(b):
                yield Finding(path, f"the text is the same in {a} and {b}", "Translate it")
                break
    for path, item in _items(design):
        if item.choices and not item.means and len(several) > 1:
            yield Finding(
                path,
                f"in every language, the choices of {item.name!r} are read as they are stored: "
                f"{', '.join(item.choices)}",
                "Write means = [...], with a text in each language for every choice",
            )


def _items(design: Design) -> Iterator[tuple[Path, Item]]:
    """All questions that are in the design."""
    for i, item in enumerate(design.demographics):
        yield ("demographics", i), item
    for i, form in enumerate(design.questionnaires):
        for j, item in enumerate(form.items):
            yield ("questionnaires", i, "items", j), item


def _texts(design: Design) -> Iterator[tuple[Path, Text]]:
    """All texts that participants read."""
    yield ("consent", "text"), design.consent
    for i, instruction in enumerate(design.instructions):
        yield ("instructions", i, "text"), instruction.text
    for i, goal in enumerate(design.page.goals.values()):
        yield ("tasks", i, "goal"), goal
    for i, form in enumerate(design.questionnaires):
        yield ("questionnaires", i, "title"), form.title
    for path, item in _items(design):
        yield (*path, "ask"), item.ask


def _factors(design: Design) -> Iterator[Finding]:
    """Yields a finding for each factor with one level, with one order, or with equal levels."""
    for i, factor in enumerate(design.factors):
        if len(factor.levels) == 1:
            yield Finding(
                ("factors", i, "levels"),
                f"{factor.name} has one level only, {factor.levels[0].name}, and varies nothing",
                "Add a level, or move the setting to [settings]",
            )
        elif factor.order == "blocked":
            names = ", ".join(level.name for level in factor.levels)
            what = "the session" if factor.one_a_session else "practice"
            yield Finding(
                ("factors", i, "order"),
                f"everybody gets {factor.name} in the order {names}, so its effect cannot be "
                f"told from {what}",
                "Write latin or random, unless you do not compare these levels",
            )
        yield from _same(design, i, factor)


def _same(design: Design, i: int, factor: Factor) -> Iterator[Finding]:
    """Yields a finding for two levels with equal trials and equal texts before them."""
    others = [f.name for f in design.factors if f is not factor]
    try:
        trials = {
            (tuple(c[name].name for name in others if name in c), c[factor.name].name): _trial(
                design, c
            )
            for c in combinations(design)
        }
    except HandSandboxError:
        return  # `check_conditions` reports a combination whose settings are refused.
    for a, b in itertools.combinations([level.name for level in factor.levels], 2):
        both = [outer for outer, name in trials if name == a and (outer, b) in trials]
        alike = both and all(trials[outer, a] == trials[outer, b] for outer in both)
        if alike and _read_before(design, factor, a) == _read_before(design, factor, b):
            yield Finding(
                ("factors", i, "levels", [level.name for level in factor.levels].index(b)),
                f"the levels {a} and {b} of {factor.name} have the same settings in every trial",
                "Change one of them, or remove it",
                error=True,
            )


def _trial(design: Design, levels: dict[str, Level]) -> object:
    """All settings of a trial with a combination of levels, defaults included."""
    values = values_of(design, levels)
    if in_the_air(values):
        values = {name: value for name, value in values.items() if name not in OF_TOUCHES}
    devices = [values.get(name) for name in DEVICES]
    return devices, run_settings(values, design.seed % 1000)


def _read_before(design: Design, factor: Factor, level: str) -> list[Text]:
    """Texts that participants read before this level of a factor only."""
    texts = (t for t in design.instructions if t.at == factor.name)
    return [text.text for text in texts if text.level == level]


def _people(design: Design) -> Iterator[Finding]:
    """Yields a finding if the planned participants do not use all orders equally often."""
    missing = confounded(design, design.participants)
    if missing:
        yield Finding(
            ("participants",),
            f"{counted(design.participants, 'participant')} do not fill the "
            f"{whole_cycle(design)} orders ({_uses(design)}), so this is confounded: "
            f"{'; '.join(missing)}",
            f"Write {nearest_cycles(design, design.participants)}, so that each order comes "
            "equally often",
        )


def _uses(design: Design) -> str:
    """How often the orders are used by the planned participants: `1 comes twice, 3 come once`."""
    people, whole = design.participants, whole_cycle(design)
    more = people % whole
    often = people // whole
    few = f"{whole - more} {'comes' if whole - more == 1 else 'come'} {_times(often)}"
    return f"{more} {'comes' if more == 1 else 'come'} {_times(often + 1)}, {few}"


def _times(count: int) -> str:
    return {0: "never", 1: "once", 2: "twice"}.get(count, f"{count} times")


def _practice(design: Design) -> Iterator[Finding]:
    """Yields findings for a level that is measured before it is practised, and for a break between
    practice and the trials that follow it."""
    if unpractised := _unpractised(design):
        factor, level, session = unpractised
        where = f"in session {session}, " if design.sessions > 1 else ""
        yield Finding(
            ("trials", "practice"),
            f"{where}with {counted(design.practice, 'practice trial')}, {level} of {factor} is "
            "measured before anybody has practised it",
            _practice_remedy(design),
        )
    parting = parting_breaks(design, people_of_cycle(design)) if design.practice_each else []
    if parting:
        person, session, trial = parting[0]
        nearest = sorted(
            range(1, design.break_every + FURTHEST), key=lambda n: abs(n - design.break_every)
        )
        fits = next((n for n in nearest if _fits(design, n)), None)
        at = f"session {session}, " if design.sessions > 1 else ""
        yield Finding(
            ("breaks", "every"),
            f"every = {design.break_every} puts a break between practice and its trials "
            f"(participant {person}, {at}after trial {trial})",
            f"Write {fits}, for instance" if fits else "Write another number, or remove [breaks]",
        )


def _fits(design: Design, every: int) -> bool:
    """True if, with breaks after `every` trials, breaks occur, and never right after practice."""
    changed = replace(design, break_every=every)
    some = any(isinstance(step, BreakStep) for step in session_plan(changed, 1))
    return some and not parting_breaks(changed, people_of_cycle(design))


def people_of_cycle(design: Design) -> int:
    """Number of participants whose sessions are examined."""
    return min(design.participants, whole_cycle(design), MOST_PEOPLE)


def parting_breaks(design: Design, people: int) -> list[tuple[int, int, int]]:
    """Breaks right after practice, in the sessions of the first `people` participants.

    Each is (participant, session, number of the trial before the break), all from 1.
    """
    found = []
    for person in range(1, people + 1):
        for session in range(1, design.sessions + 1):
            last: TrialStep | None = None
            for step in session_plan(design, person, session):
                if isinstance(step, BreakStep) and last is not None and last.practice:
                    found.append((person, session, last.number))
                if isinstance(step, TrialStep):
                    last = step
    return found


def _unpractised(design: Design) -> tuple[str, str, int] | None:
    """Factor, level and session of the first trial whose level was not practised before; None if
    there is no such trial."""
    for person in range(1, people_of_cycle(design) + 1):
        practised = set()
        for session in range(1, design.sessions + 1):
            for trial in trials_of(session_plan(design, person, session)):
                for factor, level in trial.levels.items():
                    if trial.practice:
                        practised.add((factor, level))
                    elif (factor, level) not in practised:
                        return factor, level, session
    return None


def _practice_remedy(design: Design) -> str:
    """A change after which every level is practised before it is measured.

    When a level of the innermost factor begins, the levels of all factors are known, so that
    practice has exactly these levels.
    """
    count = "" if design.practice else "practice = 1 and "
    everywhere = ", and remove practice_sessions" if design.practice_sessions else ""
    return f'Write {count}practice_each = "{design.factors[-1].name}"{everywhere}'


def _limits(design: Design, lines: TomlLines) -> Iterator[Finding]:
    """Yields findings for time limits that contradict hold times, expected durations or the limits
    of tasks."""
    tasks = tasks_of(design)
    own = {name: task.time_limit for name, task in tasks.items()}
    limit = min(design.time_limit, *own.values())
    held = {name: task.hold_time for name, task in tasks.items()}
    too_long = {name: time for name, time in held.items() if time >= design.time_limit}
    if too_long:
        names = ", ".join(f"{name} {time:g} s" for name, time in too_long.items())
        yield Finding(
            ("trials", "time_limit_s"),
            "no trial can succeed: a goal must be held for at least as long as the limit, "
            f"{design.time_limit:g} s ({names})",
            f"Write more than {max(too_long.values()):g}",
            error=True,
        )
    elif lines.has(("trials", "expected_s")) and design.expected > limit:
        yield Finding(
            ("trials", "expected_s"),
            f"expected_s = {design.expected:g} is more than the limit, {limit:g}",
            "Write the expected duration of a trial",
        )
    longest = max(own, key=lambda name: own[name])
    if lines.has(("trials", "time_limit_s")) and own[longest] < design.time_limit:
        yield Finding(
            ("trials", "time_limit_s"),
            f"{longest} ends by itself after {own[longest]:g} s, before time_limit_s"
            + (", and other tasks sooner" if len(own) > 1 else ""),
            f"Write {own[longest]:g} or less",
        )


def _never(design: Design, plans: list[list[Step]]) -> Iterator[Finding]:
    """Yields a finding for each form and instruction that no session has, and if no break comes."""
    steps = [step for plan in plans for step in plan]
    forms = {step.form.name for step in steps if isinstance(step, FormStep)}
    texts = [step.instruction for step in steps if isinstance(step, InstructionStep)]
    for i, form in enumerate(design.questionnaires):
        if form.name not in forms:
            yield Finding(
                ("questionnaires", i, "at"),
                f"{form.name} is never asked: with repeat_inside, the levels of {form.at} recur in "
                "each round, so no level has an end",
                f'Write at = "{design.repeat_inside}" or "end", or remove repeat_inside',
                error=True,
            )
    for i, text in enumerate(design.instructions):
        if text not in texts and not text.level:
            yield Finding(
                ("instructions", i, "at"), "no session shows this text", "Write another `at`"
            )
    if design.break_every and not any(isinstance(step, BreakStep) for step in steps):
        yield Finding(
            ("breaks", "every"),
            "no break ever comes: no session has more than "
            f"{counted(design.break_every, 'trial')}, practice not counted",
            "Write a smaller number, or remove [breaks]",
        )


def _lengths(design: Design, plans: list[list[Step]]) -> Iterator[Finding]:
    """Yields a finding if a session, or a part of it without a break, is too long."""
    longest = max(duration(design, plan) for plan in plans)
    stretch = max(_stretch(design, plan) for plan in plans)
    said = f"a session takes about {longest / 60:.0f} min"
    if stretch > LONGEST_STRETCH:
        yield Finding(
            ("breaks", "every") if design.break_every else ("trials", "repetitions"),
            f"{said}; its longest part without a break takes {stretch / 60:.0f} min",
            "Write [breaks] with every = the number of trials in a quarter of an hour",
        )
    elif longest > LONGEST_SESSION:
        yield Finding(
            ("trials", "repetitions"),
            f"{said}, so that the results also depend on weariness",
            "Write fewer repetitions, or several sessions",
        )


def _stretch(design: Design, steps: list[Step]) -> float:
    """Longest expected time without a break, s."""
    longest, since = 0.0, 0
    for i, step in enumerate(steps):
        if isinstance(step, BreakStep):
            longest, since = max(longest, duration(design, steps[since:i])), i + 1
    return max(longest, duration(design, steps[since:]))


def _exclusions(design: Design) -> Iterator[Finding]:
    """Yields a finding for each rule that excludes everything, nothing, or by an outcome."""
    tested = {"success", *(test.outcome for test in planned_tests(design))}
    for i, rule in enumerate(design.exclusions):
        path = ("exclusions", i)
        low, high = _range(design, rule.measure)
        whole = f"values of {rule.measure} are from {low:g} to {high:g}"
        together = [rule, *(o for o in design.exclusions[:i] if _same_measure(o, rule))]
        below = max((r.below for r in together if r.below is not None), default=None)
        above = min((r.above for r in together if r.above is not None), default=None)
        every = [r.name for r in reversed(together)]
        if below is not None and above is not None and above < below:
            yield Finding(
                path,
                f"{' and '.join(every)} exclude every {rule.of}, since every number is below "
                f"{below:g} or above {above:g}",
                "Change the bounds: below is the smaller one",
                error=True,
            )
        elif (rule.below is not None and rule.below > high) or (
            rule.above is not None and rule.above < low
        ):
            yield Finding(
                path, f"{rule.name} excludes every {rule.of}: {whole}", "Change it", error=True
            )
        elif (rule.below is None or rule.below <= low) and (
            rule.above is None or rule.above >= high
        ):
            yield Finding(
                path,
                f"{rule.name} excludes nothing: {whole}",
                "Change the bound or its unit, or remove the rule",
            )
        elif rule.measure in tested and not _quick(design, rule):
            yield Finding(
                path,
                f"{rule.name} excludes by {rule.measure}, which is an outcome, so that hard "
                "conditions lose their bad trials",
                "Remove the rule, or exclude by a measure that is not an outcome, such as away_s",
            )


def _same_measure(one: Exclusion, other: Exclusion) -> bool:
    """True if two rules bound the same measure of the same kind of data."""
    return (one.measure, one.of) == (other.measure, other.of)


def _quick(design: Design, rule: Exclusion) -> bool:
    """True if a rule excludes only times too short for a real attempt."""
    short = rule.below is not None and rule.below <= QUICK * design.expected
    return rule.measure in WITHIN and rule.above is None and short


def _range(design: Design, name: str) -> tuple[float, float]:
    """Smallest and largest value of a measure in this design."""
    measure = find_measure(name, design.own_measure)
    low, high = measure.limits if measure is not None else (-float("inf"), float("inf"))
    return low, min(high, design.time_limit) if name in WITHIN else high
