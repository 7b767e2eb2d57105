"""`sandbox devices`: what goes with devices, each in a module that is imported when it is named."""

from __future__ import annotations

from sandbox.cli.common.command_line import application, run

PARTS = {
    "leap": "Replaces a Leap: simulated recordings, a fake service; lists the formats.",
    "webcam": "Hands before a webcam: installs what finds them, records landmarks.",
    "robot": "Robots' hands in the place of ours: fits one of your own, lists known ones.",
}
"""Part -> its help. Each is `app` in sandbox/cli/devices/PART.py."""


def main(argv: list[str]) -> int:
    """Runs `sandbox devices ...`; returns the exit status."""
    app = application("sandbox devices", "What goes with a Leap, a webcam and robots' hands.")
    for part, about in PARTS.items():
        app.command(f"sandbox.cli.devices.{part}:app", name=part, help=about)
    return int(run(app, argv) or 0)
