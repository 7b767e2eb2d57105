"""Checks of a design without mistakes of form, by its numbers and its structure.

They look at balance, levels, practice, durations, breaks, numbers of people, outcomes, exclusions,
scales and languages. What sentences mean is not checked.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from models.errors import HandSandboxError
from models.message import counted
from sandbox.study.design.balance import confounded, nearest_cycles, whole_cycle
from sandbox.study.design.conditions import (
    PARTNER,
    combinations,
    differences,
    drawn_tasks,
    run_settings,
    sets_nothing,
    tasks_of,
    values_of,
)
from sandbox.study.design.design import END, START, Design, Exclusion, Factor, Form, Item, Level
from sandbox.study.design.plan import (
    BreakStep,
    FormStep,
    InstructionStep,
    Step,
    TrialStep,
    duration,
    session_plan,
    trials_of,
)
from sandbox.study.design.planned import family_size, planned_tests, trials_each
from sandbox.study.design.power import people_needed, power
from sandbox.study.design.questionnaires import instruments
from sandbox.study.design.reading import Mistake, Text
from sandbox.study.design.scoring import Scale
from sandbox.study.design.toml_lines import Path, TomlLines
from sandbox.study.measures.measure import LABELS, PLACES
from sandbox.study.measures.measures import BUILT_IN
from sandbox.study.measures.registry import find_measure, is_time
from sandbox.words.words import LANGUAGES, base, words_of_studies

LONGEST_SESSION = 5400.0
"""s; a rule of thumb: after an hour and a half, weariness is measured."""
LONGEST_STRETCH = 1800.0
"""s without a break, also a rule of thumb."""
REST = (5.0, 900.0)
"""s; limits of a break that rests people and does not send them away."""
LONGEST_IN_AIR = 900.0
"""s without a break of a hand that nothing supports, a rule of thumb as well."""
OFTEN = 15
"""Times that people answer one form, or read one text, in a session; a rule of thumb, too."""
CUT = 0.8
"""Share of the time limit that a trial may be expected to take; of longer ones, many are cut."""

MOST_FOR_PRACTICE = 12
"""People whose sessions are looked through, of a longer cycle."""
FURTHEST = 12
"""Largest change of the number of trials between breaks that is tried for a remedy."""

DEVICES = ("device", "second_device", "webcam", "leap_at")
"""Settings of the real devices, which settings of a trial do not tell apart."""
OF_TOUCHES = {"encoder", "labels"}
"""Settings of how touches become a hand; one that a device sees in the air needs neither."""
FEWEST = 2
"""People in a group of which a spread can be told."""
UNEVEN = 0.5
"""Share by which a level may be more or less often at a place than on average, by chance."""
MOST_PEOPLE = 200
"""People whose random orders are counted; by chance, those of more are even enough."""

LARGE = 0.8
"""Standard deviations; a large effect by the convention of Cohen 1988."""
HOPELESS = 1 / 3
"""Probability of finding it, below which a study says next to nothing."""
ALPHA = 0.05

SAME = (
    ("success", "held", "instant", "final", "progress", "first_attempt_success"),
    ("time_s", "completion_s"),
    ("nasa-tlx", "nasa-tlx-raw"),
    ("drops", "regrasps", "grasps"),
)
"""Outcomes that say nearly the same."""
DEAD = {
    "lost_s": "it is 0 on a fast machine",
    "throughput_se_bit_s": "it is the standard error of throughput",
    "throughput_bias_bit_s": "it is the bias of throughput",
    **{f"latency_p{p}_ms": "it is the delay of the program" for p in (50, 95, 99)},
}
"""Measures that are no outcome."""
MOVES = 3
"""Successful trials of one combination of levels in one session, from which throughput comes."""
MANY = 6
"""Confirmatory outcomes, of which more are a search and no test; a rule of thumb."""
CLEARED = 10
"""Expected durations of a trial that a time limit may be before nearly all succeed."""

NAMED = 4
"""Number of missing words that a warning names."""

COPIED = 15
"""Letters of a text that is not the same in two languages by chance."""
_NUMBER = re.compile(r"(?<![\w.,])\d+(?:[.,]\d+)?")

OUTCOMES = (
    "success",
    "held",
    "instant",
    "final",
    "progress",
    "first_attempt_success",
    "completion_s",
)
"""Measures of the outcome; a rule that looks at one of them selects on it."""
TROUBLE = ("away_s", "away", "lost_s", "latency_p50_ms", "latency_p95_ms", "latency_p99_ms")
"""Measures of what went wrong, which are small in good trials."""
TIMES = ("time_s", "completion_s")
"""Outcomes that may have a bound below, for touches by accident."""
QUICK = 0.5
"""Share of the expected duration, below which many good trials are."""
WITHIN = ("time_s", "completion_s", "first_contact_s", "first_push_s")
"""Times within a trial, which its time limit ends."""
SIGNED = ("palm_sparc", "object_sparc", "move_error_m")
"""Measures that may be below 0."""
LONGEST = {"s": 900.0, "ms": 60_000.0, "m": 10.0, "m/s": 20.0, "deg": 180.0, "bit/s": 100.0}
"""Largest number that people can reach, by unit."""
PLACED, TABLE = ("placement_error_m", "move_amplitude_m", "move_error_m"), 1.0
"""Distances on the surface, and its size in metres."""
LEAST_DELAY = 1.0
"""Milliseconds; a bound above that is smaller than that was meant in seconds."""


@dataclass(frozen=True)
class Flaw:
    """Something that is right in form and misleads.

    Attributes:
        path: Place in the design file.
        what: What is wrong.
        remedy: What to do about it.
        error: True if the study cannot give results as it is.
    """

    path: Path
    what: str
    remedy: str
    error: bool = False


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
    yield from detection_flaws(design)
    yield from outcome_flaws(design)
    yield from consent_flaws(design)
    yield from announcement_flaws(design)
    yield from answer_flaws(design)
    yield from scale_flaws(design)
    yield from language_flaws(design)
    yield from translation_flaws(design)
    yield from joint_flaws(design)
    for i, rule in enumerate(design.exclusions):
        yield from exclusion_flaws(design, ("exclusions", i), rule)


def session_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of all sessions."""
    yield from _times(design)
    plans = [session_plan(design, 0, n + 1) for n in range(design.sessions)]
    yield from _lengths(design, plans)
    yield from _forms(design, plans)
    if design.sessions > 1 and design.seeds == "shared":
        yield Flaw(
            ("trials", "seeds"),
            "starts and goals of all sessions are the same, so that a later one measures what is "
            "remembered of them, too",
            'Write seeds = "own"',
        )


