"""`sandbox devices`: what goes with devices, each in a module that is imported when it is named."""

from __future__ import annotations

from sandbox.cli.common.command_line import application, run

PARTS = {
    "leap": "Replaces a Leap: simulated recordings, a fake service; lists the formats.",
    "webcam": "Hands before a webcam: installs what finds them, records landmarks.",
    "robot": "Robots' hands in the place of ours: fits one of your own, lists known ones.",
}
"""Part -> its help. Each is `app` in sandbox/cli/devices/PART.py."""
SHOW = "Shows what a device or a file sends: rate, sizes, units, what is left out and why."


def main(argv: list[str]) -> int:
    """Runs `sandbox devices ...`; returns the exit status."""
    app = application(
        "sandbox devices",
        "What devices send, and what goes with a Leap, a webcam and robots' hands.",
    )
    if argv[:1] == ["show"]:
        # Its own help is longer than its line in the list.
        app.command("sandbox.cli.devices.show:show", name="show")
        if argv[1:] and not argv[1].startswith("-"):
            argv = ["show", "--device", *argv[1:]]
    else:
        app.command("sandbox.cli.devices.show:show", name="show", help=SHOW)
    for part, text in PARTS.items():
        app.command(f"sandbox.cli.devices.{part}:app", name=part, help=text)
    return int(run(app, argv) or 0)
