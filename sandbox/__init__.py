"""The running program: devices, session, views, recordings, command line.

The names in `__all__` are the public API; `docs/from-python.md` explains them. Every other module
may change without notice.

`models` and `tasks` are common names. Where somebody's `models.py` comes first on the import path,
half of this program would silently be theirs, and the first sign would be a strange AttributeError
far from the cause. So importing `sandbox` looks, without importing anything, at where its
neighbours would come from, and refuses at once if one of them is not its own.
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
    """Another module stands where one of our packages should be.

    The one error outside the tree of `models.errors`: it is raised exactly when `models` may not be
    ours. `name` is the package, `path` the file in the way (None where the package is missing).
    """


def _place_of(name: str) -> str | None:
    """The file (or bare folder) that `import name` gives or would give; None if nothing does."""
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
    # A folder without __init__.py has no origin, yet it hides a package of an editable install.
    return spec.origin or (folders[0] if folders else repr(spec.loader))


def _same_place(place: str, folder: str) -> bool:
    """True if `place` is the package in `folder`, with links and letter case resolved."""
    head, tail = os.path.split(place)
    package = head if os.path.splitext(tail)[0] == "__init__" else place
    return os.path.normcase(os.path.realpath(package)) == os.path.normcase(os.path.realpath(folder))


def _refuse_shadowed_neighbours() -> None:
    """Compares where each neighbour comes from with the folder next to this package.

    Raises:
        ShadowedPackageError: One of them is somebody else's, or missing.
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
    """Says in one line that another package's files are among those of our neighbours.

    Raises:
        ShadowedPackageError: Files of ours were replaced by another package's, or are gone.
    """
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    for name, (strange, changed) in mixed_up(home, _NEIGHBOURS).items():
        where = os.path.join(home, name)
        if changed:
            raise ShadowedPackageError(
                f"another package has replaced files of the package `{name}` (got another "
                f"{changed[0]!r} in {where!r}). Install hand-sandbox in an environment of its own, "
                "or again: `pip install --force-reinstall --no-deps hand-sandbox`",
                name=name,
                path=os.path.join(where, changed[0]),
            )
        line = (
            f"another package has installed files into the package `{name}` ({strange[0]!r} in "
            f"{where!r}); one of the two may fail. Install hand-sandbox in an environment of its "
            "own"
        )
        if _is_own_command():
            print(f"sandbox: {line}", file=sys.stderr)
        else:
            warnings.warn(line, stacklevel=2)


def _is_own_command() -> bool:
    """True if this process is `sandbox ...` itself, not a program that imports us."""
    if sys.argv[:1] == ["-m"]:
        # runpy is still looking for the module to run; only orig_argv has its name.
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
    # A person typed the command: one line and the exit status of bad input. The command line's own
    # handler cannot do it, since its module is never reached.
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