def _times(design: Design) -> Iterator[Flaw]:
    holds = {name: task.hold_time for name, task in tasks_of(design).items()}
    too_long = {task: hold for task, hold in holds.items() if hold >= design.time_limit}
    if too_long:
        names = ", ".join(f"{task} {hold:g} s" for task, hold in too_long.items())
        yield Flaw(
            ("trials", "time_limit_s"),
            f"no trial can succeed: the limit is {design.time_limit:g} s, and the goal must be "
            f"held for ({names})",
            f"Write more than {max(too_long.values()):g}",
            error=True,
        )
    elif design.expected <= max(holds.values()):
        task = max(holds, key=lambda name: holds[name])
        yield Flaw(
            ("trials", "expected_s"),
            f"{design.expected:g} s is too short: the goal of {task} must be held for "
            f"{holds[task]:g} s",
            "Write the expected duration of a trial",
        )
    elif design.expected > design.time_limit:
        yield Flaw(
            ("trials", "expected_s"),
            f"{design.expected:g} s is more than the time limit, {design.time_limit:g} s",
            "Write the expected duration of a trial, below time_limit_s",
        )
    elif design.expected > CUT * design.time_limit:
        yield Flaw(
            ("trials", "time_limit_s"),
            f"a trial is expected to take {design.expected:g} s and ends at {design.time_limit:g} "
            "s, so that many are cut off before they succeed",
            f"Write {design.expected / CUT:.3g} or more; twice as long as expected is usual",
        )
    else:
        yield from _own_limits(design)


def _own_limits(design: Design) -> Iterator[Flaw]:
    """Tasks that end by their own limit before a trial is expected to be over."""
    if not TomlLines(design.text).has(("trials", "expected_s")):
        return
    limits = {name: task.time_limit for name, task in tasks_of(design).items()}
    short = {name: limit for name, limit in limits.items() if design.expected > CUT * limit}
    if short:
        names = ", ".join(f"{name} after {limit:g} s" for name, limit in short.items())
        yield Flaw(
            ("trials", "expected_s"),
            f"a trial is expected to take {design.expected:g} s, and tasks end by their own limits "
            f"({names})",
            "Write a shorter duration, or choose another task",
        )


def _forms(design: Design, plans: list[list[Step]]) -> Iterator[Flaw]:
    """Forms and instructions that come too early, too often, or for some levels only."""
    several = [
        factor.name
        for factor in design.factors
        if len(factor.levels) > 1 and factor.order != "between" and not factor.one_a_session
    ]
    apart = {factor.name for factor in design.factors if factor.one_a_session}
    for i, form in enumerate(design.questionnaires):
        path = ("questionnaires", i)
        early = form.at == START and (not form.sessions or 1 in form.sessions)
        if early and form.name in instruments():
            yield Flaw(
                path,
                f"{form.name} asks about what was done, and is asked before anything was done",
                'Write at = "end", or a factor',
            )
        if form.at in apart and form.sessions and len(form.sessions) < design.sessions:
            yield Flaw(
                path,
                f"{form.name} is asked about some levels of {form.at} only, since each session has "
                "another one",
                "Remove `sessions`",
            )
        often = max(
            sum(isinstance(s, FormStep) and s.form.name == form.name for s in plan)
            for plan in plans
        )
        if not often and form.at in several and design.repeat_inside:
            yield Flaw(
                path,
                f"{form.name} is never asked: with repeat_inside, levels of {form.at} come again "
                "in each round and have no end",
                f'Write at = "{design.repeat_inside}" or "end", or remove repeat_inside',
                error=True,
            )
        if often > OFTEN:
            yield Flaw(
                path,
                f"{form.name} is asked {often} times in a session, so that people answer without "
                "reading",
                "Ask it at an outer factor, or at the end",
            )
    for i, instruction in enumerate(design.instructions):
        some = instruction.sessions and len(instruction.sessions) < design.sessions
        if instruction.at in apart and some:
            yield Flaw(
                ("instructions", i),
                f"only some levels of {instruction.at} are announced, since each session has "
                "another one",
                "Remove `sessions`",
            )
        often = max(
            sum(isinstance(s, InstructionStep) and s.instruction == instruction for s in plan)
            for plan in plans
        )
        if often > OFTEN:
            yield Flaw(
                ("instructions", i),
                f"it is shown {often} times in a session, so that nobody reads it",
                "Show it at an outer factor, or at the start",
            )
    told = any(text.at != END and 1 in (text.sessions or (1,)) for text in design.instructions)
    if not told and not {"task", "goal"} & set(design.page.shows):
        yield Flaw(
            ("trials", "shows"),
            "nobody is told what to do: there are no instructions, and the goal is not shown",
            'Add "goal", or [[instructions]]',
        )


