"""A session on the page alone: what it says of latency at its end, and what a limit makes of it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from tests.support.page_client import Page
from tests.support.processes import PATIENCE, ROOT


def wait_for(path: Path, process: subprocess.Popen[str], kind: str) -> Any:
    """The first event of a kind."""
    end = time.monotonic() + PATIENCE
    while True:
        lines = path.read_text().splitlines() if path.exists() else []
        if found := [e for e in map(json.loads, lines) if e["event"] == kind]:
            return found[0]
        assert process.poll() is None and time.monotonic() < end, f"no {kind}"
        time.sleep(0.02)


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGINT")
@pytest.mark.parametrize(("limit", "code"), [("30", 1), ("50", 0)])
def test_a_page_that_draws_after_40_ms_is_within_50_ms_and_not_within_30(
    tmp_path: Path, limit: str, code: int
) -> None:
    events = tmp_path / "events.jsonl"
    play = ["play", "--view", "web", "--max-latency", limit, "--events", str(events)]
    process = subprocess.Popen(
        [sys.executable, "-m", "sandbox.cli.main", *play],
        cwd=ROOT,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env={**os.environ, "COLUMNS": "160"},
    )
    try:
        with Page(wait_for(events, process, "listening")["address"]) as page:
            page.until("scene")
            for k in range(20):
                seq = page.touch((1, 3.0 + 0.01 * k, 3.0))
                while page.until("frame")["touch"] < seq:
                    pass
                page.say(type="drawn", frame=1, after_ms=40.0)
            # Whoever is answered was heard, with all that was said before.
            page.say(type="beat", t=1.0)
            page.until("echo")
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == code, out
    for row in ("touch received to step", "step to frame ready", "touch event to picture on"):
        assert row in out
    assert f"the limit of {limit} ms" in out and "not measured" in out
    assert wait_for(events, process, "trial_end")["latency"]["drawn"]["p95_ms"] == 40.0
