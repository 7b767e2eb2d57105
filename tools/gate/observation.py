"""Plays all that the gate compares, in processes of its own."""

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
"""Group, name of the row (None: the work gives all rows of the group), function, arguments."""


def work(quick: bool) -> list[Work]:
    """Everything to play, the longest first."""
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
    """The rows of a function; an exception becomes a row with `error`, which always differs."""
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
    # A process a core is enough.
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
    # As a file holds them, so that equal rows compare equal.
    plain: Rows = json.loads(json.dumps(rows))
    return plain
