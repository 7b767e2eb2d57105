"""`sandbox COMMAND ...` runs the command's module; `sandbox` lists commands, tasks and devices."""

from __future__ import annotations

import errno
import importlib
import sys

from models.errors import HandSandboxError, InputError, unknown_name
from sandbox.cli.common.json_out import HelpExit, prepare, print_no_more
from sandbox.cli.removed import refuse_removed

COMMANDS: dict[str, str] = {
    "demo": "watch the simulated user move a box to its goal; makes a film and a picture",
    "play": "do a task in a window, with the mouse or with fingers on a tablet",
    "run": "do a task without a window, as fast as the machine can",
    "regress": "measure success over many seeds, and compare it with a baseline",
    "replay": "play a recording again and check every state",
    "subject": "make a capture of a simulated subject: touches and poses at the same time",
    "capture": "make a capture from your own recordings of touches and hands",
    "export": "write a hand's motion for other programs: BVH, glTF, AMC, Vicon, C3D, CSV",
    "stream": "send a hand's motion, live, to Maya or Blender",
    "train": "train an encoder on a capture",
    "evaluate": "measure how well encoders reconstruct hands and label fingers: the paper's tables",
    "hand": "profile of your hand: measure size and rest posture, show them, delete layouts",
    "study": "design, run, report and share user studies",
    "doctor": "check what works on this machine, and what to install for the rest",
    "paalm": "joint angles of hands over a Leap (PAALM, paper of 2013): show and calibrate",
    "devices": "show a device's data, simulate a Leap, set up a webcam, fit robot hands",
    "touches": "show, record and send touches: the first thing to try with a new tablet",
}
"""Command -> one line of help. A command is the function `main(argv) -> int` of the module
sandbox/cli/COMMAND.py, or of sandbox/cli/COMMAND/command.py if `IN_FOLDERS` names it."""

IN_FOLDERS = {
    "capture",
    "devices",
    "hand",
    "study",
    "touches",
}

EXIT_DONE, EXIT_GATE_FAILED, EXIT_BAD_INPUT = 0, 1, 2


def _versions() -> str:
    """Returns a line of versions, with the commit if the program runs from a checkout."""
    from sandbox.recording.versions import versions

    numbers = versions()
    at = numbers.get("commit")
    parts = [f"{of} {numbers[of]}" for of in ("hand-sandbox", "mujoco", "python")]
    return ", ".join([parts[0] + (f" (commit {at})" if at else ""), *parts[1:]])


def main(argv: list[str] | None = None) -> int:
    """Entry point of the `sandbox` command.

    Returns:
        Exit status: 0 done (whatever the score), 1 a gate failed, 2 bad input (reported in one
        line, without a traceback), 130 stopped by Ctrl-C.
    """
    args = list(sys.argv[1:] if argv is None else argv)
    prepare()
    name, rest = (args[0], args[1:]) if args else ("--help", [])
    try:
        if name in ("-h", "--help"):
            from sandbox.cli.overview import overview

            print(overview(COMMANDS), flush=True)
            return EXIT_DONE
        if name == "--version":
            print(_versions(), flush=True)
            return EXIT_DONE
        refuse_removed(args)
        if name not in COMMANDS:
            remedy = "`sandbox` without arguments lists them"
            raise unknown_name("no such command", name, COMMANDS, remedy=remedy)
        module = importlib.import_module(
            f"sandbox.cli.{name}.command" if name in IN_FOLDERS else f"sandbox.cli.{name}"
        )
        return int(module.main(rest) or EXIT_DONE)
    except InputError as error:
        print(f"sandbox: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except HandSandboxError as error:
        print(f"sandbox: {error}", file=sys.stderr)
        return EXIT_GATE_FAILED
    except HelpExit:
        raise
    except SystemExit as end:
        # No code of this program raises a plain SystemExit, but a task, device or encoder of a user
        # may. A command that was ended in this way must not exit with 0.
        if end.code not in (0, None):
            raise
        from models.plugins import failure

        print(f"sandbox: somebody else's code ended the program ({failure(end)})", file=sys.stderr)
        return EXIT_GATE_FAILED
    except KeyboardInterrupt:
        print("sandbox: stopped", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader of the output, such as `head`, has closed the pipe: this is not an error.
        # Discard the buffer, which Python would otherwise flush at exit and fail again.
        print_no_more()
        return EXIT_DONE
    except OSError as error:
        # Errors of files are raised as `HandSandboxError`, so this one is of standard output.
        if error.errno not in (errno.ENOSPC, errno.EIO) or error.filename is not None:
            raise
        print_no_more()
        print(f"sandbox: standard output: {error.strerror}", file=sys.stderr)
        return EXIT_GATE_FAILED


if __name__ == "__main__":
    sys.exit(main())
