"""A replayed trial is seen in the window and on the page, and stands still when it is told to."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sandbox.cli.main import main
from tests.support.page_client import Page
from tests.support.processes import PATIENCE
from tests.support.screen import screen

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "run.jsonl"
    assert (
        main(["run", "box-to-goal", "--device", "simulated", "--seed", "3", "--record", str(path)])
        == 0
    )
    return path


@pytest.fixture
def program() -> Iterator[list[subprocess.Popen[str]]]:
    """What a test starts, ended with it."""
    started: list[subprocess.Popen[str]] = []
    yield started
    for process in started:
        if process.poll() is None:
            process.kill()
        process.wait()


def start(recording: Path, *options: str, **more: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "sandbox.cli.main", "replay", str(recording), *options],
        cwd=ROOT,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env={**os.environ, "COLUMNS": "200", **more},
    )


@pytest.mark.slow
def test_the_page_shows_a_replay_at_real_time_and_can_pause_it_and_begin_again(
    recording: Path, program: list[subprocess.Popen[str]]
) -> None:
    process = start(recording, "--view", "web")
    program.append(process)
    assert process.stdout is not None
    said, link = "", None
    while link is None:
        line = process.stdout.readline()
        assert line, said
        said += line
        link = re.search(r"http://\S+", line)
    assert "exact" in said
    with Page(link.group()) as page:
        assert page.until("scene")["task"] == "box-to-goal"
        first = page.until("frame")
        assert first["time"] < 5.0
        page.say(type="ask", what="pause")
        paused = page.until("frame")
        while paused["state"]["pause"] != "menu":
            paused = page.until("frame")
        later = [page.until("frame")["time"] for _ in range(5)]
        assert later[-1] == later[-2]
        page.say(type="ask", what="resume")
        end = time.monotonic() + PATIENCE
        while page.until("frame")["time"] < 5.1:
            assert time.monotonic() < end
        page.say(type="ask", what="retry")
        while page.until("frame")["time"] > 2.0:
            assert time.monotonic() < end
    process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE) == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs an X server in memory")
def test_the_window_shows_a_replay_and_goes_back_and_on_by_keys(
    recording: Path, program: list[subprocess.Popen[str]]
) -> None:
    with screen() as display:
        process = start(recording, "--view", "window", DISPLAY=display.name)
        program.append(process)
        empty = display.picture()

        def wait() -> None:
            assert process.poll() is None, process.stdout and process.stdout.read()
            time.sleep(0.05)

        def still() -> np.ndarray:
            """What is seen once it does not change any more."""
            seen, same = display.picture(), 0
            while same < 10:
                assert time.monotonic() < end, "it does not stand still"
                wait()
                before, seen = seen, display.picture()
                same = same + 1 if np.array_equal(seen, before) else 0
            return seen

        def key(*names: str) -> np.ndarray:
            """What is seen after keys that change what is seen."""
            before = still()
            display.do(wait, "mousemove", 500, 350, "key", *names)
            while np.array_equal(display.picture(), before):
                assert time.monotonic() < end, f"{names} changes nothing"
                wait()
            return still()

        end = time.monotonic() + PATIENCE
        while np.abs(display.picture() - empty).mean() < 5.0:
            assert time.monotonic() < end
            wait()
        display.do(wait, "mousemove", 500, 350, "key", "p")
        # Each of these waits until something else is seen, which then stands still.
        key("Left")
        key("Right")
        key("comma", "comma")
        # It may draw more plainly by now; the same step need not be the same picture.
        key("period", "period")
        display.do(lambda: time.sleep(0.05), "key", "q")
        assert process.wait(PATIENCE) == 0
