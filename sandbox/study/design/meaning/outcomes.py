"""Flaws of confirmatory outcomes: not measured, measured twice, or by a clock that goes on."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.conditions import combinations, drawn_tasks, tasks_of, values_of
from sandbox.study.design.design import END, START, Design
from sandbox.study.design.meaning.translations import SPEED
from sandbox.study.design.planned import trials_each
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import (
    GOAL,
    INSTRUCTION,
    Phrases,
    quoted,
    sentences,
    told_texts,
)
from sandbox.study.design.told.words import PRACTICE
from sandbox.study.design.toml_lines import TomlLines
from sandbox.study.measures.measure import LABELS, PLACES
from sandbox.study.measures.registry import find_measure, is_time

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

UNHURRIED = Phrases(
    {
        "en": r"(time|speed) (does not|doesn't|is not|isn't) (matter|important|of importance|"
        r"measured|count)|(time|speed) (is|are) (unimportant|irrelevant)|as slow(ly)? as you|(no|"
        r"not any) (hurry|rush|time pressure)|"
        r"take (all )?your time(?!.*(read|break|question|answer|rest\b|before|between))",
        "de": r"zeit (spielt|ist) (keine rolle|egal|unwichtig|nicht wichtig)|"
        r"(nehmen|lassen) sie sich (alle |so viel )?zeit(?!.*(les|pause|frage|"
        r"bevor|vor (dem|jede)))|"
        r"(keine eile|ohne eile|ohne zeitdruck)",
        "fr": (
            r"(temps|vitesse) (n'est pas|ne compte pas|n'a pas)|prenez (tout )?votre "
            r"temps(?!.*(avant|entre))|sans hate"
        ),
        "es": r"tiempo no (importa|cuenta)|tome(se)? (su|el) tiempo(?!.*(antes|entre))|"
        r"sin prisas?",
        "it": (
            r"tempo non (conta|importa|e importante)|si prenda (tutto )?il (suo )?tempo|"
            r"senza fretta"
        ),
        "nl": r"tijd (is niet belangrijk|doet er niet toe|speelt geen rol)|neem (rustig )?de tijd",
        "zh": r"时间(并)?不(重要|计)|不(用|必)(着急|赶)|慢慢",
        "ja": r"時間は(重要では|関係)|ゆっくり|急(ぐ必要|がなくて)",
    }
)
"""Texts that tell people not to hurry."""


FASTER = Phrases(
    {
        "en": r"(fast\w*|quick\w*|slow\w*|speed)\b",
        "de": r"(schnell\w*|langsam\w*|geschwindigkeit\w*|tempo|zugig\w*)\b",
        "fr": r"(rapid\w*|vite|vitesse|lent\w*)\b",
        "es": r"(rapid\w*|velocidad|lent\w*)\b",
        "it": r"(rapid\w*|veloc\w*|lent\w*)\b",
        "nl": r"(snel\w*|langza\w*|tempo)\b",
        "pt": r"(rapid\w*|velocidade|veloz\w*|lent\w*)\b",
        "zh": r"快|慢|速度",
        "ja": r"速|早|遅",
    }
)
ACCURATE = Phrases(
    {
        "en": r"(accura\w*|precis\w*)\b",
        "de": r"(genau\w*|prazis\w*|treffsicher\w*)\b",
        "fr": r"(precis\w*|exactitude)\b",
        "es": r"(precis\w*|exactitud)\b",
        "it": r"(precis\w*|accurat\w*)\b",
        "nl": r"(nauwkeurig\w*|precies\w*|precisie)\b",
        "pt": r"(precis\w*|exat\w*)\b",
        "zh": r"准确|精确|精度",
        "ja": r"正確|精度",
    }
)
"""Titles that ask for speed, and for accuracy."""
ASKED_BY = {
    "nasa-tlx": ("workload", "belastung", "beanspruchung"),
    "nasa-tlx-raw": ("workload", "belastung", "beanspruchung"),
    "sus": ("usability", "gebrauchstauglichkeit", "utilisabilite", "usabilidad"),
}
"""Whole words for what published questionnaires ask for; of others, their names tell."""
STEM = 4
"""Letters by which `tires` and `tiredness` are one word."""
VAGUE = ("after", "each", "form", "hand", "last", "post", "questions", "rating", "task", "touch")
"""Words in names of questionnaires that say nothing of what they ask for."""
MANY = 6
"""Confirmatory outcomes, of which more are a search and no test; a rule of thumb."""
CLEARED = 10
"""Expected durations of a trial that a time limit may be before nearly all succeed."""


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
    yield from _hurry(design)
    yield from _title(design)
    yield from _untested(design)
    yield from _aside(design)
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


def _hurry(design: Design) -> Iterator[Flaw]:
    """Time is an outcome or speed is asked for, and people are told that it does not matter."""
    timed = [name for name in design.primary if is_time(name)]
    for told in told_texts(design):
        for language, text in told.text.items():
            if told.kind not in (INSTRUCTION, GOAL) or told.at == END:
                continue
            slow = next(
                (
                    s
                    for s in sentences(text)
                    if UNHURRIED.match(s, language) and not PRACTICE.match(s, language)
                ),
                None,
            )
            if slow is not None and timed:
                yield Flaw(
                    told.path,
                    f"{' and '.join(timed)} is the outcome, and people are told that time does not "
                    f"matter: {quoted(slow)}",
                    "Ask for speed, or choose another outcome",
                )
                break
            fast = _fast(design, language) if told.at in ("", START) else None
            if slow is not None and fast is not None:
                yield Flaw(
                    told.path,
                    f"people are told to be quick ({quoted(fast)}), and that time does not matter: "
                    f"{quoted(slow)}",
                    "Ask for one of the two",
                )
                break


def _fast(design: Design, language: str) -> str | None:
    """The first sentence before trials that asks for speed."""
    for told in told_texts(design):
        if told.kind == GOAL or (told.kind == INSTRUCTION and told.at == START):
            for sentence in sentences(told.text[language]):
                asks = SPEED.match(sentence, language)
                if asks and not UNHURRIED.match(sentence, language):
                    return sentence
    return None


def _title(design: Design) -> Iterator[Flaw]:
    """The title asks for speed or accuracy, which no confirmatory outcome measures."""
    if not design.primary:
        return
    units = {measure.unit for name in design.primary if (measure := find_measure(name)) is not None}
    asked = [
        (name, phrases)
        for name, phrases in (("speed", FASTER), ("accuracy", ACCURATE))
        if any(phrases.match(design.title, language) for language in design.languages)
    ]
    measured = {
        "speed": "m/s" in units or any(is_time(name) for name in design.primary),
        "accuracy": bool(units & {"m", "deg", "0/1", "0 to 1"}) or "success" in design.primary,
    }
    for name, _ in asked:
        if not measured[name] and len(asked) == 1:
            yield Flaw(
                ("analysis", "primary"),
                f"the title asks for {name}, and {_joined(design)} does not measure it",
                "Choose an outcome that answers the title's question"
                + (", such as time_s" if name == "speed" else ", such as placement_error_m"),
            )


def _untested(design: Design) -> Iterator[Flaw]:
    """A factor that the title names, and a questionnaire that is asked at another one."""
    forms = {form.name: form for form in design.questionnaires}
    if not design.primary or any(name not in forms for name in design.primary):
        return
    tested = {forms[name].at for name in design.primary}
    title = re.findall(r"\w+", plain(f"{design.title} {design.name}"))
    for factor in design.factors:
        if all(set(level.settings) == {"task"} for level in factor.levels):
            # Several tasks are often there to generalise over.
            continue
        named = [level.name for level in factor.levels if plain(level.name) in title]
        stem = plain(factor.name)
        titled = len(named) > 1 or any(word.startswith(stem) for word in title)
        if titled and len(factor.levels) > 1 and factor.name not in tested:
            asked = " and ".join(sorted(tested))
            yield Flaw(
                ("analysis", "primary"),
                f"the title names {factor.name}, and {' and '.join(design.primary)} is asked at "
                f"{asked}, so that no outcome is compared between levels of {factor.name}",
                f'Write at = "{factor.name}", or choose another outcome',
            )


def _aside(design: Design) -> Iterator[Flaw]:
    """The title names what a questionnaire asks for, and only other outcomes are tested."""
    several = {factor.name for factor in design.factors if len(factor.levels) > 1}
    title = re.findall(r"[^\W\d_]{4,}", plain(design.title))
    named = plain(" ".join((*several, *design.primary, *VAGUE)).replace("-", " ")).split()
    known = {word[:STEM] for word in named}
    for form in design.questionnaires:
        if not design.primary or form.name in design.primary or form.at not in several:
            continue
        asked = ASKED_BY.get(form.name, ())
        own = () if asked else re.findall(r"[^\W\d_]{4,}", plain(form.name))
        stems = {word[:STEM] for word in own} - known
        told = next((word for word in title if word in asked or word[:STEM] in stems), None)
        if told is not None:
            yield Flaw(
                ("analysis", "primary"),
                f"the title speaks of {told}, which {form.name} asks for, and only "
                f"{_joined(design)} is tested",
                f'Add "{form.name}" if its score answers the question, or change the title',
            )
            return


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
