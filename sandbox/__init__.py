"""The running program: devices, session, views, recordings, command line.

The names in `__all__` are the public API; `docs/from-python.md` explains them. Every other module
may change without notice.

`models` and `tasks` are common names. If another `models.py` comes first on the import path, this
program would use it, and fail with an AttributeError far from the cause. Therefore `import sandbox`
first checks, without importing them, from which files the packages `models`, `encoders` and `tasks`
would be loaded. It raises an error if a package is not the one beside `sandbox`.
"""

from __future__ import annotations

import importlib.util
import os
import sys
import warnings
from itertools import pairwise
from typing import TYPE_CHECKING

from sandbox.foreign_files import mixed_up

_NEIGHBOURS = ("models", "encoders", "tasks")
_EXIT_BAD_INPUT = 2


class ShadowedPackageError(ImportError):
    """Another module would be imported in place of a package of Hand Sandbox.

    This error is not in the tree of `models.errors`, since `models` itself may be the wrong module.
    `name` is the package, `path` the file of the other module (None if the package is missing).
    """


def _place_of(name: str) -> str | None:
    """The file, or folder without `__init__.py`, that `import name` loads; None if it fails."""
    if name in sys.modules:
        module = sys.modules[name]
        if module is None:
            return None
        folders = list(getattr(module, "__path__", ()))
        return getattr(module, "__file__", None) or (folders[0] if folders else repr(module))
    spec = importlib.util.find_spec(name)
    if spec is None:
        return None
    folders = list(spec.submodule_search_locations or ())
    # A folder without __init__.py has no origin, but it hides a package of an editable install.
    return spec.origin or (folders[0] if folders else repr(spec.loader))


def _same_place(place: str, folder: str) -> bool:
    """True if `place` is the package in `folder`, with links and letter case resolved."""
    head, tail = os.path.split(place)
    package = head if os.path.splitext(tail)[0] == "__init__" else place
    return os.path.normcase(os.path.realpath(package)) == os.path.normcase(os.path.realpath(folder))


def _refuse_shadowed_neighbours() -> None:
    """Checks that each neighbouring package is loaded from the folder beside this package.

    Raises:
        ShadowedPackageError: A package is missing, or another module would be loaded.
    """
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    for name in _NEIGHBOURS:
        own = os.path.join(home, name)
        place = _place_of(name)
        if place is None:
            raise ShadowedPackageError(
                f"the package `{name}` is missing (expected {own!r}). Install hand-sandbox again",
                name=name,
            )
        if not _same_place(place, own):
            raise ShadowedPackageError(
                f"another module is in the way of the package `{name}` (got {place!r}, expected "
                f"{own!r}). Rename it, or keep its folder off the import path: `python -P`, "
                "`PYTHONSAFEPATH=1`, or under pytest `--import-mode=importlib`; look at PYTHONPATH "
                "if that is set",
                name=name,
                path=place,
            )


def _check_for_foreign_files() -> None:
    """Warns in one line if another package has installed files into a neighbouring package.

    Raises:
        ShadowedPackageError: Files of a neighbouring package were replaced or are missing.
    """
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    for name, (strange, changed) in mixed_up(home, _NEIGHBOURS).items():
        where = os.path.join(home, name)
        if changed:
            raise ShadowedPackageError(
                f"another package has replaced files of the package `{name}` (got another "
                f"{changed[0]!r} in {where!r}). Install hand-sandbox in its own environment, or "
                "reinstall it here: `pip install --force-reinstall --no-deps hand-sandbox`",
                name=name,
                path=os.path.join(where, changed[0]),
            )
        line = (
            f"another package has installed files into the package `{name}` ({strange[0]!r} in "
            f"{where!r}); one of the two packages may fail. Install hand-sandbox in its own "
            "environment"
        )
        if _is_own_command():
            print(f"sandbox: {line}", file=sys.stderr)
        else:
            warnings.warn(line, stacklevel=2)


def _is_own_command() -> bool:
    """True if this process is the command `sandbox`, not a program that imports this package."""
    if sys.argv[:1] == ["-m"]:
        # runpy is still searching for the module to run. Only orig_argv has the module's name.
        return any(
            flag.startswith("-") and flag.endswith("m") and target.partition(".")[0] == __name__
            for flag, target in pairwise(sys.orig_argv)
        )
    launcher = os.path.basename(sys.argv[0]) if sys.argv else ""
    return launcher.lower().removesuffix(".exe") == __name__


try:
    _refuse_shadowed_neighbours()
    _check_for_foreign_files()
except ShadowedPackageError as _error:
    if not _is_own_command():
        raise
    # If `sandbox` was run as a command, print the error in one line and exit with the status for
    # bad input. The command line's own handler is in a module that is not loaded yet.
    print(f"sandbox: {_error}", file=sys.stderr)
    sys.exit(_EXIT_BAD_INPUT)

from models import lazy_names  # noqa: E402

if TYPE_CHECKING:
    from sandbox.devices.check_device import check_device
    from sandbox.devices.device import Device, DeviceEntry, HandDevice, TouchDevice
    from sandbox.library.trajectories import Trajectories
    from sandbox.library.trial_run import TrialRun, export_motion, replay_recording, run_trial
    from sandbox.recording.recording import Recording, load_recording
    from sandbox.session.messages import Snapshot
    from sandbox.session.session import Session
    from sandbox.trial.settings import Settings
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Device": "sandbox.devices.device",
            "DeviceEntry": "sandbox.devices.device",
            "HandDevice": "sandbox.devices.device",
            "Recording": "sandbox.recording.recording",
            "Settings": "sandbox.trial.settings",
            "Session": "sandbox.session.session",
            "Snapshot": "sandbox.session.messages",
            "TouchDevice": "sandbox.devices.device",
            "Trajectories": "sandbox.library.trajectories",
            "TrialRun": "sandbox.library.trial_run",
            "check_device": "sandbox.devices.check_device",
            "export_motion": "sandbox.library.trial_run",
            "load_recording": "sandbox.recording.recording",
            "replay_recording": "sandbox.library.trial_run",
            "run_trial": "sandbox.library.trial_run",
        },
    )

__all__ = [
    "Device",
    "DeviceEntry",
    "HandDevice",
    "Recording",
    "Session",
    "Settings",
    "ShadowedPackageError",
    "Snapshot",
    "TouchDevice",
    "Trajectories",
    "TrialRun",
    "check_device",
    "export_motion",
    "load_recording",
    "replay_recording",
    "run_trial",
]
