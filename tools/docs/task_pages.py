"""Pages of the tasks for the site: film, contract, spaces, score and what was measured.

The pages are made from the registry of tasks, the tasks' docstrings, the environments of Gymnasium
and the tables of `docs/results.md`. So a new task has its page as soon as it is registered.
"""

from __future__ import annotations

import inspect
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium

from sandbox.gym import register_task
from sandbox.trial.assembly import place_all
from sandbox.trial.settings import HandSettings, Settings
from tasks.guarded import draw_task
from tasks.registry import TASKS
from tasks.task import Task, place_surface
from tools.docs.markdown_table import markdown_table
from tools.docs.measured_tables import MeasuredTable, tables_of
from tools.docs.task_films import FILMS, TaskFilm, film_of

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "docs" / "results.md"
FOLDER = "tasks"
"""Folder of the pages on the site."""

PARTS = ("Scene", "Goal", "Success", "Start", "Size", "History")
"""Parts of a task's docstring, each of which begins with its name and a colon."""

PLANES = {"table": "flat over the table", "front": "upright, in front of the person"}
"""Places of the touch surface."""


OVERVIEW = """# Tasks

Every task is played by touch, by the simulated user in CI, in studies, and by agents. The films
show the simulated user; no person took part.

::::{grid} 1 1 2 2
:gutter: 3

"""


def write_pages(folder: Path) -> list[str]:
    """Writes a page for every task, and one that lists them.

    Args:
        folder: Folder of the site's pages.

    Returns:
        Names of the pages, for the menu.
    """
    out = folder / FOLDER
    out.mkdir()
    tables = list(tables_of(RESULTS))
    for name, kind in TASKS.items():
        (out / f"{name}.md").write_text(page_of(kind, tables), encoding="utf-8")
    (out / "index.md").write_text(overview(), encoding="utf-8")
    return [f"{FOLDER}/index", *(f"{FOLDER}/{name}" for name in TASKS)]


def overview() -> str:
    """The page that lists all tasks, with their films."""
    cards = []
    for name, kind in TASKS.items():
        film = film_of(name)
        shown = f":img-top: {_film_path(film)}\n:img-alt: A film of {name}\n" if film else ""
        head = f":::{{grid-item-card}} {name}\n:link: {name}\n:link-type: doc\n{shown}"
        cards.append(f"{head}\n{described(kind).first}\n:::")
    return OVERVIEW + "\n\n".join(cards) + "\n::::\n"


@dataclass(frozen=True)
class Described:
    """A task's docstring.

    Attributes:
        first: Its first sentence.
        more: Text between the first sentence and the first part; empty if there is none.
        parts: Name of a part -> its text.
    """

    first: str
    more: str
    parts: dict[str, str]


def described(kind: type[Task]) -> Described:
    """The docstring of a task, cut into its parts."""
    first, _, rest = inspect.cleandoc(kind.__doc__ or "").partition("\n\n")
    # A part begins at the start of a line or of a sentence.
    more, *pieces = re.split(rf"(?:^|(?<=[.)]) |\n)({'|'.join(PARTS)}): ", f"\n{rest}")
    texts = [" ".join(piece.split()) for piece in (first, more, *pieces[1::2])]
    return Described(texts[0], texts[1], dict(zip(pieces[::2], texts[2:], strict=True)))


def page_of(kind: type[Task], tables: list[MeasuredTable]) -> str:
    """The page of one task, in MyST Markdown."""
    docstring = described(kind)
    parts = [f"**{name}.** {text[:1].upper()}{text[1:]}" for name, text in docstring.parts.items()]
    blocks = [
        f"# {kind.name}",
        docstring.first,
        *_film(kind.name),
        _facts(kind),
        "## What has to be done",
        *([docstring.more] if docstring.more else []),
        *parts,
        "## Spaces",
        _spaces(kind),
        "## Score",
        _score(kind),
        "## How difficult it is",
        *_measured(kind.name, tables),
    ]
    return "\n\n".join(blocks) + "\n"


