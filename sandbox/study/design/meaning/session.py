"""Flaws of the course of sessions: durations, breaks, forms, and starts that come again."""

from __future__ import annotations

from collections.abc import Iterator

from models.messages.wording import counted
from sandbox.study.design.conditions import combinations, tasks_of, values_of
from sandbox.study.design.design import END, START, Design, Form
from sandbox.study.design.plan import (
    BreakStep,
    FormStep,
    InstructionStep,
    Step,
    duration,
    session_plan,
)
from sandbox.study.design.questionnaires import instruments
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import Phrases
from sandbox.study.design.toml_lines import TomlLines

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

DONE = Phrases(
    {
        "en": (
            r"(the )?(last|previous|preceding|past) (\w+ )?(trials?|tasks?|block)\b|trials? (that "
            r")?you "
            r"(did|have|just)|you (have )?just (did|done|finished|completed|used|played|worked|"
            r"moved)|"
            r"what you (have )?(just )?(did|done)|(just|now) (done|finished|completed)\b"
        ),
        "de": (
            r"(letzten|vorigen|vorherigen|vergangenen|vorangegangenen) (\w+ )?(durchg|versuch|"
            r"aufgabe|"
            r"block)\w*|(gerade|eben|soeben) (\w+ )?(gemacht|getan|erledigt|bearbeitet|benutzt|"
            r"gespielt|"
            r"beendet|bewegt|geubt)"
        ),
        "fr": (
            r"(dernier|precedent)\w* (essai|tache)\w*|(essais?|taches?|partie) (precedent|que vous "
            r"venez)\w*|vous venez d|ce que vous avez fait"
        ),
        "es": (
            r"(ultim|anterior)\w* (ensayo|tarea|prueba)\w*|(ensayo|tarea|prueba)s? anterior\w*|"
            r"acaba de "
            r"(hacer|realizar|terminar|usar|mover)"
        ),
        "it": r"(ultim|precedent)\w* (prov|compit)\w*|(prov|compit)\w* precedent\w*|ha appena",
        "nl": (
            r"(laatste|vorige|afgelopen|voorgaande) (\w+ )?(taak|taken|poging|proef|proev)\w*|"
            r"zojuist"
        ),
        "pt": r"(ultim|anterior)\w* (ensaio|tarefa|prova)\w*|acabou de|acaba de",
        "zh": r"刚才|刚刚|上一(次|轮|部分|组)",
        "ja": r"先ほど|直前の|たった今",
        "ar": r"المحاولات (السابقة|الأخيرة|الاخيرة)|للتو",
    }
)
"""Questions about trials that are over."""
LAST = Phrases(
    {
        "en": r"(last|previous|preceding) (\w+ )?(trials?|part|block)\b|this (part|block)\b",
        "de": (
            r"(letzten|vorigen|vorherigen|vorangegangenen) (\w+ )?(durchg|teil|block)\w*|"
            r"diese[rnms]? "
            r"(teil|block)(s|es)?\b"
        ),
        "fr": r"(dernier|precedent)\w* (essai|partie|bloc)\w*|cette partie|ce bloc",
        "es": r"(ultim|anterior)\w* (ensayo|parte|bloque)\w*|esta parte|este bloque",
        "it": r"(ultim|precedent)\w* (prov|part|blocc)\w*|questa parte|questo blocco",
        "nl": r"(laatste|vorige|voorgaande) (\w+ )?(poging|deel|blok|proev)\w*|dit (deel|blok)",
    }
)
"""Questions about the last of several parts."""


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
        if early and (form.name in instruments() or _asks(form, DONE)):
            yield Flaw(
                path,
                f"{form.name} asks about what was done, and is asked before anything was done",
                'Write at = "end", or a factor',
            )
        if form.at == END and several and _asks(form, LAST):
            yield Flaw(
                path,
                f"{form.name} asks about the last part alone, and is asked once, after all levels "
                f"of {several[0]}",
                f'Write at = "{several[0]}", or ask about all of it',
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


def _asks(form: Form, phrases: Phrases) -> bool:
    """True if the title or a question of a form has some words."""
    texts = [form.title, *(item.ask for item in form.items)]
    return any(phrases.match(text, code) for some in texts for code, text in some.items())


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
