"""Title, goal and hint of a task, as a participant reads them."""

from __future__ import annotations

from collections.abc import Mapping

from sandbox.study.design.design import PageSettings
from tasks.task import summary


def task_texts(
    page: PageSettings, key: str, name: str, goal: str, language: str, words: Mapping[str, str]
) -> tuple[str, str]:
    """Title and goal of a task.

    They come from the design; or else from the page's words in the language; or else from the task.

    Args:
        page: Settings of trials on the page.
        key: The task as in the design: a name or a file.
        name: Name of the task.
        goal: The task's own summary.
        language: Language of the participant.
        words: Words of the page in this language, by key.
    """
    title = page.names.get(key, {}).get(language, words.get(f"task_{name}", _readable(name)))
    return title, page.goals.get(key, {}).get(language, words.get(f"goal_{name}", goal))


def task_hint(page: PageSettings, name: str, words: Mapping[str, str]) -> str:
    """Text on how a task is done, in a language; empty unless the design shows hints.

    Args:
        page: Settings of trials on the page.
        name: Name of the task.
        words: Words of the page in this language, by key.
    """
    return words.get(f"how_{name}", words["how_any"]) if "hint" in page.shows else ""


def texts_by_design(
    page: PageSettings, key: str, language: str, words: Mapping[str, str]
) -> tuple[str, str]:
    """Title and goal of a task as in `task_texts`; each is empty if the design hides it."""
    from tasks.registry import find_task

    task = find_task(key)
    title, goal = task_texts(page, key, task.name, summary(task), language, words)
    return title if "task" in page.shows else "", goal if "goal" in page.shows else ""


def _readable(task: str) -> str:
    """Title from the name of a task: `box-to-goal` becomes `Box to goal`."""
    words = task.replace("-", " ").replace("_", " ")
    return words[:1].upper() + words[1:]
