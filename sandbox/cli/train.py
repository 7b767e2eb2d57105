"""`sandbox train`: trains encoders on captures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from encoders.capture import Capture, load_capture
from encoders.evaluation.person_model import train_person
from encoders.regression.encoder_registry import find_encoder
from encoders.regression.trained import TrainedModel, builtin_capture
from encoders.regression.training import save_model, train, train_encoder
from models.errors import InputError
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, refuse_replacing


@dataclass(frozen=True, kw_only=True)
class TrainOptions:
    """Trains an encoder, which estimates the pose of the whole hand from touches.

    By default, cross-validation over takes chooses the encoder and the weight of the touches in
    its correction; the model has the bone lengths of the captured person. --degree trains a
    polynomial of the paper instead, and --encoder an encoder of your own
    (docs/write-an-encoder.md).

    --capture names the data: a capture by `sandbox subject` or `sandbox capture`, or your own in
    the same format.

    Try:

        sandbox train --capture training.npz --out mine.npz
        sandbox run box-to-goal --encoder mine.npz
        sandbox train --encoder examples/kernel_ridge.py:KernelRidge --out kernel.npz
    """

    out: Annotated[Path, Parameter(metavar="MODEL")]
    """File for the model."""

    capture: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Capture to train on. With --encoder, the default is the built-in capture."""

    degree: int | None = None
    """Train a polynomial of this degree: 1, 2 or 3. Degree 2 is that of the paper, and the default
    with --ridge."""

    ridge: float | None = None
    """Ridge penalty on the polynomial's coefficients; 0 is least squares, as in the paper. Default:
    chosen by cross-validation over takes."""

    encoder: Annotated[str | None, Parameter(metavar="NAME|FILE.py:CLASS")] = None
    """Train an encoder of your own: FILE.py:CLASS, MODULE:CLASS, or its NAME in an installed
    package."""


def main(argv: list[str]) -> int:
    """Runs `sandbox train ...`."""
    options = parse(TrainOptions, "sandbox train", argv)
    if options.encoder is not None:
        for name, given in (
            ("--degree", options.degree is not None),
            ("--ridge", options.ridge is not None),
        ):
            if given:
                raise InputError(
                    "this option does not apply to an encoder of your own",
                    where=name,
                    got=f"--encoder {options.encoder}",
                    remedy=f"Leave out {name} or --encoder",
                )
    elif options.capture is None:
        raise InputError("no capture to train on", where="sandbox train", expected="--capture FILE")
    console = Console()
    check_output(options.out, "--out")
    refuse_replacing(options.out, {"--capture": options.capture})
    try:
        capture = load_capture(options.capture) if options.capture else builtin_capture()
        return _train_encoder(options, capture, console)
    except OSError as error:
        raise InputError(
            "the model cannot be written",
            where=f"--out {options.out}",
            got=str(error),
            remedy="Name another file",
        ) from error


def _train_encoder(options: TrainOptions, capture: Capture, console: Console) -> int:
    degree = 2 if options.degree is None and options.ridge is not None else options.degree
    bars = Console(stderr=True)
    # Without a terminal, a bar would leave an empty line beside an error.
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task("training", total=1.0)

        def show(share: float) -> None:
            progress.update(bar, completed=share)

        if options.encoder is not None:
            kind = find_encoder(options.encoder)
            model = train_encoder(capture, options.out.stem, kind, show)
        elif degree is None:
            model = train_person(capture, options.out.stem, show)
        else:
            model = train(capture, options.out.stem, degree, options.ridge)
    save_model(model, options.out)
    _report(console, options.out, model)
    return 0


def _report(console: Console, path: Path, model: TrainedModel) -> None:
    spread = np.sqrt(np.diag(model.residual_covariance))
    wrist = 100 * float(np.linalg.norm(spread[:3]))
    source = "simulated" if model.meta["simulated"] else "not marked as simulated"
    console.print(
        f"{escape(str(path))}: {_kind(model)}, "
        f"{len(model.training_u):,} frames ({source}); error of the wrist on unseen takes "
        f"{wrist:.1f} cm (root mean square, outliers bounded)",
        soft_wrap=True,
    )


def _kind(model: TrainedModel) -> str:
    if model.correction is not None:
        variance = f"variance of the touches times {model.correction.distrust:g}"
        return f"{model.meta['winner']}, {variance}"
    if "degree" in model.meta:
        return f"degree {model.meta['degree']}, ridge {model.meta['ridge']:g}"
    return type(model.encoder).__qualname__
