"""The shipped files that a program makes, and how each is made and compared.

For equal inputs, a maker writes equal bytes on one machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from training import comparison
from training.population import Population

ROOT = Path(__file__).resolve().parents[1]
"""Folder of the checkout."""

POPULATION_NAME = "population_pose"
"""Name of the model inside its file."""

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Inputs:
    """Inputs of makers.

    Attributes:
        population: The people to train on; None for a file that needs none.
        progress: Called with the share done, 0 to 1.
    """

    population: Population | None
    progress: Progress


@dataclass(frozen=True)
class ShippedFile:
    """A file that ships.

    Attributes:
        path: Its place in the checkout.
        about: One line of help.
        make: Writes a new file.
        compare: Compares a new file with the shipped file.
        on_people: True if the file is trained on the population.
    """

    path: str
    about: str
    make: Callable[[Path, Inputs], None]
    compare: comparison.Compare
    on_people: bool = False

    @property
    def file(self) -> Path:
        """The shipped file."""
        return ROOT / self.path


def _make_capture(out: Path, inputs: Inputs) -> None:
    from encoders.captures.subject import FROZEN, SEED, simulate
    from encoders.store import save_capture

    save_capture(simulate(FROZEN, SEED, 0, inputs.progress), out, np.float32)


def _make_polynomial(name: str, out: Path, inputs: Inputs) -> None:
    from encoders.regression.trained import POLYNOMIALS
    from encoders.regression.training import save_model, train
    from encoders.store import load_capture

    # The capture is read from its file, which has single precision.
    capture = load_capture(FILES["capture"].file)
    save_model(train(capture, name, *POLYNOMIALS[name]), out, training=False)


def _to_train_on(inputs: Inputs) -> Population:
    assert inputs.population is not None
    return inputs.population.of(group="train")


def _make_population(out: Path, inputs: Inputs) -> None:
    from encoders.regression.training import save_model
    from training.pose import train_population

    people = _to_train_on(inputs)
    about = {"digest": people.digest, **people.meta}
    save_model(train_population(people.people, about, POPULATION_NAME, inputs.progress), out)


def _make_names(out: Path, inputs: Inputs) -> None:
    from training.names import train_names

    people = _to_train_on(inputs)
    train_names(people.people, people.digest, lambda share, loss: inputs.progress(share)).save(out)


def _make_palm_places(out: Path, inputs: Inputs) -> None:
    from training.palms import as_text, train_palm_places

    out.write_text(as_text(train_palm_places(inputs.progress)), encoding="utf-8")


def _make_skin(out: Path, inputs: Inputs) -> None:
    from training.skin.make_skin import write_skin

    write_skin(out)


def _polynomial(name: str, about: str) -> ShippedFile:
    path = f"encoders/data/{name}.npz"
    return ShippedFile(path, about, partial(_make_polynomial, name), comparison.compare_polynomials)


FILES: dict[str, ShippedFile] = {
    "capture": ShippedFile(
        "encoders/data/capture.npz",
        "the training day of the first simulated subject",
        _make_capture,
        comparison.compare_captures,
    ),
    "paper": _polynomial("paper", "the paper's encoder: a quadratic by least squares"),
    "linear": _polynomial("linear", "the linear encoder, with a validated ridge"),
    "quadratic": _polynomial("quadratic", "the quadratic encoder, with a validated ridge"),
    "cubic": _polynomial("cubic", "the cubic encoder, with a validated ridge"),
    "population": ShippedFile(
        "encoders/data/population.npz",
        "the encoder of the pose of any person",
        _make_population,
        comparison.compare_population_encoders,
        on_people=True,
    ),
    "names": ShippedFile(
        "encoders/data/names.npz",
        "the labels of any person's fingers",
        _make_names,
        comparison.compare_names,
        on_people=True,
    ),
    "palm_places": ShippedFile(
        "encoders/data/palm_places.json",
        "the places of palms beside fingers",
        _make_palm_places,
        comparison.compare_palm_places,
    ),
    "skin": ShippedFile(
        "models/data/skin.npz",
        "the skin of the hand",
        _make_skin,
        comparison.compare_skins,
    ),
}
"""Name of a command -> the file that it makes. Files come before those that are made from them."""