def _film_path(film: TaskFilm) -> str:
    return f"../docs/pictures/{FILMS.name}/{film.path.name}"


def _film(name: str) -> list[str]:
    film = film_of(name)
    if film is None:
        return []
    return [
        f"![The simulated user plays {name}]({_film_path(film)})",
        f"*The simulated user plays: `{film.command}`. No person took part.*",
    ]


def _facts(kind: type[Task]) -> str:
    hand = HandSettings()
    settings = Settings(task=kind.name, hands=(hand, hand.opposite)[: kind.hands])
    whole, _ = place_all(place_surface(settings.surface.rectangle, kind), settings, kind)
    task = draw_task(kind, 0, whole)
    lift = f"up to {100 * kind.lift_range:.0f} cm" if kind.lift_range else "not used"
    rows = [
        ("Play it", f"`sandbox play {kind.name}`"),
        ("Test it in CI", f"`sandbox regress --tasks {kind.name} --seeds 0:120`"),
        ("Version", kind.version),
        ("Hands", kind.hands),
        ("Objects", ", ".join(f"`{thing.name}`" for thing in task.objects)),
        ("Touch surface", PLANES[kind.plane]),
        ("Lift control", lift),
        ("Time limit", f"{kind.time_limit:g} s"),
        ("Hold time", f"{kind.hold_time:g} s"),
    ]
    return markdown_table(("Property", "Value"), [(name, str(value)) for name, value in rows])


def _spaces(kind: type[Task]) -> str:
    id, rows = register_task(kind.name), []
    for action in ("touch", "pose"):
        environment = gymnasium.make(id, action=action)
        try:
            seen: Any = environment.observation_space
            shapes = ", ".join(f"`{name}` {space.shape}" for name, space in seen.items())
            options = f'`{id}`, `action="{action}"`'
            rows.append((options, f"{environment.action_space.shape}", shapes))
        finally:
            environment.close()
    return (
        markdown_table(("Gymnasium id", "action", "observation"), rows)
        + "\n\n[Gymnasium](../docs/gymnasium.md) explains every number and the other options."
    )


def _score(kind: type[Task]) -> str:
    return (
        f"A trial is a success if everything above holds for {kind.hold_time:g} s without a break, "
        f"within {kind.time_limit:g} s. 1 s later it is tested whether everything still holds. A "
        "trial also has a progress from 0 (as at the start) to 1, a text that names the missing "
        "condition, and the [measures](../docs/measures.md) of studies."
    )


def _seen_from_here(cell: str, page: str) -> str:
    """A table cell of a page of docs/, with links that are valid on a task's page."""

    def whole(link: re.Match[str]) -> str:
        file = page if link[1].startswith("#") else ""
        return f"](../docs/{file}{link[1]})"

    return re.sub(r"\]\((?!\w+:)([^)]*)\)", whole, cell)


def _measured(name: str, tables: list[MeasuredTable]) -> list[str]:
    parts = []
    for table in tables:
        part = table.of_task(name)
        if part is None:
            continue
        link = f"../docs/{table.page.name}"
        rows = [[_seen_from_here(cell, table.page.name) for cell in row] for row in part.rows]
        parts.append((table.heading, link, markdown_table(part.columns, rows)))
    if not parts:
        return ["Nothing has been measured yet."]
    note = (
        "All results are of the simulated user. The linked pages have the commands. No person took "
        "part."
    )
    times, numbers = Counter(heading for heading, *_ in parts), Counter[str]()
    shown = []
    for heading, link, text in parts:
        numbers[heading] += 1
        # The texts of links are different, so that a screen reader can list them.
        which = f", table {numbers[heading]} of {times[heading]}" if times[heading] > 1 else ""
        shown.append(f"[{heading}{which}]({link}):\n\n{text}")
    return [note, *shown]
