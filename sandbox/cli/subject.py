"""`sandbox subject`: makes captures of a simulated subject."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from encoders.capture import save_capture
from encoders.captures.subject import FROZEN, SEED, simulate
from models.errors import InputError
from sandbox.cli.common.command_line import parse


@dataclass(frozen=True, kw_only=True)
class SubjectOptions:
    """Makes a capture of a SIMULATED subject: touches of its fingers, and poses of its hand.

    The simulated subject replaces the motion capture of a person, because no such recording is
    public. Its data are simulated, not real. Every seed gives a different subject. Day 0 is the
    training script: all 26 sets of 2 to 5 fingers, each of which moves, grasps, pinches and
    rotates, 7,083 frames. Every later day is free play with newly placed markers, 2,538 frames, for
    tests. The same seed and day give the same file. A capture is an .npz file: time (s), trial,
    ids, xy (m on the surface, x right, y down, by finger), q (48 numbers in m and rad), and a
    header.

    Try:

        sandbox subject --seed 7 --day 0 --out training.npz
        sandbox train --capture training.npz --out mine.npz
    """

    out: Annotated[Path, Parameter(metavar="FILE")]
    """File for the capture; an existing file is replaced."""

    seed: int = SEED
    """Number of the subject. The built-in models are trained on subject 0."""

    day: int = 0
    """Day: 0 is the training script, 1 and later are free play."""


def main(argv: list[str]) -> int:
    """Runs `sandbox subject ...`."""
    options = parse(SubjectOptions, "sandbox subject", argv)
    if not options.out.absolute().parent.is_dir():
        raise InputError(
            "no such folder", where=f"--out {options.out}", remedy="Create it, or name another"
        )
    console = Console()
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task(f"subject {options.seed}, day {options.day}", total=1.0)
        capture = simulate(
            FROZEN, options.seed, options.day, lambda share: progress.update(bar, completed=share)
        )
    try:
        save_capture(capture, options.out, np.float32)
    except OSError as error:
        raise InputError(
            "the capture cannot be written",
            where=f"--out {options.out}",
            got=str(error),
            remedy="Name another file",
        ) from error
    fingers = capture.down.sum(axis=1)
    split = ", ".join(f"{(fingers == n).sum():,} with {n}" for n in range(2, 6))
    console.print(
        f"{escape(str(options.out))}: {len(capture):,} frames at {capture.meta['rate_hz']:g} Hz in "
        f"{len(np.unique(capture.trial))} takes ({split} fingers), simulated",
        soft_wrap=True,
    )
    return 0
