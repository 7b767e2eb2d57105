"""Plays everything that the gate compares, in separate processes."""

from __future__ import annotations

import json
import os
import traceback
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from tools.gate import devices, page, study, trials
from tools.gate.rows import Rows

Work = tuple[str, str | None, Callable[..., Any], tuple[Any, ...]]
"""Group, name of the row, function, arguments. If the name is None, the function returns all rows
of the group."""


def work(quick: bool) -> list[Work]:
    """Everything to play. The longest work comes first."""
    found: list[Work] = []
    if not quick:
        found.append(("study", None, study.play, ()))
        found.append(("page", "Chromium, box-to-goal", page.play, ()))
    for (group, name), job in trials.jobs(quick).items():
        found.append((group, name, trials.play, (job,)))
    for name in devices.SEEDS:
        found.append(("devices", name, devices.play, (name,)))
    return found


def guarded(function: Callable[..., Any], arguments: tuple[Any, ...], many: bool) -> Any:
    """Calls a function and returns its row or rows.

    An exception becomes a row with `error`, which always counts as a difference.

    Args:
        function: The function.
        arguments: Its arguments.
        many: True if the function returns several rows.
    """
    try:
        return function(*arguments)
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(last.filename).name}:{last.lineno}"
        row = {"error": f"{type(error).__name__}: {error} ({place})"}
        return {"exception": row} if many else row


def observe(quick: bool, workers: int) -> Rows:
    """Plays everything and returns the rows."""
    rows: Rows = {}
    everything = work(quick)
    # There is a process for every core, so libraries need no threads of their own.
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    console = Console(stderr=True)
    # Fresh processes, so that nothing depends on what ran before.
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
    with pool, Progress(console=console) as bar:
        task = bar.add_task("gate", total=len(everything))
        waiting: list[tuple[str, str | None, Future[Any]]] = []
        for group, name, function, arguments in everything:
            future = pool.submit(guarded, function, arguments, name is None)
            future.add_done_callback(lambda done: bar.advance(task))
            waiting.append((group, name, future))
        for group, name, future in waiting:
            observed = future.result()
            if name is None:
                rows.setdefault(group, {}).update(observed)
            else:
                rows.setdefault(group, {})[name] = observed
    # The rows are converted to values as in the file, so that equal rows compare equal.
    plain: Rows = json.loads(json.dumps(rows))
    return plain
