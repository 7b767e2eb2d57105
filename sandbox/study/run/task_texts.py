"""Title and goal of a task, as a participant reads them."""

from __future__ import annotations

from collections.abc import Mapping

from sandbox.study.design.page_settings import PageSettings


def task_texts(
    page: PageSettings, key: str, name: str, goal: str, language: str, words: Mapping[str, str]
) -> tuple[str, str]:
    """Title and goal of a task: the design's own, or those of the language, or those of the task.

    Args:
        page: Settings of trials on the page.
        key: The task in the design: a name or a file.
        name: Name of the task.
        goal: The task's own summary.
        language: Language of the participant.
        words: Words of the page in this language, by key.
    """
    title = page.names.get(key, {}).get(language, words.get(f"task_{name}", _readable(name)))
    return title, page.goals.get(key, {}).get(language, words.get(f"goal_{name}", goal))


def _readable(task: str) -> str:
    """Name of a task as words: `box-to-goal` becomes `Box to goal`."""
    words = task.replace("-", " ").replace("_", " ")
    return words[:1].upper() + words[1:]
