"""Events for other programs: no session ends because nobody listens, but that is told."""

from __future__ import annotations

import contextlib
import json
import os
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from types import SimpleNamespace
from typing import Any

import pytest

from models.errors import InputError
from sandbox.cli.main import main
from sandbox.trial import logs
from sandbox.trial.logs import EventLog, NoticeEvents
from tests.support.processes import until

FULL = Path("/dev/full")
"""A device on which there is never any room."""


def test_events_are_lines_that_are_added_to_a_file(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    for number in (1, 2):
        log = EventLog(path)
        log.write("trial_start", seed=number)
        until(partial(has_lines, path, number))
        assert json.loads(path.read_text().splitlines()[-1]) == {
            "event": "trial_start",
            "seed": number,
        }
        log.close()
        log.close()
    assert len(path.read_text().splitlines()) == 2


def test_a_notice_is_one_warning_for_as_long_as_it_stays(tmp_path: Path) -> None:
    path, said = tmp_path / "events.jsonl", list[str]()
    log = EventLog(path)
    notices = NoticeEvents(log, said.append)
    for number, stay in enumerate(((), ("a",), ("a", "b"), ("b",), ("b", "a"))):
        snapshot: Any = SimpleNamespace(notices=stay, time=number / 2)
        notices.show(snapshot)
    log.close()
    warnings = [json.loads(line) for line in path.read_text().splitlines()]
    assert [(w["event"], w["what"]) for w in warnings] == [("warning", text) for text in "aba"]
    assert [w["time_s"] for w in warnings] == [0.5, 1.0, 2.0]
    assert said == ["a", "b", "a"]


def has_lines(path: Path, count: int) -> bool:
    return path.read_bytes().count(b"\n") == count


def next_line(reader: int) -> bytes:
    """What has come through a pipe, once something has."""
    found = b""

    def come() -> bool:
        nonlocal found
        with contextlib.suppress(BlockingIOError):
            found += os.read(reader, 1 << 16)
        return found.endswith(b"\n")

    until(come)
    return found


def test_a_reader_who_stands_still_holds_nobody_up_and_gets_all_events_later(
    tmp_path: Path,
) -> None:
    """A pipe of which nobody read more than its beginning stopped the session."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    log, count = EventLog(path), 3000
    for number in range(count):
        log.write("warning", what="x" * 100, number=number)
    found = b""
    while found.count(b"\n") < count:
        found += next_line(reader)
    assert [json.loads(line)["number"] for line in found.splitlines()] == list(range(count))
    log.close()
    os.close(reader)


def test_what_waits_is_written_though_later_events_found_no_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs, "MOST_WAITING", 3000)
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    log, told = EventLog(path), 10_000
    for number in range(told):
        log.write("warning", what="x" * 100, number=number)
    found = b""
    while found.count(b"\n") < 3000:
        found += next_line(reader)
    with pytest.raises(InputError, match=r"events were lost.*waited for their reader"):
        log.close()
    with contextlib.suppress(BlockingIOError):
        found += os.read(reader, 1 << 20)
    os.close(reader)
    numbers = [json.loads(line)["number"] for line in found.splitlines()]
    assert numbers == list(range(len(numbers))) and 3000 <= len(numbers) < told


class Hesitant(SimpleQueue[bytes]):
    """A queue whose reader of the size is interrupted by other threads."""

    def qsize(self) -> int:
        found = super().qsize()
        time.sleep(0.001)
        return found


def test_events_of_several_threads_wait_in_no_larger_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs, "SimpleQueue", Hesitant)
    monkeypatch.setattr(logs, "MOST_WAITING", 3)
    monkeypatch.setattr(logs, "PATIENCE", 0.01)
    path = tmp_path / "pipe"
    waiting: list[int] = []
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    log = EventLog(path)

    def write(number: int) -> None:
        # The pipe has no room for one of these.
        log.write("warning", what="x" * (1 << 17))
        waiting.append(log._waiting.qsize())

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write, range(40)))
    assert max(waiting) == 3
    with pytest.raises(InputError, match="waited for their reader"):
        log.close()
    os.close(reader)


def test_a_reader_who_leaves_a_pipe_is_told_of_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    log = EventLog(path)
    log.write("listening", address="here")
    assert json.loads(next_line(reader)) == {"event": "listening", "address": "here"}
    os.close(reader)
    log.write("warning", what="nobody hears this")
    log.write("warning", what="nor this")
    with pytest.raises(InputError, match=r"events were lost.*Broken pipe"):
        log.close()
    log.close()


def test_a_trial_is_played_to_its_end_though_its_events_find_no_room(
    capsys: pytest.CaptureFixture[str],
) -> None:
    if not FULL.exists():
        pytest.skip(f"device node absent: {FULL}")
    assert main(["run", "box-to-goal", "--seed", "3", "--events", str(FULL)]) == 2
    told = capsys.readouterr()
    assert "box-to-goal: done" in told.out
    assert "events were lost" in told.err and "No space left" in told.err
    assert told.err.count("\n") == 1
