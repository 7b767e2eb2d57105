"""A progress bar on the terminal; none if the output is not a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress


@contextmanager
def bars() -> Iterator[Progress]:
    """Bars that vanish when they are done."""
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        yield progress


def bar(progress: Progress, what: str) -> Callable[[float], None]:
    """Adds a bar, and returns a function that sets the share done, 0 to 1."""
    task = progress.add_task(what, total=1.0)
    return lambda share: progress.update(task, completed=share)