def _lengths(design: Design, plans: list[list[Step]]) -> Iterator[Flaw]:
    if design.break_every and not any(isinstance(s, BreakStep) for plan in plans for s in plan):
        yield Flaw(
            ("breaks", "every"),
            "no break ever comes: no session has more than "
            f"{counted(design.break_every, 'trial')} without practice",
            "Write a smaller number, or remove [breaks]",
        )
    elif design.break_every and not REST[0] <= design.break_time <= REST[1]:
        short = design.break_time < REST[0]
        yield Flaw(
            ("breaks", "least_s"),
            f"{design.break_time:g} s are {'no rest' if short else 'longer than people wait'}",
            "Write 30 to 120; the unit is seconds",
        )
    longest = max(duration(design, plan) for plan in plans)
    if longest > LONGEST_SESSION:
        yield Flaw(
            ("trials", "repetitions"),
            f"a session takes {longest / 60:.0f} min, so that weariness is measured, too",
            "Write fewer repetitions, or several sessions",
        )
    stretch = max(_stretch(design, plan) for plan in plans)
    if stretch > (LONGEST_IN_AIR if _in_air(design) else LONGEST_STRETCH):
        yield Flaw(
            ("breaks", "every"),
            f"{stretch / 60:.0f} min come without a break"
            + (", with the hand in the air" if _in_air(design) else ""),
            "Write [breaks] with every = a number of trials of a quarter of an hour"
            + (" or less" if _in_air(design) else ""),
        )


def _in_air(design: Design) -> bool:
    """True if hands are held in the air in all trials."""
    every = (values_of(design, levels) for levels in combinations(design))
    return all(values.get("device", "touch") != "touch" for values in every)


def _stretch(design: Design, steps: list[Step]) -> float:
    """Longest expected time without a break, s."""
    longest, since = 0.0, 0
    for i, step in enumerate(steps):
        if isinstance(step, BreakStep):
            longest, since = max(longest, duration(design, steps[since:i])), i + 1
    return max(longest, duration(design, steps[since:]))


def practice_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of practice."""
    if not design.practice:
        yield Flaw(
            ("trials", "practice"),
            "nobody practises, so that the first trials measure how the program is learnt",
            "Write practice = 2 or more; practice trials are left out of the results",
        )
    elif design.practice_sessions and 1 not in design.practice_sessions:
        yield Flaw(
            ("trials", "practice_sessions"),
            "nobody practises in the first session",
            "Add 1, or remove the line",
        )
    elif unpractised := _unpractised(design):
        factor, level, session = unpractised
        late = session > 1 and bool(design.practice_sessions)
        where = f"in session {session}, " if design.sessions > 1 else ""
        yield Flaw(
            ("trials", "practice_sessions" if late else "practice"),
            f"{where}{level} of {factor} is measured before anybody has practised it, and other "
            "levels are practised",
            f"Add {session}, or remove the line"
            if late
            else f'Write practice_each = "{factor}", or more practice trials',
        )

    yield from _breaks_after_practice(design)


def _breaks_after_practice(design: Design) -> Iterator[Flaw]:
    """Breaks between practice and the trials that it is for."""
    people = _people(design)
    if not design.practice_each or not design.break_every or not parting_breaks(design, people):
        return
    nearest = sorted(range(1, design.break_every + FURTHEST), key=_distance(design.break_every))
    fits = next((n for n in nearest if _fits(design, n)), None)
    yield Flaw(
        ("breaks", "every"),
        f"a break comes between the practice of a level of {design.practice_each} and its trials, "
        "so that what was practised is measured after a rest",
        f"Write {fits}, for instance; `sandbox study plan` says where breaks come"
        if fits
        else "Write another number, or remove [breaks]",
    )


def _distance(number: int) -> Callable[[int], int]:
    return lambda other: abs(other - number)


def _fits(design: Design, every: int) -> bool:
    """True if breaks come after so many trials, and never right after practice."""
    other = replace(design, break_every=every)
    some = any(isinstance(step, BreakStep) for step in session_plan(other, 0))
    return some and not parting_breaks(other, _people(design))


def _people(design: Design) -> int:
    """Number of participants whose sessions are looked through."""
    return min(design.participants, whole_cycle(design), MOST_FOR_PRACTICE)


def parting_breaks(design: Design, people: int) -> list[tuple[int, int, int]]:
    """Breaks right after practice, in the sessions of the first so many participants: participant,
    session, and number of the trial before the break, each from 1."""
    found = []
    for person in range(people):
        for session in range(1, design.sessions + 1):
            last: TrialStep | None = None
            for step in session_plan(design, person, session):
                if isinstance(step, BreakStep) and last is not None and last.practice:
                    found.append((person + 1, session, last.number))
                if isinstance(step, TrialStep):
                    last = step
    return found


def _unpractised(design: Design) -> tuple[str, str, int] | None:
    """Factor, level and session of a trial whose level was not practised; None if all are."""
    for person in range(_people(design)):
        practised = set()
        for session in range(1, design.sessions + 1):
            for trial in trials_of(session_plan(design, person, session)):
                for factor, level in trial.levels.items():
                    if trial.practice:
                        practised.add((factor, level))
                    elif (factor, level) not in practised:
                        return factor, level, session
    return None


def comparison_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of all factors."""
    for i, factor in enumerate(design.factors):
        yield from _levels(design, i, factor)
        if len(factor.levels) > 1:
            yield from _order(design, i, factor)
    yield from _set_twice(design)
    missing = confounded(design, design.participants)
    if missing:
        yield Flaw(
            ("participants",),
            f"{counted(design.participants, 'person', 'people')} make no full cycle, so this is "
            "confounded: " + "; ".join(missing),
            f"Write {nearest_cycles(design, design.participants)}",
        )


