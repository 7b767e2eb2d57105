"""`sandbox COMMAND ...`: finds the command's module, and turns our errors into one clear line."""

from __future__ import annotations

import importlib
import sys
from importlib.metadata import entry_points

from models.errors import HandSandboxError, InputError

COMMANDS: dict[str, str] = {
    "demo": "the simulated user brings a box to its goal; ends with score, film and picture",
    "play": "do a task in a window, with the mouse or a tablet as fingers",
    "run": "do a task without a window, as fast as it goes",
    "regress": "success over many seeds, and whether it is less than it was",
    "replay": "play a recording again and check every state",
    "subject": "make a capture of a simulated subject: touches and poses at the same time",
    "capture": "make a capture of your own recordings of touches and hands",
    "train": "train an encoder on a capture, or the built-in ones anew",
    "evaluate": "measure how well methods reconstruct hands and name fingers: the paper's tables",
    "calibrate": "measure a hand against the trained one, so that it fits any person's",
    "study": "user studies: designs, sessions, and a record that nothing can lose",
    "touches": "show, send and describe touches: the first thing to try with a new tablet",
}
"""Command -> one line of help. Each lives in sandbox/cli/COMMAND.py as `main(argv) -> int`."""

EXIT_DONE, EXIT_GATE_FAILED, EXIT_BAD_INPUT = 0, 1, 2


def main(argv: list[str] | None = None) -> int:
    """Entry point of the `sandbox` command.

    Returns:
        0 done (whatever the score), 1 a gate failed, 2 bad input: one clear line, no traceback.
    """
    args = list(sys.argv[1:] if argv is None else argv)
    if not args or args[0] in ("-h", "--help"):
        print(overview())
        return EXIT_DONE
    name, rest = args[0], args[1:]
    try:
        if name not in COMMANDS:
            raise InputError(
                "there is no such command",
                got=name,
                expected=", ".join(COMMANDS),
                remedy="`sandbox` alone lists what there is",
            )
        module = importlib.import_module(f"sandbox.cli.{name}")
        return int(module.main(rest) or EXIT_DONE)
    except InputError as error:
        print(f"sandbox: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except HandSandboxError as error:
        print(f"sandbox: {error}", file=sys.stderr)
        return EXIT_GATE_FAILED
    except KeyboardInterrupt:
        print("sandbox: stopped", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader of our output left, as `head` does; that is no error of ours.
        sys.stderr.close()
        return EXIT_DONE


def overview() -> str:
    """What the program can do, one line a command."""
    width = max(map(len, COMMANDS))
    lines = ["usage: sandbox COMMAND [--help]", "", "commands"]
    lines += [f"  {name:<{width}}  {text}" for name, text in COMMANDS.items()]
    lines += [
        "",
        "tasks",
        "  box-to-goal     bring a box onto its translucent twin",
        "  wrench-turn     turn a wrench on its bolt, and no further than its twin",
        "  wrench-slide    turn and slide a free wrench onto its twin",
        "  stack           put a box on another one, with a second control that lifts",
        "  stack-three     a third box on the second",
        "  stack-vertical  two boxes seen from the front: dragging up lifts",
    ]
    lines += _own_tasks()
    lines += [
        "",
        "devices",
        "  simulated  a simulated user, who only touches",
        "  mouse      in the window: drag, pin fingers, keys 1 to 5 for a whole hand",
        "  tuio       a tablet, table or simulator that sends TUIO 1.1 over UDP",
        "  FILE       a recording of ours, or a capture of TUIO packets",
    ]
    lines += [
        "",
        "try first",
        "  sandbox demo",
        "  sandbox play box-to-goal",
        "  sandbox touches show          with a tablet at hand",
        "  sandbox run box-to-goal --fingers 5 --seed 7 --record run.jsonl",
    ]
    return "\n".join(lines)


def _own_tasks() -> list[str]:
    """What installed packages add to the tasks, and why not where they cannot."""
    if not entry_points(group="hand_sandbox.tasks"):
        # Nobody has any: nothing heavy is imported for a page of text.
        return []
    from tasks.registry import TASKS, task_names, unusable_tasks

    broken = unusable_tasks()
    own = [f"  {name}" for name in task_names() if name not in TASKS and name not in broken]
    return own + [f"  {name}: {why}" for name, why in sorted(broken.items())]


if __name__ == "__main__":
    sys.exit(main())
