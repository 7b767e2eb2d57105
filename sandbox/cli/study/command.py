"""`sandbox study`: designs, plans and sessions of user studies."""

from __future__ import annotations

import importlib
from typing import Any

from rich.console import Console

from models.errors import unknown_name
from sandbox.cli.common.command_line import parse

ACTIONS = {
    "new": ("check", "NewOptions"),
    "check": ("check", "CheckOptions"),
    "plan": ("plan", "PlanOptions"),
    "sheet": ("plan", "SheetOptions"),
    "run": ("run", "StudyRunOptions"),
    "simulate": ("simulate", "StudySimulateOptions"),
    "tables": ("report", "TablesOptions"),
    "report": ("report", "ReportOptions"),
    "share": ("share", "ShareOptions"),
    "note": ("note", "NoteOptions"),
}
"""Action -> (file in this folder, name of the options in it). The file has a function with the name
of the action."""

FIRST_STEPS = """
First steps:

  sandbox study new design.toml
  sandbox study check design.toml
  sandbox study sheet design.toml
  sandbox study simulate design.toml --out out --participants 2
  sandbox study report out/my-study-simulated

`sandbox study COMMAND --help` explains each command. The page "User studies" of the site explains
the rest; in the repository it is docs/studies.md."""


def main(argv: list[str]) -> int:
    """Runs `sandbox study ...`."""
    if not argv or argv[0] in ("-h", "--help"):
        print("usage: sandbox study {" + ",".join(ACTIONS) + "} [--help]\n")
        for name in ACTIONS:
            options, _ = _action(name)
            print(f"  {name:<9} {(options.__doc__ or '').splitlines()[0]}")
        print(FIRST_STEPS)
        return 0
    if argv[0] not in ACTIONS:
        raise unknown_name("no such command", argv[0], ACTIONS, where="sandbox study")
    options, action = _action(argv[0])
    given = parse(options, f"sandbox study {argv[0]}", argv[1:])
    return int(action(given, Console(soft_wrap=True)))


def _action(name: str) -> tuple[Any, Any]:
    """The options and the function of an action. Only the file of this action is imported."""
    file, options = ACTIONS[name]
    module = importlib.import_module(f"sandbox.cli.study.{file}")
    return getattr(module, options), getattr(module, name)