def _levels(design: Design, i: int, factor: Factor) -> Iterator[Flaw]:
    path = ("factors", i, "levels")
    if len(factor.levels) == 1:
        yield Flaw(
            path,
            f"{factor.name} has one level, {factor.levels[0].name}, so nothing is compared",
            "Add a level, or move the setting to [settings]",
        )
        return
    pairs = {}
    unread = _unread(design, factor)
    if unread:
        yield unread
    for a, b in itertools.combinations(factor.levels, 2):
        given = differences(design, a, b)
        effects = _effects(design, factor, a, b, given)
        effective = [n for n in given if any(n in found for _, found in effects)]
        pairs[a.name, b.name] = effective
        if not given and not _told_apart(design, factor, a, b):
            yield Flaw(
                path,
                f"{a.name} and {b.name} are the same: they set the same values",
                "Change one of them, or remove it",
            )
        elif given and not effective and not unread:
            yield Flaw(
                path,
                f"{a.name} and {b.name} are the same: of {' and '.join(given)}, one sets what is "
                "so by default, or what does nothing here",
                "Change one of them, or remove it",
            )
        elif effective and not unread:
            for where in _without_effect(design, factor, effects):
                yield Flaw(
                    path,
                    f"{a.name} and {b.name} are the same where {where.outer} is {where.level}: "
                    f"what they set ({', '.join(given)}) does nothing there",
                    f'Write {factor.name} after {where.outer}, with inside = "{where.outer}" and '
                    f"one of these levels alone for {where.level}, or compare something else",
                )
    alone = _mixed(pairs)
    if alone is not None:
        a_name, b_name, given = alone
        yield Flaw(
            path,
            f"levels of {factor.name} differ in several settings at once ({a_name} and {b_name} in "
            f"{' and '.join(given)}), so it cannot be told which of them makes a difference",
            "Make a factor of each setting, unless they are compared as wholes",
        )
    yield from _apart(design, path, factor)


def _mixed(pairs: dict[tuple[str, str], list[str]]) -> tuple[str, str, list[str]] | None:
    """A level that differs from each other one in several settings, and the one nearest to it."""
    names = dict.fromkeys(name for pair in pairs for name in pair)
    for name in names:
        own = {pair: given for pair, given in pairs.items() if name in pair}
        if all(len(given) > 1 for given in own.values()):
            (a, b), given = min(own.items(), key=lambda one: len(one[1]))
            return a, b, given
    return None


def _told_apart(design: Design, factor: Factor, a: Level, b: Level) -> bool:
    """True if people are told other things before two levels: then words are what is compared."""
    texts = {
        name: [t.text for t in design.instructions if t.at == factor.name and t.level == name]
        for name in (a.name, b.name)
    }
    return texts[a.name] != texts[b.name]


Effects = list[tuple[dict[str, Level], list[str]]]
"""Combinations with one of two levels, each with the settings that change its trials."""


def _effects(design: Design, factor: Factor, a: Level, b: Level, given: list[str]) -> Effects:
    """Which of the settings that differ between two levels change a trial, by combination.

    A setting changes nothing if one level sets what is so by default.
    """
    every = [c for c in combinations(design) if c[factor.name].name == a.name]
    if not every or factor.nested is not None:
        return [({}, given)]
    return [(c, _effective(design, factor, a, b, given, c)) for c in every]


def _effective(
    design: Design, factor: Factor, a: Level, b: Level, given: list[str], one: dict[str, Level]
) -> list[str]:
    """Those of the settings that change a trial of one combination."""
    outside = values_of(design, {n: level for n, level in one.items() if n != factor.name})
    try:
        whole = run_settings(outside | b.settings, design.seed % 1000)
        return [
            name
            for name in given
            if name in DEVICES
            or run_settings(_with(outside, a, b, name), design.seed % 1000) != whole
        ]
    except HandSandboxError:
        return given


class _Where(NamedTuple):
    outer: str
    level: str


def _without_effect(design: Design, factor: Factor, effects: Effects) -> list[_Where]:
    """Levels of other factors with which two levels of a factor are always the same."""
    found = []
    for other in design.factors:
        if other is factor:
            continue
        for level in other.levels:
            those = [some for c, some in effects if other.name in c and c[other.name] == level]
            if those and not any(those):
                found.append(_Where(other.name, level.name))
    return found


def _unread(design: Design, factor: Factor) -> Flaw | None:
    """Levels that set how touches are read, with hands in the air, which have none."""
    given = {name for level in factor.levels for name in level.settings}
    if not given <= OF_TOUCHES:
        return None
    devices: dict[bool, set[str]] = {True: set(), False: set()}
    for levels in combinations(design):
        values = values_of(design, levels)
        used = [values.get("device", "touch"), values.get("second_device", PARTNER)]
        real = [device for device in used if device != PARTNER]
        devices["touch" in real].update(real)
    if not devices[False]:
        return None
    in_air = " and ".join(sorted(devices[False]))
    return Flaw(
        ("factors", design.factors.index(factor), "levels"),
        f"the levels of {factor.name} are the same with device {in_air}: only touches are read by "
        + " and ".join(sorted(given)),
        'Write device = "touch", or compare something else'
        if not devices[True]
        else "Compare them by touch alone",
    )


def _with(outside: dict[str, Any], a: Level, b: Level, name: str) -> dict[str, Any]:
    """Settings of a trial with level `b`, of which one setting is that of level `a`."""
    values = {n: v for n, v in (outside | b.settings).items() if n != name}
    given = (outside | a.settings).get(name)
    return values if given is None else {**values, name: given}


