"""Questionnaires: their items and scales, in a design, in a file beside it, or in the package."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from fractions import Fraction
from importlib.resources import files
from pathlib import Path

import numpy as np

from sandbox.study.design.design import END, ITEMS, SCHEMA, START, Form, Item
from sandbox.study.design.reading import Reader, Text, TomlTable
from sandbox.study.design.scoring import RULES, Scale


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
    """Reads a questionnaire of a design: `use` names one of the package, `file` a file.

    Args:
        table: TomlTable of the design, which collects the mistakes.
        factors: Names of factors; a form can be asked after each level of one.
        folder: Folder of the design.
    """
    use, file = table.string("use", ""), table.string("file", "")
    name = table.name("name") if not use or table.has("name") else use
    at = table.choice("at", (START, END, *factors), END)
    sessions = table.session_numbers("sessions")
    if use and file:
        table.wrong("file", "`use` is given, too", "Keep one of the two")
    text = _packaged(table, use) if use else _beside(table, file, folder) if file else None
    source = _as_table(table, text, file) if text is not None else None if use or file else table
    if source is None:
        # What is wrong with the file is remembered already.
        table.raw("title")
        table.done()
        return Form(name, {}, (), at)
    title = source.text("title")
    if source is not table and table.has("title"):
        title = table.text("title")
    items = tuple(read_item(t) for t in source.tables("items"))
    if not items:
        source.wrong("items", "there is no question", "Add [[questionnaires.items]], or a file")
    names = [item.name for item in items]
    for i, one in enumerate(names):
        if one and one in names[:i]:
            source.reader.wrong(
                (*source.path, "items", i, "name"), f"{one!r} is there twice", "Rename one of them"
            )
    scales = tuple(_scale(t, items) for t in source.tables("scales"))
    if source is not table:
        source.done()
        for mistake in source.reader.mistakes:
            remedy = "Translate it in a file of your own" if use else "Correct that file"
            table.wrong("use" if use else "file", f"{use or file}, {mistake}", remedy)
    table.done()
    origin = (file, text) if file and text else None
    return Form(name, title, items, at, scales, origin, sessions)


def read_item(table: TomlTable) -> Item:
    """One question."""
    name, ask = table.name("name"), table.text("ask")
    kind = table.choice("kind", ITEMS, "text")
    choices = table.strings("choices")
    low = float(table.number("low", 0.0, -1e9, 1e9))
    high = float(table.number("high", 100.0, -1e9, 1e9))
    step = float(table.number("step", 1.0, 1e-9, 1e9))
    if kind == "choice" and len(choices) < 2:
        table.wrong("choices", "a choice needs two or more", 'Write choices = ["yes", "no"]')
    if kind in ("scale", "number") and not low < high:
        table.wrong("low", f"{low:g} is not below {high:g}", "Swap low and high")
    elif kind == "scale" and (Fraction(repr(high)) - Fraction(repr(low))) % Fraction(repr(step)):
        table.wrong(
            "step",
            f"from {low:g}, steps of {step:g} do not end at {high:g}",
            "Change step or high: the last answer has to be one",
        )
    ends = (table.text("low_means"), table.text("high_means")) if table.has("low_means") else None
    means = _means(table, choices)
    optional, shuffle = table.flag("optional"), table.flag("shuffle")
    table.done()
    return Item(name, kind, ask, choices, low, high, step, ends, optional, means, shuffle)


def arranged(form: Form, seed: int) -> Form:
    """A form as one participant gets it: shuffled items and choices in a random order, others in
    their places.

    Args:
        form: The form of the design.
        seed: Seed of the participant and the place in their session.
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
        items += [_turned(run[i], rng) for i in rng.permutation(len(run))]
        run = []
        if item is not None:
            items.append(item)
    return replace(form, items=tuple(items))


def _turned(item: Item, rng: np.random.Generator) -> Item:
    order = rng.permutation(len(item.choices))
    return replace(
        item,
        choices=tuple(item.choices[i] for i in order),
        means=tuple(item.means[i] for i in order) if item.means else (),
    )


def _means(table: TomlTable, choices: tuple[str, ...]) -> tuple[Text, ...]:
    """Texts of choices in each language."""
    if not table.has("means"):
        return ()
    given = table.raw("means")
    if not isinstance(given, list) or len(given) != len(choices):
        table.wrong(
            "means",
            f"{len(choices)} are needed, one for each choice",
            "Write a text for each choice, in their order",
        )
        return ()
    # Each is read like any other text.
    return tuple(TomlTable(table.reader, {"means": v}, table.path).text("means") for v in given)


def _scale(table: TomlTable, items: tuple[Item, ...]) -> Scale:
    """Reads a scale; a score that cannot be computed is a mistake now, not after the study."""
    known = {item.name: item for item in items}
    name, rule = table.name("name"), table.choice("rule", RULES, "sum")
    wanted, pairs = table.strings("items"), table.strings("pairs")
    reverse = table.strings("reverse")
    numbers = {i.name for i in items if i.kind in ("scale", "number")}
    _known(table, "items", wanted, numbers, "no scale or number")
    _known(table, "reverse", reverse, set(wanted), "not among the items of this scale")
    if not wanted:
        table.wrong("items", "a scale needs items", 'Write items = ["one", "two"]')
    if bool(pairs) != (rule == "weighted"):
        table.wrong(
            "pairs",
            "pairs and the rule weighted need each other",
            'Write rule = "weighted" and pairs, or neither',
        )
    fitting = {i.name for i in items if i.kind == "choice" and set(i.choices) <= set(wanted)}
    _known(table, "pairs", pairs, fitting, "no choice among the items of this scale")
    bounds = tuple((known[n].low, known[n].high) for n in wanted if n in known)
    scale = Scale(
        name,
        rule,
        wanted,
        bounds,
        frozenset(reverse),
        table.flag("from_zero"),
        float(table.number("factor", 1.0, -1e6, 1e6)),
        pairs,
    )
    table.done()
    return scale


def _known(table: TomlTable, key: str, names: tuple[str, ...], fit: set[str], what: str) -> None:
    for name in names:
        if name not in fit:
            remedy = f"Names are: {', '.join(sorted(fit))}" if fit else "Add such items"
            table.wrong(key, f"{name!r} is {what}", remedy)


def _packaged(table: TomlTable, use: str) -> str | None:
    known = instruments()
    if use not in known:
        table.wrong(
            "use",
            f"there is no questionnaire {use!r}",
            f"Write one of {', '.join(known)}, or give a file",
        )
    return known.get(use)


def _beside(table: TomlTable, file: str, folder: Path) -> str | None:
    """The text of a questionnaire's file, which stands beside the design or below it."""
    if Path(file).is_absolute() or ".." in Path(file).parts:
        table.wrong("file", f"{file} is not beside the design", "Put it into the design's folder")
        return None
    if Path(file).suffix != ".toml" or file == "design.toml":
        # A copy of it will stand in the study's folder, among other files.
        table.wrong("file", f"{file} cannot be its name", "Name it something.toml")
        return None
    try:
        return (folder / file).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        table.wrong("file", f"{file} cannot be read: {error}", "Give a TOML file with items")
        return None


def _as_table(table: TomlTable, text: str, file: str) -> TomlTable | None:
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        table.wrong("file", f"{file} cannot be read: {error}", "Give a TOML file with items")
        return None
    reader = Reader(text)
    reader.languages = table.reader.languages
    item_table = TomlTable(reader, values)
    if item_table.raw("schema", SCHEMA) != SCHEMA:
        table.wrong("file", f"{file}: another version's", f"This version reads schema {SCHEMA}")
    return item_table
