"""Checks whether this machine simulates in real time."""

from __future__ import annotations

from sandbox.doctor.check import Check, ask

ENOUGH = 1.5
"""Simulated seconds per second from which on a session has time to spare for its views."""

_PROBE = """
import time
from sandbox.trial.assembly import build
from sandbox.devices.mouse import MouseDevice
from sandbox.trial.settings import RunSettings
session = build(RunSettings(), (lambda task, surface: MouseDevice(surface),))
surface = session.rigs[0].reconstructor.surface
session.rigs[0].device.hand(3, surface.to_surface(session.task.objects[0].position))
while session.time < 1.5:
    session.advance()
begun, since = time.perf_counter(), session.time
while session.time < since + 1.0:
    session.advance()
print((session.time - since) / (time.perf_counter() - begun))
"""


def speed_check() -> Check:
    """A hand of three fingers beside a box, for a second of simulated time."""
    answer = ask(_PROBE, OMP_NUM_THREADS="1")
    use = "sessions in real time"
    if not answer.ok:
        return Check(
            "program", "speed", False, answer.text, use, "Run the tests: `python -m pytest`"
        )
    speed = float(answer.text)
    return Check(
        "program",
        "speed",
        speed >= ENOUGH,
        f"simulates {speed:.1f} times as fast as real time",
        use,
        "" if speed >= ENOUGH else "Close other programs; `s` in the window slows time down",
    )