def _apart(design: Design, path: Path, factor: Factor) -> Iterator[Flaw]:
    """Levels of a nested factor that never occur in the same level of the outer one."""
    if factor.nested is None or len(factor.levels) < 2:
        return
    lists = [[level.name for level in levels] for levels in factor.nested.values()]
    if all(len(names) == 1 for names in lists):
        yield Flaw(
            path,
            f"{factor.name} has one level in each level of {factor.outer}, so that the two cannot "
            "be told apart",
            f"Give every level of {factor.outer} the same levels",
        )
        return
    together = {frozenset(pair) for names in lists for pair in itertools.combinations(names, 2)}
    shared = any(sum(level.name in names for names in lists) > 1 for level in factor.levels)
    for a, b in itertools.combinations([level.name for level in factor.levels], 2):
        if shared and frozenset((a, b)) not in together:
            yield Flaw(
                path,
                f"{a} and {b} never occur in the same level of {factor.outer}, so that their "
                f"difference cannot be told from that of {factor.outer}",
                f"Give every level of {factor.outer} the same levels, or do not compare these",
            )
            return


def _order(design: Design, i: int, factor: Factor) -> Iterator[Flaw]:
    path = ("factors", i, "order")
    if factor.order == "blocked":
        what = "the session in which it comes" if factor.one_a_session else "practice"
        yield Flaw(
            path,
            f"everybody has the levels of {factor.name} in the same order, so its effect "
            f"cannot be told from {what}",
            "Write latin or random, unless you do not compare these levels",
        )
    elif factor.order == "between" and design.participants < FEWEST * len(factor.levels):
        yield Flaw(
            path,
            f"{counted(design.participants, 'person', 'people')} in {len(factor.levels)} groups: "
            f"what a level of {factor.name} does cannot be told from who met it",
            f"Write participants = {FEWEST * len(factor.levels)} or many more, or order latin",
        )
    elif factor.order == "random" and design.participants <= MOST_PEOPLE:
        uneven = _by_chance(design, factor)
        if uneven:
            yield Flaw(
                path,
                f"by chance, with this seed, {uneven}, so that {factor.name} is confounded with "
                "practice",
                "Write latin, or let more people take part",
            )


def _by_chance(design: Design, factor: Factor) -> str:
    """Unevenness of the random orders of a factor, in words; empty if they are even enough."""
    outer = [f.name for f in design.factors[: design.factors.index(factor)]]
    firsts: Counter[str] = Counter()
    total = 0
    for number in range(design.participants):
        seen: dict[tuple[str, ...], str] = {}
        for trial in trials_of(session_plan(design, number)):
            if not trial.practice:
                block = tuple(trial.levels[name] for name in outer)
                seen.setdefault(block, trial.levels[factor.name])
        firsts.update(seen.values())
        total += len(seen)
    if factor.nested is not None or total < len(factor.levels):
        return ""
    expected = total / len(factor.levels)
    for level in factor.levels:
        if abs(firsts[level.name] - expected) >= UNEVEN * expected:
            return f"{level.name} comes first in {firsts[level.name]} of {total} orders"
    return ""


def _set_twice(design: Design) -> Iterator[Flaw]:
    """Settings that two factors set: the inner one wins, and the outer one does nothing."""
    for (_, outer), (i, inner) in itertools.combinations(enumerate(design.factors), 2):
        both = {n for x in outer.levels for n in x.settings} & {
            n for x in inner.levels for n in x.settings
        }
        for name in sorted(both):
            yield Flaw(
                ("factors", i, "levels"),
                f"{name} is set by {outer.name}, too, and the inner factor wins: {outer.name} does "
                "not do what its levels say",
                f"Set {name} in one of the two",
                error=all(set(level.settings) == {name} for level in outer.levels),
            )


def detection_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the number of people, by the planned tests of the design: one line."""
    tests = planned_tests(design)
    family = family_size(tests)
    chances = {}
    for test in tests:
        people = test.people_in(design.participants)
        chances[test.factor.name] = power(LARGE, people, ALPHA / family, test.between)
    poor = {name: chance for name, chance in chances.items() if chance < HOPELESS}
    if not poor:
        return
    names, best = " and ".join(poor), max(poor.values())
    first = next(test for test in tests if test.factor.name in poor)
    needed = people_needed(LARGE, family, first.between)
    enough = f"{first.participants_for(needed)}" if needed else "many more"
    yield Flaw(
        ("participants",),
        f"{counted(design.participants, 'person', 'people')} can find even a large effect of "
        f"{names} ({LARGE:g} standard deviations) with probability "
        f"{max(best, 0.01):.2f} at most, in {family} "
        f"{'tests' if family > 1 else 'test'}",
        f"Write participants = {enough} or more"
        + (", or fewer outcomes in [analysis] primary" if family > 1 else "")
        + "; see `plan --power`",
    )


def outcome_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of outcomes."""
    path = ("analysis", "primary")
    for group in SAME:
        both = [name for name in design.primary if name in group]
        if len(both) > 1:
            yield Flaw(
                path,
                f"{' and '.join(both)} say nearly the same, and each makes the others' tests "
                f"stricter",
                f"Choose one of them, such as {both[0]}",
            )
    every = [values_of(design, levels) for levels in combinations(design)]
    touched = all(values.get("device", "touch") == "touch" for values in every)
    for name in design.primary:
        measure = find_measure(name)
        if measure is not None and measure.tasks == LABELS and touched:
            yield Flaw(
                path,
                f"{name} is empty for people on a touch screen, which does not tell which finger "
                "touches",
                "Choose another outcome; it is known for simulated users",
            )
        if name == "waited_s" and design.page.starts == "shown":
            yield Flaw(
                path,
                'waited_s is 0 in every trial: with starts = "shown", time begins with the scene',
                'Write starts = "touch", or choose first_contact_s, the time to the first contact',
            )
        if name == "first_contact_s" and design.page.starts == "touch":
            yield Flaw(
                path,
                'first_contact_s is 0 in every trial: with starts = "touch", time begins with it',
                'Choose waited_s, the time before the first touch, or write starts = "shown"',
            )
        if name in DEAD:
            yield Flaw(
                path,
                f"{name} tells how well the machine ran, and nothing of people: {DEAD[name]}",
                "Choose another outcome; use it in [[exclusions]]",
            )
        if name.startswith("throughput") and design.repetitions < MOVES:
            yield Flaw(
                path,
                f"{name} is empty: it takes {MOVES} successful trials of a combination of levels "
                f"in "
                f"a session, and there are {design.repetitions}",
                f"Write repetitions = {2 * MOVES} or more",
            )
    if len(design.primary) > MANY:
        yield Flaw(
            path,
            f"{len(design.primary)} outcomes are confirmatory, and each makes the others' tests "
            "stricter",
            "Choose the one or two that the question is about; the report shows the others as "
            "exploratory",
        )
    yield from _places(design)
    yield from _untouched(design)
    yield from _once(design)
    yield from _clock(design)
    yield from _ceiling(design)


