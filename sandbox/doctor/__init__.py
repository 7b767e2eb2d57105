"""Checks of this machine, with remedies for failed checks (`sandbox doctor`).

A check has a result. Checks that may crash are probes in another process.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

PATIENCE = 60.0
"""Timeout of a probe, s. The first use of OpenGL takes seconds on a machine without a graphics
card."""


@dataclass(frozen=True)
class Check:
    """Result of a check.

    Attributes:
        group: Heading in the list.
        name: Name of the checked item.
        ok: True if it exists and works.
        found: Details, or the reason why it does not work.
        needed_for: Functions that need it.
        remedy: Next step if it is missing; else empty.
    """

    group: str
    name: str
    ok: bool
    found: str
    needed_for: str = ""
    remedy: str = ""

    def as_json(self) -> dict[str, Any]:
        """Returns all values, with `state` (`ok` or `missing`) in place of `ok`."""
        values = asdict(self)
        values["state"] = "ok" if values.pop("ok") else "missing"
        return values


@dataclass(frozen=True)
class ProbeResult:
    """Result of a probe: True if it succeeded, and the last line of its output."""

    ok: bool
    text: str


def run_probe(code: str, patience: float = PATIENCE, **environment: str) -> ProbeResult:
    """Runs Python code in another process, so that a crash of a driver does not end this one.

    Args:
        code: Code that prints its result as the last line of standard output.
        patience: Timeout, s.
        environment: Additional environment variables.
    """
    root = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH", "")]))
    try:
        done = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONPATH": path, **environment},
            capture_output=True,
            text=True,
            errors="replace",
            timeout=patience,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return ProbeResult(False, f"the probe had no answer after {patience:.0f} s")
    if done.returncode < 0:
        number = -done.returncode
        known = {s.value: s.name for s in signal.Signals}
        return ProbeResult(False, f"the probe was ended by {known.get(number, f'signal {number}')}")
    lines = (done.stdout if done.returncode == 0 else done.stderr).strip().splitlines()
    last = lines[-1].strip() if lines else f"the probe ended with {done.returncode}"
    return ProbeResult(done.returncode == 0, last)
