"""Questionnaires: reads them from the design, from a file next to it, or from this package, and
computes their scores.

Scores follow from answers by the rules of the scales. If an answer is missing, the score has no
value, only the number of missing answers. Missing answers are not imputed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from models.arithmetic import total
from sandbox.study.design.design import Form, Item, Scale
from sandbox.study.design.fields import END, SCHEMA, START, WORDINGS
from sandbox.study.design.reading import Mistake, Reader, Text, TomlTable


def instruments() -> dict[str, str]:
    """Texts of the questionnaires in the package, by name."""
    folder = files("sandbox.study.design").joinpath("instruments")
    texts = {
        entry.name.removesuffix(".toml"): entry.read_text(encoding="utf-8")
        for entry in folder.iterdir()
        if entry.name.endswith(".toml")
    }
    return dict(sorted(texts.items()))


def read_form(table: TomlTable, factors: list[str], folder: Path) -> Form:
    """Reads a questionnaire of a design.

    Its key `use` names a questionnaire of this package, `file` a questionnaire in a file.

    Args:
        table: Table of the questionnaire in the design.
        factors: Names of the factors, which are possible values of `at`.
        folder: Folder of the design.
    """
    use, file = table.string("use"), table.string("file")
    name = table.name("name") if not use or table.has("name") else use
    at = table.choice("at", (START, END, *factors))
    sessions = table.session_numbers("sessions")
    if use and file:
        table.add_mistake("file", "`use` is given as well", "Remove one of the two")
    if use or file:
        _refuse_own_items(table, use or file)
    text = _packaged(table, use) if use else _form_text(table, file, folder) if file else None
    source = _as_table(table, text, file) if text is not None else None if use or file else table
    if source is None:
        # The mistake in the file has been reported already.
        table.raw("title")
        table.done()
        return Form(name, {}, (), at)
    title = source.text("title")
    if source is not table and table.has("title"):
        title = table.text("title")
    every = source.values("every_item")
    items = tuple(read_item(t) for t in source.tables("items", every))
    if not items:
        source.add_mistake(
            "items", "the questionnaire has no items", "Add [[questionnaires.items]], or a file"
        )
    source.check_names("items", [item.name for item in items])
    scales = tuple(_scale(t, items) for t in source.tables("scales"))
    if not table.reader.begun:
        source.check_names("scales", [scale.name for scale in scales])
    wording = _wording(source)
    if source is not table:
        source.done()
        remedy = "Copy it to a file and translate it there" if use else "Correct that file"
        for cause in _causes(source.reader.mistakes):
            table.add_mistake("use" if use else "file", f"{use or file}, {cause}", remedy)
    table.done()
    origin = (file, text) if file and text else None
    return Form(name, title, items, at, scales, origin, sessions, wording)


def _refuse_own_items(table: TomlTable, name: str) -> None:
    """Refuses `items` and `scales` in a table whose `use` or `file` already provides them."""
    for key in ("items", "scales"):
        if table.has(key):
            table.raw(key)
            table.add_mistake(
                key,
                f"{name} has its own {key}",
                f"Remove these {key}, or move them to another [[questionnaires]] with its own name",
            )


def scored_by_its_question(form: Form) -> Form:
    """The form; without a scale and with exactly one question for a number, that number is its
    score."""
    numbers = [item for item in form.items if item.kind in ("scale", "number")]
    if form.scales or len(numbers) != 1:
        return form
    (item,) = numbers
    scale = Scale(item.name, "mean", (item.name,), ((item.low, item.high),))
    return replace(form, scales=(scale,))


def _causes(mistakes: list[Mistake]) -> list[str]:
    """One line for each different mistake, so that a language missing everywhere gives one line."""
    by_cause: dict[str, list[Mistake]] = {}
    for mistake in mistakes:
        by_cause.setdefault(mistake.what, []).append(mistake)
    return [
        str(some[0])
        if len(some) == 1
        else f"{what} in {len(some)} places, from line {some[0].line} on"
        for what, some in by_cause.items()
    ]


def read_item(table: TomlTable) -> Item:
    """Reads a question."""
    name, ask = table.name("name"), table.text("ask")
    kind = table.choice("kind")
    choices = _choices(table)
    low = float(table.number("low"))
    high = float(table.number("high"))
    step = float(table.number("step"))
    if kind == "choice" and len(choices) < 2:
        table.add_mistake(
            "choices", "a choice needs two or more values", 'Write choices = ["yes", "no"]'
        )
    if kind in ("scale", "number") and not low < high:
        table.add_mistake("low", f"{low:g} is not below {high:g}", "Swap low and high")
    elif kind == "scale" and (Fraction(repr(high)) - Fraction(repr(low))) % Fraction(repr(step)):
        table.add_mistake(
            "step",
            f"steps of {step:g} from {low:g} do not reach {high:g}",
            "Change step or high, so that high is a possible answer",
        )
    ends = (table.text("low_means"), table.text("high_means")) if table.has("low_means") else None
    means = _means(table, choices)
    optional, shuffle = table.flag("optional"), table.flag("shuffle")
    table.done()
    return Item(name, kind, ask, choices, low, high, step, ends, optional, means, shuffle)


def arranged(form: Form, seed: int) -> Form:
    """Returns a form in the order of one participant.

    Items with `shuffle` come in random order among their neighbours with `shuffle`, and their
    choices in random order. All other items stay in their places.

    Args:
        form: The form of the design.
        seed: Seed, which depends on the participant and the step.
    """
    if not any(item.shuffle for item in form.items):
        return form
    rng = np.random.default_rng(seed)
    items: list[Item] = []
    run: list[Item] = []
    for item in (*form.items, None):
        if item is not None and item.shuffle:
            run.append(item)
            continue
        items += [_shuffled(run[i], rng) for i in rng.permutation(len(run))]
        run = []
        if item is not None:
            items.append(item)
    return replace(form, items=tuple(items))


def _shuffled(item: Item, rng: np.random.Generator) -> Item:
    order = rng.permutation(len(item.choices))
    return replace(
        item,
        choices=tuple(item.choices[i] for i in order),
        means=tuple(item.means[i] for i in order) if item.means else (),
    )


def _choices(table: TomlTable) -> tuple[str, ...]:
    """Stored values of a choice, which are the same in all languages."""
    given = table.raw("choices", [])
    if not isinstance(given, list) or not any(isinstance(choice, dict) for choice in given):
        return _item_table(table, choices=given).strings("choices")
    values = [
        next(iter(choice.values()), "") if isinstance(choice, dict) else choice for choice in given
    ]
    texts = ", ".join(f'{code} = "..."' for code in table.reader.languages)
    stored = ", ".join(f'"{value}"' for value in values)
    table.add_mistake(
        "choices",
        "choices must be the same in all languages, but these are translated",
        f"Write choices = [{stored}], and means = [{{{texts}}}, ...] with a text for each choice",
    )
    return tuple(str(value) for value in values)


def _item_table(table: TomlTable, **values: Any) -> TomlTable:
    """A table with only the given values, at the path of a question."""
    return TomlTable(table.reader, values, table.path, ("items",))


def _means(table: TomlTable, choices: tuple[str, ...]) -> tuple[Text, ...]:
    """Texts of choices in each language."""
    if not table.has("means"):
        return ()
    given = table.raw("means")
    if not isinstance(given, list) or len(given) != len(choices):
        table.add_mistake(
            "means",
            f"{len(choices)} texts are needed, one for each choice",
            "Write a text for each choice, in the same order",
        )
        return ()
    return tuple(_item_table(table, means=v).text("means") for v in given)


def _wording(table: TomlTable) -> Text:
    """Source of the wording in each language. In the file it is one word for all languages, or a
    table with a word for each language."""
    languages = table.reader.languages
    own = table.field("wording").default
    given = table.raw("wording", own)
    words = given if isinstance(given, dict) else dict.fromkeys(languages, given)
    wording = {language: str(words.get(language, own)) for language in languages}
    for word in sorted(set(wording.values()) - set(WORDINGS)):
        table.add_mistake("wording", f"got {word!r}", f"Write one of {', '.join(WORDINGS)}")
    return wording


def _scale(table: TomlTable, items: tuple[Item, ...]) -> Scale:
    """Reads a scale, and reports a mistake if its score could not be computed."""
    known = {item.name: item for item in items}
    name, rule = table.name("name"), table.choice("rule")
    wanted, pairs = table.strings("items"), table.strings("pairs")
    reverse = table.strings("reverse")
    numbers = {i.name for i in items if i.kind in ("scale", "number")}
    _known(table, "items", wanted, numbers, "not an item of kind scale or number")
    _known(table, "reverse", reverse, set(wanted), "not among the items of this scale")
    if not wanted:
        table.add_mistake("items", "a scale needs items", 'Write items = ["one", "two"]')
    if bool(pairs) != (rule == "weighted"):
        table.add_mistake(
            "pairs",
            '`pairs` and rule "weighted" require each other',
            'Write both rule = "weighted" and pairs, or neither',
        )
    fitting = {i.name for i in items if i.kind == "choice" and set(i.choices) <= set(wanted)}
    _known(table, "pairs", pairs, fitting, "not a choice among the items of this scale")
    bounds = tuple((known[n].low, known[n].high) for n in wanted if n in known)
    scale = Scale(
        name,
        rule,
        wanted,
        bounds,
        frozenset(reverse),
        table.flag("from_zero"),
        float(table.number("factor")),
        pairs,
    )
    table.done()
    return scale


def _known(table: TomlTable, key: str, names: tuple[str, ...], fit: set[str], what: str) -> None:
    for name in names:
        if name not in fit:
            remedy = f"Names are: {', '.join(sorted(fit))}" if fit else "Add such items"
            table.add_mistake(key, f"{name!r} is {what}", remedy)


def _packaged(table: TomlTable, use: str) -> str | None:
    known = instruments()
    if use not in known:
        table.add_mistake(
            "use",
            f"unknown questionnaire {use!r}",
            f"Write one of {', '.join(known)}, or give a file",
        )
    return known.get(use)


def _form_text(table: TomlTable, file: str, folder: Path) -> str | None:
    """Text of a questionnaire file, which must be in the design's folder or below it."""
    if Path(file).is_absolute() or ".." in Path(file).parts:
        table.add_mistake(
            "file", f"{file} is outside of the design's folder", "Move it into that folder"
        )
        return None
    if Path(file).suffix != ".toml" or str(Path(file)).casefold() == "design.toml":
        # The study folder will contain a copy of it, which must not replace other files.
        table.add_mistake(
            "file", f"{file} is not allowed as a name", "Choose another name that ends in .toml"
        )
        return None
    try:
        return (folder / file).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        table.add_mistake("file", f"{file} cannot be read: {error}", "Give a TOML file with items")
        return None


def _as_table(table: TomlTable, text: str, file: str) -> TomlTable | None:
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        table.add_mistake("file", f"{file} cannot be read: {error}", "Give a TOML file with items")
        return None
    reader = Reader(text)
    reader.languages = table.reader.languages
    item_table = TomlTable(reader, values, (), ("questionnaires",))
    if item_table.raw("schema", SCHEMA) != SCHEMA:
        table.add_mistake(
            "file", f"{file} has another schema", f"This version reads schema {SCHEMA}"
        )
    return item_table


@dataclass(frozen=True)
class ScaleScore:
    """Score of a scale.

    Attributes:
        value: The score; None if answers are missing.
        missing: Number of missing answers.
    """

    value: float | None
    missing: int


def score(scale: Scale, answers: Mapping[str, Any]) -> ScaleScore:
    """Computes a score from answers, by item. An answer that is absent or None is missing."""
    used = (*scale.items, *scale.pairs)
    missing = sum(answers.get(name) is None for name in used)
    if missing:
        return ScaleScore(None, missing)
    values = [
        _counted(scale, name, float(answers[name]), bounds)
        for name, bounds in zip(scale.items, scale.bounds, strict=True)
    ]
    if scale.rule == "weighted":
        weights = tally(scale, answers)
        products = (v * weights[name] for v, name in zip(values, scale.items, strict=True))
        value = total(products) / total(weights.values())
    else:
        value = total(values) / (len(values) if scale.rule == "mean" else 1)
    return ScaleScore(value * scale.factor, 0)


def tally(scale: Scale, answers: Mapping[str, Any]) -> dict[str, int]:
    """How often each item of a weighted scale was chosen in the comparisons of the scale."""
    chosen = [answers.get(name) for name in scale.pairs]
    return {name: chosen.count(name) for name in scale.items}


def _counted(scale: Scale, name: str, value: float, bounds: tuple[float, float]) -> float:
    low, high = bounds
    value = low + high - value if name in scale.reverse else value
    return value - low if scale.from_zero else value