def _places(design: Design) -> Iterator[Flaw]:
    """Movements to a goal are measured, and a task has several goals, or none."""
    measured = [
        name
        for name in design.primary
        if (measure := find_measure(name)) is not None and measure.tasks == PLACES
    ]
    for task, drawn in drawn_tasks(design).items() if measured else ():
        if len(drawn.goals) != 1:
            yield Flaw(
                ("analysis", "primary"),
                f"{' and '.join(measured)} is empty in {task}, which has {len(drawn.goals)} goals "
                "and not one",
                "Choose another outcome or task",
            )


def _untouched(design: Design) -> Iterator[Flaw]:
    """Nothing can be moved by a hand that passes through everything."""
    from tasks.registry import is_built_in

    if not all(is_built_in(task) for task in tasks_of(design).values()):
        return
    if design.settings.get("contact") == "none":
        yield Flaw(
            ("settings", "contact"),
            "no trial can succeed: with contact none, the hand passes through everything",
            "Write hard or soft",
            error=True,
        )
    for i, factor in enumerate(design.factors):
        none = [level.name for level in factor.levels if level.settings.get("contact") == "none"]
        if none:
            yield Flaw(
                ("factors", i, "levels"),
                f"no trial of {none[0]} can succeed: with contact none, the hand passes through "
                "everything",
                "Remove the level",
            )


def _once(design: Design) -> Iterator[Flaw]:
    """Each level is done once by each person, so that one slip decides."""
    forms = {form.name for form in design.questionnaires}
    stated = TomlLines(design.text).has(("trials", "repetitions"))
    if not stated or (design.primary and set(design.primary) <= forms):
        return
    for factor in design.factors:
        if len(factor.levels) > 1 and trials_each(design, factor) == 1:
            yield Flaw(
                ("trials", "repetitions"),
                f"each person does one trial with a level of {factor.name}, so one slip decides",
                "Write repetitions = 3 or more",
            )
            return


def _clock(design: Design) -> Iterator[Flaw]:
    """Time goes on while the page is away, and counts."""
    timed = [name for name in design.primary if is_time(name)] or (
        [] if design.primary else ["time_s"]
    )
    removed = any(rule.measure in ("away_s", "away") for rule in design.exclusions)
    if design.page.when_gone == "mark" and timed and not removed:
        yield Flaw(
            ("trials", "when_gone"),
            f"time goes on while the page is gone, and counts in {' and '.join(timed)}",
            'Write when_gone = "pause" or "repeat", or exclude trials by away_s',
        )


def _ceiling(design: Design) -> Iterator[Flaw]:
    """Success is the only outcome, and there is time enough for everybody to succeed."""
    if not design.primary or not set(design.primary) <= set(SAME[0]) - {"progress"}:
        return
    lines = TomlLines(design.text)
    stated = all(lines.has(("trials", key)) for key in ("time_limit_s", "expected_s"))
    if stated and design.time_limit >= CLEARED * design.expected:
        yield Flaw(
            ("trials", "time_limit_s"),
            f"a trial is expected to take {design.expected:g} s and may take "
            f"{design.time_limit:g} s, so that nearly all succeed, and {_joined(design)} "
            "can show no difference",
            f"Write a shorter limit, such as {2 * design.expected:g}, or take time_s as an outcome",
        )


def _joined(design: Design) -> str:
    return " and ".join(design.primary)


def consent_flaws(design: Design) -> Iterator[Flaw]:
    """A study whose participants are not asked for their consent."""
    if not design.consent:
        yield Flaw(
            ("consent",),
            "participants are not asked for their consent",
            'Add [consent] with text = "..."',
        )


def announcement_flaws(design: Design) -> Iterator[Flaw]:
    """Texts before some levels of a factor only, so that words are part of the comparison."""
    for factor in design.factors:
        texts = [(i, t) for i, t in enumerate(design.instructions) if t.at == factor.name]
        told = {t.level for _, t in texts if t.level}
        rest = [level.name for level in factor.levels if level.name not in told]
        if told and rest and not sets_nothing(design, factor) and factor.name not in (START, END):
            first = next(i for i, t in texts if t.level)
            yield Flaw(
                ("instructions", first),
                f"of the levels of {factor.name}, only {', '.join(sorted(told))} is announced, not "
                f"{', '.join(rest)}, so its effect cannot be told from that of the words",
                "Write as much before the other levels, or one text without `level`",
            )


