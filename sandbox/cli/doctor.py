"""`sandbox doctor`: checks what works on this machine, and how to fix the rest."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sandbox.cli.common.command_line import parse
from sandbox.doctor import Check
from sandbox.doctor.devices import device_checks, graphics_checks
from sandbox.doctor.system import package_checks, speed_check, system_checks
from sandbox.recording.versions import versions

SCHEMA = 1
"""Version of the JSON."""

GROUPS = ("program", "pictures", "devices", "files", "extras")


@dataclass(frozen=True, kw_only=True)
class DoctorOptions:
    """Checks this machine: what works, what is missing, and how to fix it.

    The command changes nothing. Checks that may crash (OpenGL without a screen) run in another
    process.
    """

    json: bool = False
    """Print all results as JSON."""

    strict: bool = False
    """Exit status 1 if anything is missing, for scripts."""


def main(argv: list[str]) -> int:
    """Runs `sandbox doctor ...`."""
    options = parse(DoctorOptions, "sandbox doctor", argv)
    checks = run_checks()
    if options.json:
        print(json.dumps(as_json(checks), indent=1))
    else:
        show(checks, Console())
    return int(options.strict and any(not c.ok for c in checks))


def run_checks() -> list[Check]:
    """Runs all checks; returns them in the order of groups."""
    checks = [*system_checks(), speed_check(), *package_checks()]
    checks += [*graphics_checks(), *device_checks()]
    return sorted(checks, key=lambda check: GROUPS.index(check.group))


def as_json(checks: list[Check]) -> dict[str, Any]:
    """Returns the checks as JSON values."""
    return {
        "schema": SCHEMA,
        "checks": [check.as_json() for check in checks],
        "missing": [check.name for check in checks if not check.ok],
        "versions": versions(),
    }


def show(checks: list[Check], console: Console) -> None:
    """Prints a table of the checks, then remedies for missing items."""
    table = Table("", "what", "state", "found", box=None, pad_edge=False)
    last = ""
    for check in checks:
        state = "[green]ok[/]" if check.ok else "[yellow]missing[/]"
        group = "" if check.group == last else f"[bold]{check.group}[/]"
        last = check.group
        table.add_row(group, check.name, state, escape(check.found))
    console.print(table)
    missing = [check for check in checks if not check.ok]
    if not missing:
        console.print("\nNothing is missing.")
        return
    console.print("\n[bold]missing items, their use, and remedies[/]")
    for check in missing:
        use = f", for {check.needed_for}" if check.needed_for else ""
        console.print(f"[yellow]{check.name}[/]{escape(use)}", soft_wrap=True, highlight=False)
        console.print(f"    {escape(check.remedy)}", soft_wrap=True, highlight=False)
