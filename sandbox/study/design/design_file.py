"""Reads `design.toml` and reports all mistakes in it."""

from __future__ import annotations

import re
import tomllib
from difflib import get_close_matches
from hashlib import blake2b
from pathlib import Path
from typing import Any

from models.errors import InputError, StudyError
from sandbox.study.design.balance import MOST_FACTORIAL
from sandbox.study.design.conditions import check_conditions, setting_types
from sandbox.study.design.design import (
    DEMOGRAPHICS,
    FILLED,
    Design,
    Exclusion,
    Factor,
    Form,
    Instruction,
    Level,
    PageSettings,
)
from sandbox.study.design.fields import END, JOINED, LISTED, SCHEMA, SHOWS, START
from sandbox.study.design.questionnaires import read_form, read_item, scored_by_its_question
from sandbox.study.design.reading import DesignError, Mistake, Reader, TomlLines, TomlTable
from sandbox.study.measures.measures import (
    REMOVED,
    Measure,
    all_measures,
    load_measure,
    rule_measures,
)
from sandbox.trial.settings import PipelineSettings
from sandbox.words import RESULT, values_of, words_in, words_of_studies


def load_design(path: Path, try_out: bool = True) -> Design:
    """Reads a design; see `parse_design`.

    Raises:
        DesignError: The file has mistakes; the error lists all of them, with line and remedy.
        StudyError: The file cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise StudyError(
            "the design cannot be read",
            where=str(path),
            got=error.strerror,
            remedy="`sandbox study new FILE` creates a design",
        ) from None
    except UnicodeDecodeError as error:
        raise StudyError(
            "the design is not UTF-8 text",
            where=str(path),
            got=str(error),
            remedy="Save it in UTF-8 with a text editor",
        ) from None
    return parse_design(text, path, try_out)


def parse_design(text: str, path: Path, try_out: bool = True) -> Design:
    """Parses the text of a design file.

    Args:
        text: The whole text.
        path: Path of the file.
        try_out: True also checks every combination of levels, and refuses names that tables and
            reports cannot use. False only parses the file, for a study that has begun.

    Raises:
        DesignError: The file has mistakes.
    """
    try:
        values = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        at = re.search(r"line (\d+)", str(error))
        line = int(at[1]) if at else TomlLines(text).last
        raise DesignError(
            path.name,
            [
                Mistake(
                    line,
                    "",
                    str(error),
                    "Check for a missing quote, bracket or =; toml.io describes the format",
                )
            ],
        ) from None
    reader = Reader(text)
    reader.begun = not try_out
    design = _design(TomlTable(reader, values), text, path)
    if try_out:
        _check_names(design, reader)
    complete = not try_out or not reader.mistakes
    if try_out and complete:
        check_conditions(design, reader)
    if reader.mistakes:
        raise DesignError(path.name, reader.mistakes, complete)
    return design


def _design(top: TomlTable, text: str, path: Path) -> Design:
    schema = top.raw("schema", SCHEMA)
    if schema != SCHEMA:
        top.add_mistake("schema", f"got {schema!r}", f"This version reads schema {SCHEMA}")
    sessions = top.number("sessions")
    top.reader.sessions = sessions
    languages = top.strings("languages") or ("en",)
    top.reader.languages = languages
    factors = _factors(top)
    names = [factor.name for factor in factors]
    trials, breaks, consent = top.table("trials"), top.table("breaks"), top.table("consent")
    analysis = top.table("analysis")
    forms = tuple(read_form(t, names, path.parent) for t in top.tables("questionnaires"))
    named = analysis.strings("primary") if analysis.has("primary") else None
    own, own_source = _own_measure(analysis, path.parent)
    # If `primary` names a questionnaire with one question for a number, its answer is the score.
    forms = tuple(scored_by_its_question(f) if f.name in (named or ()) else f for f in forms)
    design = Design(
        name=top.name("name"),
        title=_title(top, languages),
        seed=top.number("seed"),
        participants=top.number("participants"),
        sessions=sessions,
        languages=languages,
        settings=_settings(top.table("settings")),
        factors=factors,
        repetitions=trials.number("repetitions"),
        repeat_inside=_factor(trials, "repeat_inside", names),
        practice=trials.number("practice"),
        practice_each=_factor(trials, "practice_each", names),
        practice_sessions=trials.session_numbers("practice_sessions"),
        seeds=trials.choice("seeds"),
        learning=trials.choice("learning"),
        time_limit=float(trials.number("time_limit_s")),
        expected=float(trials.number("expected_s")),
        break_every=breaks.number("every"),
        break_time=float(breaks.number("least_s")),
        page=_page_settings(top, trials),
        consent=consent.text("text") if consent.has("text") else {},
        consent_version=consent.string("version"),
        instructions=tuple(_instruction(t, factors) for t in top.tables("instructions")),
        demographics=tuple(read_item(t) for t in top.tables("demographics")),
        questionnaires=forms,
        exclusions=tuple(_exclusion(t, own) for t in top.tables("exclusions")),
        primary=_primary(analysis, forms, named, own),
        own_measure=own,
        own_source=own_source,
        digest=_digest(text, forms, own_source),
        text=text,
        path=path,
    )
    _check_learning(design, trials)
    for table in (trials, breaks, consent, analysis, top):
        table.done()
    top.check_names(DEMOGRAPHICS, [item.name for item in design.demographics])
    top.check_names("questionnaires", [form.name for form in design.questionnaires])
    return design


def _digest(text: str, forms: tuple[Form, ...], own: tuple[str, str] | None) -> str:
    """Digest of the design, its questionnaire files, and the file of the study's own measure."""
    digest = blake2b(text.encode(), digest_size=16)
    sources = {form.source for form in forms if form.source} | ({own} if own else set())
    for name, content in sorted(sources):
        digest.update(b"\0" + name.encode() + b"\0" + content.encode())
    return digest.hexdigest()


