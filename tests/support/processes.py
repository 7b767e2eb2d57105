"""Other programs that tests run: Python, a `sandbox` command, a UDP sender; and patience."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
UNWANTED = {"PYTHONPATH", "PYTHONSAFEPATH", "PYTEST_ADDOPTS", "CI"}
"""Variables that would change what a child process is asked."""
PATIENCE = 60.0
"""Seconds after which something that should happen is given up; nothing is judged by it."""


class Sender:
    """A UDP socket of its own, as every sender has one."""

    def __init__(self, port: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))

    def __call__(self, *packets: bytes) -> None:
        for packet in packets:
            self.socket.send(packet)

    def __enter__(self) -> Sender:
        return self

    def __exit__(self, *error: object) -> None:
        self.socket.close()


def free_port(kind: socket.SocketKind = socket.SOCK_DGRAM) -> int:
    """A port of this machine at which nothing listens."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def receiver() -> Iterator[socket.socket]:
    """A UDP socket that waits for packets."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as bound:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        bound.bind(("127.0.0.1", 0))
        bound.settimeout(PATIENCE)
        yield bound


def until(condition: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "this should have happened by now"
        time.sleep(0.002)


class Program:
    """A running `sandbox` command; its standard error is read along."""

    def __init__(self, *arguments: str | Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "sandbox.cli.main", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            # Lines must come at once because the program says so, not because of a setting here.
            env={key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"},
        )
        self.errors: list[str] = []
        self._reader = threading.Thread(target=self._read_errors)
        self._reader.start()

    def _read_errors(self) -> None:
        assert self.process.stderr is not None
        self.errors.extend(iter(self.process.stderr.readline, ""))

    def error_line(self, pattern: str) -> re.Match[str]:
        """Waits for a line on standard error."""
        found: list[re.Match[str]] = []

        def look() -> bool:
            found.extend(m for line in list(self.errors) if (m := re.search(pattern, line)))
            assert found or self._reader.is_alive(), f"it ended saying only {self.errors}"
            return bool(found)

        until(look)
        return found[0]

    def port(self) -> int:
        return int(self.error_line(r"listening.*127\.0\.0\.1:(\d+)")[1])

    def end(self) -> tuple[int, list[str]]:
        """Its exit status and what is left of its standard output, once it ends by itself."""
        assert self.process.stdout is not None
        lines = self.process.stdout.read().splitlines()
        status = self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        return status, lines


@contextmanager
def program(*arguments: str | Path) -> Iterator[Program]:
    started = Program(*arguments)
    try:
        yield started
    finally:
        started.process.kill()
        started.process.wait()
        assert started.process.stdout is not None
        assert started.process.stderr is not None
        started.process.stdout.close()
        started._reader.join(PATIENCE)
        started.process.stderr.close()


def run(*arguments: str | Path) -> tuple[int, list[str], str]:
    with program(*arguments) as started:
        status, lines = started.end()
        return status, lines, "".join(started.errors)


def python(
    *words: object, cwd: Path = ROOT, path: tuple[Path, ...] = (ROOT,), **environment: str | None
) -> subprocess.CompletedProcess[str]:
    """Runs Python as a person without this project's settings would.

    Args:
        words: Its arguments.
        cwd: Its folder.
        path: Its PYTHONPATH; installed packages stay visible.
        environment: Further variables; None removes one.
    """
    changed = {name: os.environ.get(name) for name in os.environ if name not in UNWANTED}
    changed |= {"PYTHONPATH": os.pathsep.join(map(str, path)), **environment}
    return subprocess.run(
        [sys.executable, *map(str, words)],
        cwd=cwd,
        env={name: value for name, value in changed.items() if value is not None},
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        check=False,
    )


def printed(*words: object, **options: Any) -> str:
    """What Python prints; it must succeed. Options as of `python`."""
    done = python(*words, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout
