"""Settings of a trial on the page: display, start of time, and loss of the tablet."""

from __future__ import annotations

from dataclasses import dataclass, field

from sandbox.study.design.reading import Text, TomlTable

SHOWS = ("task", "goal", "time", "progress", "fingers", "sound")
"""`fingers`: the rings under them tell names (in English), colours and forces, too."""
STARTS = ("touch", "shown")
"""`touch`: time begins with the first touch; `shown`: as soon as the scene is seen."""
WHEN_GONE = ("pause", "repeat", "mark")
"""`pause`: time stands still until the page is back and touched; `repeat`: the attempt is broken
off and the trial begins anew; `mark`: time goes on. The results say how long it was gone."""


@dataclass(frozen=True)
class PageOptions:
    """Settings of trials on the page.

    Attributes:
        shows: Items of `SHOWS` that participants see or hear.
        starts: One of `STARTS`.
        when_gone: One of `WHEN_GONE`.
        names, goals: Names of tasks and instructions, by task.
    """

    shows: tuple[str, ...] = ("task", "goal")
    starts: str = "touch"
    when_gone: str = "pause"
    names: dict[str, Text] = field(default_factory=dict)
    goals: dict[str, Text] = field(default_factory=dict)


def read_page_options(top: TomlTable, trials: TomlTable) -> PageOptions:
    """Reads it.

    Args:
        top: The design; `[[tasks]]` is taken out of it.
        trials: Its `[trials]`.
    """
    plain = PageOptions()
    shows = trials.strings("shows", plain.shows)
    for unknown in sorted(set(shows) - set(SHOWS)):
        trials.wrong("shows", f"got {unknown!r}", f"Choose among {', '.join(SHOWS)}")
    names, goals = {}, {}
    for table in top.tables("tasks"):
        task = table.string("task")
        names[task], goals[task] = table.text("name"), table.text("goal")
        table.done()
    return PageOptions(
        shows,
        trials.choice("starts", STARTS, plain.starts),
        trials.choice("when_gone", WHEN_GONE, plain.when_gone),
        names,
        goals,
    )