def scale_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the scales of questionnaires, one line for each cause."""
    for path, form in _asked_forms(design):
        items = {item.name: item for item in form.items}
        for i, scale in enumerate(form.scales):
            used = [items[name] for name in scale.items]
            place = (*path, "scales", i)
            yield from _ranges(place, scale, used)
            yield from _pairs(place, scale, items)


def _ranges(path: Path, scale: Scale, items: list[Item]) -> Iterator[Flaw]:
    """Answers of unlike ranges: the widest one decides the score."""
    spans = {item.name: item.high - item.low for item in items}
    if len(set(spans.values())) > 1 and any(item.kind == "scale" for item in items):
        widest, least = max(items, key=_span), min(items, key=_span)
        yield Flaw(
            (*path, "items"),
            f"{widest.name} goes from {widest.low:g} to {widest.high:g}, and {least.name} from "
            f"{least.low:g} to {least.high:g}, so that the score of {scale.name} is mostly that of "
            f"{widest.name}",
            "Give all items the same low and high, or make a scale of each",
        )


def _pairs(path: Path, scale: Scale, items: dict[str, Item]) -> Iterator[Flaw]:
    """Weights from comparisons in which some items occur more often than others."""
    if not scale.pairs:
        return
    met = Counter(name for pair in scale.pairs for name in items[pair].choices)
    most, least = max(scale.items, key=lambda n: met[n]), min(scale.items, key=lambda n: met[n])
    if met[most] != met[least]:
        yield Flaw(
            (*path, "pairs"),
            f"{most} is in {met[most]} comparisons of {scale.name}, and {least} in "
            f"{met[least]}, so that their weights are no fair ones",
            "Compare every item with each other one, once",
        )


def _span(item: Item) -> float:
    return item.high - item.low


def answer_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of all questions, one line for each question."""
    for path, item in _asked_items(design):
        wrong = _of_meanings(item)
        if wrong is not None:
            yield Flaw(path, *wrong)
    yield from _twice(design)


def _asked_items(design: Design) -> Iterator[tuple[Path, Item]]:
    """All questions of demographics and questionnaires."""
    for i, item in enumerate(design.demographics):
        yield ("demographics", i), item
    for path, form in _asked_forms(design):
        for j, item in enumerate(form.items):
            yield (*path, "items", j), item


def _asked_forms(design: Design) -> Iterator[tuple[Path, Form]]:
    """All questionnaires."""
    for i, form in enumerate(design.questionnaires):
        yield ("questionnaires", i), form


def _of_meanings(item: Item) -> tuple[str, str] | None:
    """Answers that cannot be told from each other, or that mean nothing."""
    if item.kind == "scale":
        if item.ends is None:
            if not any(re.search(r"\d", text) for text in item.ask.values()):
                return (
                    f"nobody is told what {item.low:g} and {item.high:g} of {item.name} mean",
                    'Write low_means = "..." and high_means = "..."',
                )
        elif any(text and text == item.ends[0][code] for code, text in item.ends[1].items()):
            return (
                f"both ends of {item.name} have the same words",
                "Change low_means or high_means",
            )
    for language in item.means[0] if item.means else ():
        texts = Counter(means[language].casefold().strip() for means in item.means)
        text, count = texts.most_common(1)[0]
        if text and count > 1:
            return (
                f"two choices of {item.name} are both called {text!r} in {language}",
                "Give each choice a text of its own",
            )
    return None


def _twice(design: Design) -> Iterator[Flaw]:
    """Questions that a form asks twice."""
    groups: list[tuple[Path, tuple[Item, ...]]] = [(("demographics",), design.demographics)]
    groups += [((*path, "items"), form.items) for path, form in _asked_forms(design)]
    for path, items in groups:
        seen: dict[tuple[str, ...], str] = {}
        for i, item in enumerate(items):
            # Pairs of a weighted scale all have the same question.
            if item.kind == "choice":
                continue
            text = tuple(text.casefold() for text in item.ask.values())
            if text in seen and any(text):
                yield Flaw(
                    (*path, i),
                    f"{item.name} asks the same as {seen[text]}",
                    "Change its text, or remove it",
                )
            seen.setdefault(text, item.name)


def language_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of a design's languages."""
    for code in design.languages:
        own = design.page.words.get(code, {})
        missing = [key for key in words_of_studies() if key not in own]
        if base(code) not in LANGUAGES and missing:
            some = ", ".join(missing[:NAMED]) + (", ..." if len(missing) > NAMED else "")
            yield Flaw(
                ("words", code) if own else ("languages",),
                f"the page has no words in {code}, and {len(missing)} of them would be in English: "
                f"{some}",
                f"Write them in [words.{code}]; sandbox/words/en.json has them all",
            )
    foreign = [code for code in design.languages if base(code) != "en"]
    if foreign and len(design.languages) > 1:
        for path, item in _asked_items(design):
            if item.choices and not item.means:
                yield Flaw(
                    path,
                    f"the choices of {item.name!r} are read as they are stored in every language: "
                    f"{', '.join(item.choices)}",
                    "Write means = [...], with a text in each language for every choice",
                )


