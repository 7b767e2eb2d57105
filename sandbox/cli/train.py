"""`sandbox train`: trains encoders on captures, and the built-in ones again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tyro
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from encoders.capture import Capture
from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.evaluation.best import train_best_model
from encoders.regression.registry import find_encoder
from encoders.regression.trained import (
    BUILTIN,
    POLYNOMIALS,
    TrainedModel,
    builtin,
    builtin_capture,
    load_model,
    save_model,
    train,
    train_encoder,
)
from encoders.store import load_capture, save_capture
from models.errors import InputError
from sandbox.cli.common.json_out import check_output, refuse_replacing
from sandbox.cli.common.parse import parse
from training.names import train_names
from training.population import load_population
from training.pose import train_population

SAME_POSE = 1e-4
"""m and rad; poses that differ by less count as equal."""

DIFFERENT_FRAMES = 0.01
"""Share of frames that may differ: processors round differently, and where two postures are equally
likely, rounding may decide between them."""

SAME_PREDICTION = 1e-3
"""m and rad; greatest root mean square difference of predictions."""


@dataclass(frozen=True)
class TrainOptions:
    """Trains an encoder, which estimates the pose of the whole hand from touches.

    The method is that of `best`: the encoder that wins a cross-validation over takes, with the
    bones of the captured person and a validated weight of the touches. --degree chooses a
    polynomial of the paper instead, and --encoder an encoder of your own
    (docs/write-an-encoder.md).

    --capture names the data: a capture by `sandbox subject` or `sandbox capture`, or your own in
    the same format. --builtin trains the built-in models again on the simulated subject and
    compares them with the shipped ones: at most 1 % of frames may differ by more than 0.0001 (m,
    rad), and predictions by 0.001 (root mean square); exit status 1 if they do. This takes a
    minute or two.

    --population trains what serves people whom nobody captured: names of fingers, or the pose.
    A capture of your own is the way to more than that.

    Try:

        sandbox train --capture training.npz --out mine.npz
        sandbox run box-to-goal --encoder mine.npz
        sandbox train --population people.npz --part pose --out population.npz
        sandbox train --encoder examples/kernel_ridge.py:KernelRidge --out kernel.npz
    """

    out: Annotated[Path, tyro.conf.arg(metavar="MODEL|DIR")]
    """File for the model; with --builtin, folder for all models."""

    capture: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Capture to train on. With --encoder, the default is the built-in capture."""

    population: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Train for people whom nobody knows, on a population of simulated people, made by `sandbox
    subject population`: the names of fingers, or what --part says."""

    part: Literal["names", "pose"] = "names"
    """With --population, what is trained: names of fingers (--labels population), or the encoder of
    the pose (--encoder population)."""

    builtin: bool = False
    """Train the built-in models again and compare them with the shipped ones."""

    degree: int | None = None
    """Train a polynomial of this degree: 1, 2 (that of the paper, and the default with --ridge) or
    3."""

    ridge: float | None = None
    """Ridge penalty on the polynomial's coefficients; 0 is least squares, as in the paper. Default:
    chosen by cross-validation over takes."""

    encoder: Annotated[str | None, tyro.conf.arg(metavar="NAME|FILE.py:CLASS")] = None
    """Train an encoder of your own: FILE.py:CLASS, MODULE:CLASS, or its NAME in an installed
    package."""


def main(argv: list[str]) -> int:
    """Runs `sandbox train ...`."""
    options = parse(TrainOptions, "sandbox train", argv)
    if options.encoder is not None:
        for name, given in (
            ("--builtin", options.builtin),
            ("--degree", options.degree is not None),
            ("--ridge", options.ridge is not None),
        ):
            if given:
                raise InputError("this option does not apply to an encoder of your own", where=name)
    elif options.population is not None:
        for name, given in (
            ("--builtin", options.builtin),
            ("--capture", options.capture is not None),
            ("--degree", options.degree is not None),
            ("--ridge", options.ridge is not None),
        ):
            if given:
                raise InputError("this option does not apply to a population", where=name)
    elif options.part != "names":
        raise InputError(
            "only a population has parts",
            where=f"--part {options.part}",
            remedy="Add --population FILE; `sandbox subject population` makes one",
        )
    elif options.builtin == (options.capture is not None):
        raise InputError(
            "expected either a capture or the built-in models",
            where="sandbox train",
            expected="--capture FILE or --builtin",
        )
    console = Console()
    if not options.builtin:
        _check_out(options)
    try:
        if options.population is not None:
            trained = _names if options.part == "names" else _pose
            return trained(options.population, options.out, console)
        if options.builtin:
            return _builtin(options.out, console)
        capture = load_capture(options.capture) if options.capture else builtin_capture()
        return _one(options, capture, console)
    except OSError as error:
        raise InputError(
            "the model cannot be written", where=f"--out {options.out}", got=str(error)
        ) from error


def _check_out(options: TrainOptions) -> None:
    """Checks before the training that the model can be written, and replaces no data.

    Raises:
        InputError: It cannot be written, or would replace what it is trained from.
    """
    check_output(options.out, "--out")
    sources = {"--capture": options.capture, "--population": options.population}
    refuse_replacing(options.out, sources)


def _one(options: TrainOptions, capture: Capture, console: Console) -> int:
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
            model = train_best_model(capture, options.out.stem, show)
        else:
            model = train(capture, options.out.stem, degree, options.ridge)
    save_model(model, options.out)
    _report(console, options.out, model)
    return 0


def _names(path: Path, out: Path, console: Console) -> int:
    population = load_population(path).of(group="train")
    people = population.people
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task("training", total=1.0)
        belief = train_names(
            people, population.digest, lambda share, loss: progress.update(bar, completed=share)
        )
    belief.save(out)
    console.print(
        f"{escape(str(out))}: names for any person, trained on {len(people):,} "
        f"simulated people, {out.stat().st_size:,} bytes",
        soft_wrap=True,
    )
    return 0


def _pose(path: Path, out: Path, console: Console) -> int:
    population = load_population(path).of(group="train")
    people = population.people
    about = {"digest": population.digest, **population.meta}
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task("training", total=1.0)
        model = train_population(
            people, about, out.stem, lambda share: progress.update(bar, completed=share)
        )
    save_model(model, out)
    _report(console, out, model)
    return 0


def _report(console: Console, path: Path, model: TrainedModel) -> None:
    spread = np.sqrt(np.diag(model.residual_covariance))
    wrist = 100 * float(np.linalg.norm(spread[:3]))
    unseen = "takes" if model.personal_covariance is None else "people"
    source = "simulated" if model.meta["simulated"] else "not marked as simulated"
    console.print(
        f"{escape(str(path))}: {_kind(model)}, "
        f"{len(model.training_u):,} frames ({source}); error of the wrist on unseen {unseen} "
        f"{wrist:.1f} cm (root mean square, outliers bounded)",
        soft_wrap=True,
    )


def _kind(model: TrainedModel) -> str:
    if model.personal_covariance is not None:
        people = sum(len(numbers) for numbers in model.meta["population"]["people"].values())
        return f"the pose of any person, trained on {people:,} people, of whom the file keeps"
    if model.correction is not None:
        trust = f"the touches' variance trusted 1 / {model.correction.distrust:g}"
        return f"{model.meta['winner']}, {trust}"
    if "degree" in model.meta:
        return f"degree {model.meta['degree']}, ridge {model.meta['ridge']:g}"
    return type(model.encoder).__qualname__


def _builtin(folder: Path, console: Console) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task("capture", total=1.0 + len(BUILTIN))
        made = simulate(FROZEN, SEED, 0, lambda share: progress.update(bar, completed=share))
        path = folder / "capture.npz"
        save_capture(made, path, np.float32)
        # The models learn from the capture as it is read, in single precision.
        capture = load_capture(path)
        models = []
        for name, (degree, ridge) in POLYNOMIALS.items():
            progress.update(bar, description=name)
            models.append(train(capture, name, degree, ridge))
            progress.advance(bar)
        progress.update(bar, description="best")
        done = 1.0 + len(POLYNOMIALS)
        models.append(
            train_best_model(
                capture, progress=lambda share: progress.update(bar, completed=done + share)
            )
        )
    sound = _capture_agrees(console, capture)
    for model in models:
        path = folder / f"{model.name}.npz"
        save_model(model, path, training=False)
        sound &= _model_agrees(console, load_model(path, capture))
    return 0 if sound else 1


def _capture_agrees(console: Console, capture: Capture) -> bool:
    """True if a capture equals the shipped one except for rounding."""
    shipped = builtin_capture()
    if not np.array_equal(capture.ids, shipped.ids):
        return _verdict(console, "capture", False, "other contacts")
    moved = np.abs(capture.q - shipped.q).max(axis=1) > SAME_POSE
    moved |= np.nan_to_num(np.abs(capture.xy - shipped.xy)).max(axis=(1, 2)) > SAME_POSE
    share = float(moved.mean())
    return _verdict(
        console, "capture", share <= DIFFERENT_FRAMES, f"{100 * share:.2f} % of frames differ"
    )


def _model_agrees(console: Console, model: TrainedModel) -> bool:
    """True if a model predicts the same as the shipped one of its name."""
    shipped = builtin(model.name)
    if model.digest == shipped.digest:
        return _verdict(console, model.name, True, "identical")
    u = shipped.training_u
    off = model.encoder.predict(u) - shipped.encoder.predict(u)
    size = float(np.sqrt(np.mean(off**2)))
    what = f"predictions differ by {size:.1e} m or rad"
    return _verdict(console, model.name, size <= SAME_PREDICTION, what)


def _verdict(console: Console, name: str, sound: bool, what: str) -> bool:
    colour, word = ("green", "agrees") if sound else ("red", "differs")
    console.print(f"{name + '.npz':<14} [{colour}]{word}[/] with the shipped file: {what}")
    return sound
