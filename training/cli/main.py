"""`python -m training COMMAND ...`: runs a command and prints errors in one line."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence

from models.errors import HandSandboxError, InputError, unknown_name
from sandbox.cli.common.json_out import prepare
from training.shipped import FILES

COMMANDS: dict[str, str] = {
    "people": "make a population of simulated people to train and judge on",
    **{name: f"make {file.path}: {file.about}" for name, file in FILES.items()},
    "all": "make all files that ship, into a folder",
    "strangers": "measure the models on people who took no part in the training",
    "tables": "the tables of `sandbox evaluate` on the second simulated subject",
}
"""Command -> one line of help. training/cli/shipped_file.py contains the commands that make files
that ship. Any other command is in training/cli/COMMAND.py."""

EXIT_DONE, EXIT_DIFFERS, EXIT_BAD_INPUT = 0, 1, 2


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command.

    Returns:
        0: done; 1: a file differs from the shipped file, or a computation failed; 2: bad input;
        130: interrupted.
    """
    args = list(sys.argv[1:] if argv is None else argv)
    prepare()
    name, rest = (args[0], args[1:]) if args else ("--help", [])
    try:
        if name in ("-h", "--help"):
            print(_overview())
            return EXIT_DONE
        if name in FILES or name == "all":
            from training.cli.shipped_file import make_all, make_one

            return make_all(rest) if name == "all" else make_one(name, rest)
        if name not in COMMANDS:
            remedy = "`python -m training` lists them"
            raise unknown_name("no such command", name, COMMANDS, remedy=remedy)
        return int(importlib.import_module(f"training.cli.{name}").main(rest))
    except InputError as error:
        print(f"training: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except HandSandboxError as error:
        print(f"training: {error}", file=sys.stderr)
        return EXIT_DIFFERS
    except KeyboardInterrupt:
        print("training: stopped", file=sys.stderr)
        return 130


def _overview() -> str:
    width = max(map(len, COMMANDS))
    lines = [f"  {name:<{width}}  {about}" for name, about in COMMANDS.items()]
    return "\n".join(
        [
            "usage: python -m training COMMAND [--help]",
            "",
            "Makes the models that ship with Hand Sandbox, and judges them. training/README.md",
            "explains the commands.",
            "",
            *lines,
        ]
    )