def _check_learning(design: Design, trials: TomlTable) -> None:
    common = str(design.settings.get("labels", PipelineSettings.labels))
    used = {common}
    for factor in design.factors:
        given = {str(level.settings.get("labels", common)) for level in factor.levels}
        if given != {common}:
            used = given
    if design.learning == "session" and "population" not in used:
        trials.add_mistake(
            "learning",
            f"{design.learning!r} has no effect: no trial has labels that learn layouts",
            'Write labels = "population" in [settings]',
        )


_TAG = re.compile(r"[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*")
"""Form of a language tag (BCP 47) that browsers accept."""


def _check_names(design: Design, reader: Reader) -> None:
    """Refuses language tags of a wrong form, and names that are ambiguous in tables and reports.

    Three kinds of names are ambiguous: a question about the person with the name of a column that
    the program fills; a questionnaire with the name of the form about the person; and a level whose
    name contains a separator. A study that has begun with such names can still be opened.
    """
    for code in design.languages:
        if not _TAG.fullmatch(code):
            reader.add_mistake(
                ("languages",),
                f"{code!r} is not a language tag",
                "Write letters and hyphens, such as pt-BR",
            )
    for i, item in enumerate(design.demographics):
        if item.name in FILLED:
            reader.add_mistake(
                (DEMOGRAPHICS, i, "name"),
                f"{item.name!r} is a column of participants that the program fills",
                f"Choose another name, such as own_{item.name}",
            )
    for i, form in enumerate(design.questionnaires):
        if form.name == DEMOGRAPHICS:
            reader.add_mistake(
                ("questionnaires", i, "name"),
                f"{form.name!r} is the name of the questions about the person",
                "Choose another name",
            )
    for i, factor in enumerate(design.factors):
        for level in factor.levels:
            sign = next((sign for sign in (LISTED, JOINED) if sign in level.name), "")
            if sign:
                reader.add_mistake(
                    ("factors", i, "levels"),
                    f"{level.name!r} contains {sign!r}, which separates names in tables and "
                    "reports",
                    'Give the level a name without it: {name = "...", ...}',
                )


def _factor(table: TomlTable, key: str, names: list[str]) -> str:
    given = table.has(key)
    name = table.string(key)
    if given and name not in names:
        table.add_mistake(key, f"unknown factor {name!r}", f"Write one of {', '.join(names)}")
        return ""
    return name


def _settings(table: TomlTable) -> dict[str, Any]:
    given = {name: (table.has(name), table.raw(name)) for name in setting_types()}
    table.done()
    return {name: value for name, (there, value) in given.items() if there}


def _nearest_setting(name: str) -> str:
    """Remedy for an unknown setting: the setting with the most similar name, or all settings."""
    known = setting_types()
    near = get_close_matches(name, known, 1)
    return f"Did you mean {near[0]}?" if near else "Settings are: " + ", ".join(known)


def _title(top: TomlTable, languages: tuple[str, ...]) -> str:
    """The title, in the first language if it has several; participants do not see it."""
    given = top.raw("title", "")
    if isinstance(given, dict):
        return TomlTable(top.reader, {"title": given}).text("title")[languages[0]]
    return TomlTable(top.reader, {"title": given}).string("title", "")


