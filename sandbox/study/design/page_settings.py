"""Settings of trials on the participant's page: display, start of time, and lost connection."""

from __future__ import annotations

from dataclasses import dataclass, field

from sandbox.study.design.reading import Text, TomlTable
from sandbox.words.words import values_of, words_in, words_of_studies

SHOWS = ("task", "goal", "time", "progress", "fingers", "sound")
"""`fingers`: the rings under the fingers also show names, colours and forces."""
STARTS = ("touch", "shown")
"""`touch`: time starts with the first touch; `shown`: as soon as the scene is visible."""
WHEN_GONE = ("pause", "repeat", "mark")
"""Behaviour while the page is unreachable. `pause`: time stops until the page is back and touched;
`repeat`: the attempt is broken off and the trial starts again; `mark`: time continues. The results
contain the time without the page."""


@dataclass(frozen=True)
class PageSettings:
    """Settings of trials on the page.

    Attributes:
        shows: Items of `SHOWS` that the participant sees or hears.
        starts: One of `STARTS`.
        when_gone: One of `WHEN_GONE`.
        names, goals: Names and goals of tasks as shown to the participant, by task.
        words: The design's own words for the page, by language and key.
    """

    shows: tuple[str, ...] = ("task", "goal")
    starts: str = "touch"
    when_gone: str = "pause"
    names: dict[str, Text] = field(default_factory=dict)
    goals: dict[str, Text] = field(default_factory=dict)
    words: dict[str, dict[str, str]] = field(default_factory=dict)


def read_page_settings(top: TomlTable, trials: TomlTable) -> PageSettings:
    """Reads the settings of the page.

    Args:
        top: The design, from which `[[tasks]]` is taken.
        trials: Its table `[trials]`.
    """
    plain = PageSettings()
    shows = trials.strings("shows", plain.shows)
    for unknown in sorted(set(shows) - set(SHOWS)):
        trials.add_mistake("shows", f"got {unknown!r}", f"Choose among {', '.join(SHOWS)}")
    names, goals = {}, {}
    for table in top.tables("tasks"):
        task = table.string("task")
        names[task], goals[task] = table.text("name"), table.text("goal")
        table.done()
    return PageSettings(
        shows,
        trials.choice("starts", STARTS, plain.starts),
        trials.choice("when_gone", WHEN_GONE, plain.when_gone),
        names,
        goals,
        _read_words(top),
    )


def _read_words(top: TomlTable) -> dict[str, dict[str, str]]:
    """Reads the table `[words]`, which has a table for each language with words of its own."""
    table, english = top.table("words"), words_in("en")
    words: dict[str, dict[str, str]] = {}
    for language in top.reader.languages:
        if not table.has(language):
            continue
        given = table.table(language)
        taken = {key: given.string(key, "") for key in words_of_studies()}
        words[language] = {key: text for key, text in taken.items() if text}
        for key, text in words[language].items():
            if values_of(text) != values_of(english[key]):
                wanted = ", ".join(f"{{{name}}}" for name in sorted(values_of(english[key])))
                given.add_mistake(
                    key,
                    f"the values of {english[key]!r} are {wanted or 'none'}",
                    "Write them as they are there, in braces",
                )
        given.done()
    table.done()
    return words