def translation_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of texts in several languages, the first of them for each text."""
    for path, text in _texts(design):
        wrong = next(_differences(text), None)
        if wrong is not None:
            what, remedy = wrong
            yield Flaw(path, what, remedy)


def _texts(design: Design) -> Iterator[tuple[Path, Text]]:
    """All texts that participants read."""
    if design.consent:
        yield ("consent", "text"), design.consent
    for i, instruction in enumerate(design.instructions):
        yield ("instructions", i, "text"), instruction.text
    for i, goal in enumerate(design.page.goals.values()):
        yield ("tasks", i, "goal"), goal
    for i, form in enumerate(design.questionnaires):
        yield ("questionnaires", i, "title"), form.title
    for path, item in _asked_items(design):
        yield (*path, "ask"), item.ask


def _differences(text: Text) -> Iterator[tuple[str, str]]:
    """Texts that are the same in two languages, or have other numbers."""
    written = [(language, words) for language, words in text.items() if words.strip()]
    pairs = ((written[0], other) for other in written[1:])
    for (a, text_a), (b, text_b) in (p for p in pairs if base(p[0][0]) != base(p[1][0])):
        if text_a.strip() == text_b.strip() and len(text_a.strip()) >= COPIED:
            yield f"the text is the same in {a} and {b}", f"Translate it, in {b} or in {a}"
            return
        numbers = [
            sorted(float(n.replace(",", ".")) for n in _NUMBER.findall(t)) for t in (text_a, text_b)
        ]
        if all(numbers) and set(numbers[0]) != set(numbers[1]):
            said = [", ".join(f"{n:g}" for n in some) for some in numbers]
            yield (
                f"the numbers differ: {said[0]} in {a}, {said[1]} in {b}",
                "Write the same numbers in all languages",
            )


def joint_flaws(design: Design) -> Iterator[Flaw]:
    """Rules that exclude everything together, though none of them does alone."""
    for i, one in enumerate(design.exclusions):
        for other in design.exclusions[:i]:
            low, high = (one, other) if one.below is not None else (other, one)
            alike = (one.measure, one.of) == (other.measure, other.of)
            if not alike or low.below is None or high.above is None or high.above >= low.below:
                continue
            if low.above is None and high.below is None:
                yield Flaw(
                    ("exclusions", i),
                    f"{other.name} and {one.name} exclude everything together: every number is "
                    f"below {low.below:g} or above {high.above:g}",
                    "Change one of the bounds",
                    error=True,
                )


def exclusion_flaws(design: Design, path: Path, rule: Exclusion) -> Iterator[Flaw]:
    """Flaws of one rule."""
    low, high = _range(design, rule.measure)
    below, above = rule.below, rule.above
    if below is not None and above is not None and above < below:
        yield Flaw(
            path,
            f"{rule.name} excludes everything: every number is below {below:g} or above {above:g}",
            "Exchange the bounds: below is the smaller one",
            error=True,
        )
    elif (below is not None and below > high) or (above is not None and above < low):
        yield Flaw(
            path,
            f"{rule.name} excludes everything: {rule.measure} is from {low:g} to {high:g}",
            "Change the bound",
            error=True,
        )
    elif (below is None or below <= low) and (above is None or above >= high):
        yield Flaw(
            path,
            f"{rule.name} excludes nothing: {rule.measure} is from {low:g} to {high:g}"
            + _unit(rule.measure),
            "Change the bound or its unit, or remove the rule; trials end at time_limit_s, and the "
            "report counts them",
        )
    elif rule.measure in TROUBLE and below is not None and below > 0:
        yield Flaw(
            path,
            f"{rule.name} leaves out good trials: {rule.measure} is small in them, and "
            f"trials below {below:g} are left out",
            f"Write above = {below:g}",
        )
    elif above is not None and above < LEAST_DELAY and _unit(rule.measure) == " ms":
        yield Flaw(
            path,
            f"{rule.name} excludes nearly everything: {rule.measure} is in milliseconds, and every "
            f"trial is above {above:g}",
            f"Write above = {1000 * above:g}, if {above:g} s is meant",
        )
    elif rule.measure in OUTCOMES:
        who = "trials" if rule.of == "trial" else "people"
        yield Flaw(
            path,
            f"{rule.name} selects on the outcome: it leaves out {who} because of {rule.measure}",
            "Remove the rule; the report takes trials without success into account. Choose a "
            "measure that says nothing of how well people did, such as away_s",
        )
    elif rule.measure in design.primary and rule.measure not in TIMES:
        yield Flaw(
            path,
            f"{rule.name} selects on the outcome: {rule.measure} is confirmatory",
            "Remove the rule, or choose a measure that is no outcome, such as away_s",
        )
    elif rule.measure == "time_s" and below is not None and below > QUICK * design.expected:
        yield Flaw(
            path,
            f"{rule.name} leaves out good trials: a trial is expected to take {design.expected:g} "
            f"s, "
            f"and those below {below:g} s are left out",
            "Write a bound that nobody can reach, such as 0.5; the unit is seconds",
        )
    elif rule.measure == "time_s" and above is not None:
        yield Flaw(
            path,
            f"{rule.name} selects on the outcome: it leaves out what takes long",
            "Remove the bound above; time_limit_s ends long trials, and the report counts them",
        )


def _range(design: Design, measure: str) -> tuple[float, float]:
    """Smallest and largest value that a measure can have."""
    known = find_measure(measure)
    if measure == "progress" or (known is not None and known.unit in ("0/1", "0 to 1")):
        return 0.0, 1.0
    if measure == "waited_s" and design.page.starts == "shown":
        return 0.0, 0.0
    if measure in WITHIN:
        return 0.0, design.time_limit
    if known is None or known not in BUILT_IN:
        return float("-inf"), float("inf")
    most = TABLE if measure in PLACED else LONGEST.get(known.unit, float("inf"))
    return -most if measure in SIGNED else 0.0, most


def _unit(measure: str) -> str:
    """Unit of a measure after a number; empty if it has none."""
    known = find_measure(measure)
    return f" {known.unit}" if known is not None and known.unit in LONGEST else ""
