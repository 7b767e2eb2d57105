"""Trials of a benchmark that are kept as they end, so that a run can be stopped, resumed and split.

Every trial is a line of JSON: its job and its outcome. Several files make one table, as those of
ranges of trials that were played at several times or on several machines. Those that numbers in the
docs are of are in `benchmarks/kept`, compressed.
"""

from __future__ import annotations

import gzip
import json
import os
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from rich.console import Console
from rich.progress import Progress

from models.errors import InputError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Job = TypeVar("Job", bound=NamedTuple)
Outcome = TypeVar("Outcome", bound="DataclassInstance")


class KeptTrials(Generic[Job, Outcome]):
    """Trials that have been played, in files of JSON lines.

    Args:
        job: Class of jobs, tuples with names.
        outcome: Class of outcomes, dataclasses of plain values.
        files: Files with trials, which need not exist, some of them compressed (`.gz`). The first
            one, which is not, takes what is played.

    Attributes:
        done: Outcome of every job that has one.
    """

    def __init__(self, job: type[Job], outcome: type[Outcome], files: Sequence[Path]) -> None:
        self._file = files[0]
        self.done: dict[Job, Outcome] = {}
        for file in files:
            for kept in lines_of(file):
                try:
                    self.done[job(*kept["job"])] = outcome(**kept["outcome"])
                except (KeyError, TypeError) as error:
                    raise not_these(file, error) from None

    def play(self, trial: Callable[[Job], Outcome], jobs: Iterable[Job], workers: int) -> None:
        """Plays the jobs without an outcome, and keeps each as soon as it and those before it have
        ended."""
        missing = [job for job in jobs if job not in self.done]
        if not missing:
            return
        # One thread a process: the machine's cores are the processes' already.
        os.environ["OMP_NUM_THREADS"] = "1"
        self._file.parent.mkdir(parents=True, exist_ok=True)
        bars = Progress(console=Console(stderr=True))
        with self._file.open("ab") as file, bars, ProcessPoolExecutor(workers) as pool:
            file.truncate(whole_lines(self._file))
            played = zip(missing, pool.map(trial, missing), strict=True)
            for job, outcome in bars.track(played, total=len(missing)):
                self.done[job] = outcome
                line = {"job": list(job), "outcome": asdict(outcome)}
                file.write(json.dumps(line).encode() + b"\n")
                file.flush()


def not_these(file: Path, error: Exception) -> InputError:
    """The error for a file whose lines are trials of another benchmark."""
    return InputError(
        "these are trials of something else",
        where=str(file),
        got=f"{type(error).__name__}: {error}",
    )


def whole_lines(file: Path) -> int:
    """Bytes of a file up to the end of its last whole line: a program that was killed may have torn
    the one after it."""
    return file.read_bytes().rfind(b"\n") + 1


def lines_of(file: Path) -> Iterator[dict[str, Any]]:
    """Whole lines of a file, perhaps compressed; none if there is no such file.

    Raises:
        InputError: The file does not hold trials, or is compressed and broken.
    """
    try:
        if file.suffix == ".gz":
            whole = gzip.decompress(file.read_bytes())
        else:
            whole = file.read_bytes()[: whole_lines(file)] if file.exists() else b""
    except (OSError, EOFError, zlib.error) as error:
        raise InputError("cannot be read", where=str(file), got=str(error)) from error
    for number, line in enumerate(whole.splitlines(), 1):
        try:
            yield json.loads(line)
        except ValueError:
            raise InputError(
                "this is no trial", where=f"{file}, line {number}", expected="a line of JSON"
            ) from None
