"""Trials of a benchmark that are saved as they end, so that a run can be stopped and resumed.

Every trial is a line of JSON: its job and its outcome. Several files can be combined in one table,
such as files of trials that were played at different times or on different machines. The compressed
files in `benchmarks/kept` have the trials behind numbers in the docs.
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
    """Played trials in files of JSON lines.

    Args:
        job: Class of jobs, a named tuple.
        outcome: Class of outcomes, a dataclass of plain values.
        files: Files with trials, some of them perhaps compressed (`.gz`). They need not exist.
            New trials are added to the first one, which must not be compressed.

    Attributes:
        done: Job -> outcome, of all played trials.

    Raises:
        InputError: A file does not contain trials of this benchmark.
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
        """Plays the jobs without an outcome, and saves each when it and those before it have ended.

        Args:
            trial: Plays one job; a function of a module, since it runs in other processes.
            jobs: All jobs of the benchmark.
            workers: Number of processes.
        """
        missing = [job for job in jobs if job not in self.done]
        if not missing:
            return
        # One thread in each process, since the processes use all cores already.
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
    """Returns the error for a file whose lines are trials of another benchmark."""
    return InputError(
        "the file has trials of another benchmark",
        where=str(file),
        got=f"{type(error).__name__}: {error}",
    )


def whole_lines(file: Path) -> int:
    """Returns the number of bytes up to the end of a file's last complete line. If the program was
    killed, the line after it may be incomplete."""
    return file.read_bytes().rfind(b"\n") + 1


def lines_of(file: Path) -> Iterator[dict[str, Any]]:
    """Yields the complete lines of a file as objects; no line if there is no such file.

    Raises:
        InputError: A line is not JSON, or the file cannot be read or decompressed.
    """
    try:
        if file.suffix == ".gz":
            whole = gzip.decompress(file.read_bytes())
        else:
            whole = file.read_bytes()[: whole_lines(file)] if file.exists() else b""
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(
            "the file of trials cannot be read", where=str(file), got=str(error)
        ) from error
    for number, line in enumerate(whole.splitlines(), 1):
        try:
            yield json.loads(line)
        except ValueError:
            raise InputError(
                "the line is not a trial", where=f"{file}, line {number}", expected="a line of JSON"
            ) from None
