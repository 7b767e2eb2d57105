"""`sandbox` without arguments: lists of commands, tasks, devices and first steps.

It is a separate module because it loads all devices, which other commands do not need.
"""

from __future__ import annotations

from collections.abc import Mapping

from models.plugins import package
from sandbox.devices.registry import DEVICE_PLUGINS, DEVICES
from sandbox.views.display import has_display


def overview(commands: Mapping[str, str]) -> str:
    """Returns the lists of commands, tasks, devices and first steps.

    Args:
        commands: Command -> one line of help.
    """
    from tasks.registry import TASKS

    tasks = {name: _first_sentence(task.__doc__ or "") for name, task in TASKS.items()}
    tasks["FILE.py"] = "a task of your own"
    lines = ["usage: sandbox COMMAND [--help], sandbox --version"]
    lines += ["", "commands", *_columns(commands)]
    lines += ["", "tasks", *_columns(tasks), *_installed_tasks()]
    lines += ["", "devices", *_columns(devices()), *_installed_devices()]
    lines += ["", "try first", *(f"  {line}" for line in first_steps())]
    return "\n".join(lines)


def devices() -> dict[str, str]:
    """Returns device -> description."""
    known = {name: entry.help for name, entry in DEVICES.items()}
    return {**known, "FILE": "a file that plays as a device: `sandbox touches formats` lists them"}


def first_steps() -> list[str]:
    """Returns command lines to begin with, the easiest first."""
    from tasks.registry import TASKS

    first = next(iter(TASKS))
    lifts = next(name for name, task in TASKS.items() if task.lift_range > 0)
    play = f"sandbox play {first}" + ("" if has_display() else " --view web")
    return [
        "sandbox demo",
        play,
        f"sandbox play {lifts} --tablet",
        "sandbox doctor",
        f"sandbox run {first} --seed 7 --record run.jsonl",
    ]


def _columns(rows: Mapping[str, str]) -> list[str]:
    width = max(map(len, rows))
    return [f"  {name:<{width}}  {text}" for name, text in rows.items()]


def _installed_tasks() -> list[str]:
    """Lists tasks of installed packages, with the reason for each that cannot be used."""
    from tasks.registry import TASKS, task_names, unusable_tasks

    broken = unusable_tasks()
    own = [f"  {name}" for name in task_names() if name not in TASKS and name not in broken]
    return own + [f"  {name}: {why}" for name, why in sorted(broken.items())]


def _installed_devices() -> list[str]:
    """Lists devices of installed packages; a device is checked only when it is used."""
    return [
        f"  {name}  offered by {', '.join(map(package, entries))}"
        for name, entries in DEVICE_PLUGINS.offered().items()
    ]


def _first_sentence(text: str) -> str:
    """Returns the first sentence without full stop and with a small first letter."""
    line = (text.strip().splitlines() or [""])[0].split(". ")[0].rstrip(".")
    is_abbreviation = line[1:2].isupper()
    return line if is_abbreviation else line[:1].lower() + line[1:]
