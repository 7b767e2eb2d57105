"""Poses of many simulated subjects, for searches among more poses than one capture has.

A subject-day takes seconds to simulate, so each is kept in the user's cache as soon as it is made,
under a name that holds the subjects' configuration and the code that makes them. A run that was
stopped goes on where it was. What is in the cache is only ever used by benchmarks.
"""

from __future__ import annotations

import json
import os
from hashlib import blake2b
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import Progress

import encoders.captures.subject
import models
from encoders.captures.subject import FROZEN, simulate
from models.arithmetic.arrays import Array
from models.pose import JOINTS

FIRST_SEED = 1000
"""Seeds of the subjects, one each, all on day 0; none of them trained or judged anything."""

_USED = ("kinematics", "pose", "rotations", "skeleton", "surface")
"""Files of `models` that poses depend on."""


def cache_folder() -> Path:
    """Where this configuration's poses are kept."""
    code = blake2b(json.dumps(FROZEN.as_json(), sort_keys=True).encode(), digest_size=8)
    sources = sorted(Path(encoders.captures.subject.__path__[0]).glob("*.py"))
    sources += [Path(models.__path__[0], f"{name}.py") for name in _USED]
    for source in sources:
        code.update(source.read_bytes())
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "hand-sandbox" / "benchmarks" / f"poses-{code.hexdigest()}"


def joint_poses(subjects: int, console: Console) -> Array:
    """(T, 42) ball joint components, degrees, of so many subjects' training scripts."""
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    parts = []
    with Progress(console=console, transient=True) as progress:
        bar = progress.add_task(f"simulating {subjects} subjects", total=subjects)
        for seed in range(FIRST_SEED, FIRST_SEED + subjects):
            path = folder / f"{seed}.npy"
            if not path.exists():
                joints = simulate(FROZEN, seed, 0).q[:, JOINTS]
                # Another name first: a file of the right name is whole.
                unfinished = path.with_suffix(f".{os.getpid()}")
                with unfinished.open("wb") as file:
                    np.save(file, np.rad2deg(joints).astype(np.float32))
                unfinished.replace(path)
            parts.append(np.load(path))
            progress.advance(bar)
    return np.concatenate(parts).astype(float)