def _page_settings(top: TomlTable, trials: TomlTable) -> PageSettings:
    """Reads the settings of the page.

    Args:
        top: The design, from which `[[tasks]]` is taken.
        trials: The table `[trials]` of the design.
    """
    shows = trials.strings("shows")
    for unknown in sorted(set(shows) - set(SHOWS)):
        trials.add_mistake("shows", f"got {unknown!r}", f"Choose among {', '.join(SHOWS)}")
    starts = trials.choice("starts")
    if "demo" in shows and starts != "touch":
        trials.add_mistake(
            "shows",
            f"a demonstration lasts until the first touch, but starts is {starts!r}",
            'Leave out "demo", or write starts = "touch"',
        )
    names, goals = {}, {}
    for table in top.tables("tasks"):
        task = table.string("task")
        names[task], goals[task] = table.text("name"), table.text("goal")
        table.done()
    return PageSettings(shows, starts, trials.choice("when_gone"), names, goals, _read_words(top))


def _read_words(top: TomlTable) -> dict[str, dict[str, str]]:
    """Reads the table `[words]`, which has an inner table for each language."""
    table, english = top.table("words"), words_in("en")
    words: dict[str, dict[str, str]] = {}
    for language in top.reader.languages:
        if not table.has(language):
            continue
        given = table.table(language)
        taken = {key: given.string(key, "") for key in words_of_studies((RESULT,))}
        words[language] = {key: text for key, text in taken.items() if text}
        for key, text in words[language].items():
            if values_of(text) != values_of(english[key]):
                wanted = ", ".join(f"{{{name}}}" for name in sorted(values_of(english[key])))
                given.add_mistake(
                    key,
                    f"the placeholders of {english[key]!r} are {wanted or 'none'}",
                    "Use exactly these placeholders",
                )
        given.done()
    table.done()
    return words


def _factors(top: TomlTable) -> tuple[Factor, ...]:
    tables = top.tables("factors")
    factors: list[Factor] = []
    for table in tables:
        factors.append(_read_factor(table, factors))
    top.check_names("factors", [factor.name for factor in factors])
    if not tables:
        top.add_mistake("", "no factor is given", "Add [[factors]] with name, order and levels")
    return tuple(factors)


def _read_factor(table: TomlTable, outer_ones: list[Factor]) -> Factor:
    name = table.name("name")
    setting = table.string("setting", name)
    order = table.choice("order")
    outer = table.string("inside")
    raw = table.raw("levels")
    nested: dict[str, tuple[Level, ...]] | None = None
    if outer:
        above = next((f for f in outer_ones if f.name == outer), None)
        wanted = [level.name for level in above.levels] if above else []
        if above is None:
            table.add_mistake(
                "inside", f"unknown factor {outer!r}", "Write the name of a factor above this one"
            )
        elif not isinstance(raw, dict) or set(raw) != set(wanted):
            table.add_mistake(
                "levels",
                f"every level of {outer} needs its own list of levels",
                f"Write levels = {{{', '.join(f'{w} = [...]' for w in wanted)}}}",
            )
        else:
            nested = {k: _levels(table, v, setting) for k, v in raw.items()}
        if order == "between":
            table.add_mistake(
                "order", "a nested factor cannot vary between participants", "Choose another order"
            )
        lists = list(nested.values()) if nested else []
        levels = tuple({level.name: level for some in lists for level in some}.values())
    else:
        levels = _levels(table, raw, setting)
        lists = [levels]
    one_a_session = table.flag("one_a_session")
    if one_a_session:
        _check_level_a_session(table, bool(outer_ones), bool(outer), order, len(levels))
    if order == "factorial" and max(map(len, lists), default=0) > MOST_FACTORIAL:
        table.add_mistake(
            "order",
            f"{len(levels)} levels are too many for order factorial",
            f"Use latin, or at most {MOST_FACTORIAL} levels",
        )
    table.done()
    return Factor(name, order, levels, outer, nested, one_a_session)


def _check_level_a_session(
    table: TomlTable, inner: bool, nested: bool, order: str, count: int
) -> None:
    sessions = table.reader.sessions
    if inner or nested:
        table.add_mistake(
            "one_a_session",
            "only the outermost factor can have one level a session",
            "Move it to the top of the factors",
        )
    elif order == "between":
        table.add_mistake(
            "one_a_session",
            "with order between, a participant has the same level in all sessions",
            "Choose another order, or remove one_a_session",
        )
    elif count != sessions:
        table.add_mistake(
            "one_a_session",
            f"{count} levels do not match sessions = {sessions}",
            f"Write sessions = {count} at the top, or remove one_a_session",
        )


def _levels(table: TomlTable, raw: Any, setting: str) -> tuple[Level, ...]:
    if not isinstance(raw, list) or not raw:
        table.add_mistake(
            "levels", "levels are missing", 'Write a list such as levels = ["a", "b"]'
        )
        return ()
    levels = []
    for value in raw:
        if isinstance(value, dict):
            settings = dict(value)
            name = settings.pop("name", "")
            if not isinstance(name, str) or not name or not settings:
                table.add_mistake(
                    "levels", f"got {value!r}", 'Write {name = "soft", contact = "soft"}'
                )
                continue
        else:
            name, settings = str(value), {setting: value}
        unknown = sorted(set(settings) - set(setting_types()))
        if unknown:
            table.add_mistake(
                "levels" if isinstance(value, dict) else "setting",
                f"unknown setting {unknown[0]!r}",
                _nearest_setting(unknown[0]),
            )
            if not isinstance(value, dict):
                return ()
            continue
        levels.append(Level(name, settings))
    if len({level.name for level in levels}) < len(levels):
        table.add_mistake(
            "levels", "a level is listed twice", "Remove one of them, or give them different names"
        )
    return tuple(levels)


