"""`sandbox devices`: commands about devices, each in a module that is imported when needed."""

from __future__ import annotations

from sandbox.cli.common.command_line import application, run

PARTS = {
    "leap": "Replaces a Leap: simulated recordings, a fake service; lists the formats.",
    "webcam": "Hands in front of a webcam: installs MediaPipe, records landmarks.",
    "robot": "Robot hands: fits a robot hand of your own, lists the known ones.",
}
"""Subcommand -> help. Each is `app` in the module sandbox/cli/devices/SUBCOMMAND.py."""
SHOW = "Shows the data of a device or a file: rate, sizes, units, left-out data with reasons."


def main(argv: list[str]) -> int:
    """Runs `sandbox devices ...`; returns the exit status."""
    app = application(
        "sandbox devices",
        "Shows data of devices; commands for a Leap, a webcam and robot hands.",
    )
    if argv[:1] == ["show"]:
        # Without `help`, the full docstring of `show` is its help.
        app.command("sandbox.cli.devices.show:show", name="show")
        if argv[1:] and not argv[1].startswith("-"):
            argv = ["show", "--device", *argv[1:]]
    else:
        app.command("sandbox.cli.devices.show:show", name="show", help=SHOW)
    for part, text in PARTS.items():
        app.command(f"sandbox.cli.devices.{part}:app", name=part, help=text)
    return int(run(app, argv) or 0)
