"""Check that this machine simulates in real time."""

from __future__ import annotations

from sandbox.doctor.check import Check, run_probe

ENOUGH = 1.5
"""Simulated seconds per second that leave a session enough time for its views."""

_PROBE = """
import time
from sandbox.trial.assembly import build
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.trial.settings import Settings
session = build(Settings(), (lambda task, surface: MouseDevice(surface),))
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
    """Simulates a hand with three fingers beside a box for one second, and measures the speed."""
    answer = run_probe(_PROBE, OMP_NUM_THREADS="1")
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