def _instruction(table: TomlTable, factors: tuple[Factor, ...]) -> Instruction:
    at = table.choice("at", (START, END, *(f.name for f in factors)))
    level = table.string("level")
    names = next(([x.name for x in f.levels] for f in factors if f.name == at), [])
    if level and level not in names:
        table.add_mistake(
            "level",
            f"unknown level {level!r} of {at}",
            f"Levels: {', '.join(names)}" if names else "Set `at` to a factor",
        )
    instruction = Instruction(table.text("text"), at, level, table.session_numbers("sessions"))
    table.done()
    return instruction


def _primary(
    table: TomlTable, forms: tuple[Form, ...], named: tuple[str, ...] | None, own: Measure | None
) -> tuple[str, ...]:
    """Names of the confirmatory outcomes: measures, and questionnaires for their scores.

    Args:
        table: The table `analysis`; mistakes are added to it.
        forms: All questionnaires.
        named: Outcomes that its key `primary` names; None without this key.
        own: The study's own measure.
    """
    names = named or ()
    known = ("time_s", "success", *(m.name for m in all_measures(own) if not m.words))
    scored = {form.name: form for form in forms if form.scales}
    between = [name for name, form in scored.items() if form.at not in (START, END)]
    if named is not None and not names:
        table.add_mistake(
            "primary", "the list is empty", "Name an outcome, or remove it to test all of them"
        )
    # A questionnaire whose file cannot be read has no items. That mistake is already reported.
    unread = {form.name for form in forms if not form.items}
    for name in names:
        if name in known or name in between or name in unread:
            continue
        if name in scored:
            what = f"{name} is asked once, so its score is not compared"
            remedy = f"Ask {name} at a factor, after each of its levels, or remove it here"
        elif name in {form.name for form in forms}:
            what = f"{name} has several questions and no score"
            in_file = next(form.source for form in forms if form.name == name) is not None
            where = "[[scales]] in its file" if in_file else "[[questionnaires.scales]]"
            remedy = (
                f"Give {name} a scale, {where} (docs/studies.md), or remove it here; the report "
                "describes its answers without a test"
            )
        else:
            what = f"unknown outcome {name!r}"
            near = get_close_matches(name, (*known, *between), 1)
            hint = f"Did you mean {near[0]}? " if near else ""
            choice = ", ".join(("time_s", "success", *between))
            remedy = f"{hint}Write {choice} or a measure (docs/measures.md){_gone(name)}"
        table.add_mistake("primary", what, remedy)
    return names


def _gone(name: str) -> str:
    """End of a remedy for a removed measure: what replaces it; empty for any other name."""
    if name not in REMOVED:
        return ""
    return f"; {name} was removed, and {REMOVED[name]} takes its place"


def _own_measure(table: TomlTable, folder: Path) -> tuple[Measure | None, tuple[str, str] | None]:
    """The study's own measure, and (name, text) of its file; both None without one."""
    place = table.string("own_measure")
    if not place:
        return None, None
    try:
        measure = load_measure(place, folder)
        name = place.rpartition(":")[0]
        return measure, (name, (folder / name).read_text(encoding="utf-8"))
    except (InputError, OSError, UnicodeDecodeError) as error:
        table.add_mistake("own_measure", str(error), 'Write own_measure = "FILE.py:NAME"')
        return None, None


def _exclusion(table: TomlTable, own: Measure | None) -> Exclusion:
    known = rule_measures(own)
    measure = table.string("measure")
    if measure and measure not in known:
        near = get_close_matches(measure, known, 1)
        hint = f"Did you mean {near[0]}? " if near else ""
        choice = f"{hint}Write one of {', '.join(known)}{_gone(measure)}"
        table.add_mistake("measure", f"got {measure!r}", choice)
    exclusion = Exclusion(
        table.name("name"),
        table.choice("of"),
        measure,
        _bound(table, "below"),
        _bound(table, "above"),
    )
    if exclusion.below is None and exclusion.above is None:
        table.add_mistake("", "the rule needs a bound", "Add below = NUMBER or above = NUMBER")
    table.done()
    return exclusion


def _bound(table: TomlTable, key: str) -> float | None:
    if not table.has(key):
        table.raw(key)
        return None
    return float(table.number(key))
