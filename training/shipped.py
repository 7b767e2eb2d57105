"""The shipped files that a program makes, and how each is made and compared.

For equal inputs, a maker writes equal bytes on one machine. Elsewhere, processors and releases of
libraries round differently. Rounding may decide between two nearly equal postures, or grow while a
network is trained. The bounds of the comparisons are far below visible differences.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.capture import load_capture
from encoders.labels.belief import load_population_belief
from encoders.labels.labelling import true_row
from encoders.regression.trained import TrainedModel, load_model
from models.arithmetic import Array
from models.skin.skin import dense
from training.population import Population
from training.population.surface_people import surface_person

SAME_POSE = 1e-4
"""Difference (m and rad) below which poses count as equal."""

DIFFERENT_FRAMES = 0.01
"""Share of a capture's frames that may differ."""

SAME_PREDICTION = 1e-3
"""Largest root mean square difference (m and rad) of predicted poses."""

SAME_LABELS = 0.97
"""Least share of layouts to which both files give the same labels. For a file made on another
processor, which rounds differently, it was 98.5 %, since training amplifies rounding."""

SAME_RIGHT = 0.005
"""Largest difference between the shares of correctly labelled layouts. For the same file, it was
0.0003."""

SAME_WEIGHTS = 5e-4
"""Largest difference of a weight of the palms' network, whose file has four decimal places."""

SAME_SKIN = 4.0
"""Largest distance (mm) of a vertex from the nearest vertex of the other skin."""

SAME_VOLUME, SAME_COUNT = 0.1, 3.0
"""Largest differences (%) of the volume and of the number of vertices."""

SAME_SHARE = 0.02
"""Largest mean difference of the weights (0 to 1) of nearest vertices."""

_LAYOUTS = 20
"""Number of people whose layouts are labelled. No training uses them."""


class Comparison(NamedTuple):
    """Result of a comparison.

    Attributes:
        agrees: True if the new file agrees with the shipped file.
        how: Text about the differences.
    """

    agrees: bool
    how: str


Compare = Callable[[Path, Path], Comparison]
"""Compares a new file with the shipped file."""


def compared(made: Path, shipped: Path, compare: Compare) -> Comparison:
    """Compares the bytes of two files. If they differ, compares the contents by `compare`."""
    if made.read_bytes() == shipped.read_bytes():
        return Comparison(True, "identical")
    return compare(made, shipped)


def compare_captures(made: Path, shipped: Path) -> Comparison:
    """Captures agree if their contacts are equal, and poses and touches in all but few frames."""
    new, old = load_capture(made), load_capture(shipped)
    if not np.array_equal(new.ids, old.ids):
        return Comparison(False, "the contacts differ")
    moved = np.abs(new.q - old.q).max(axis=1) > SAME_POSE
    moved |= np.nan_to_num(np.abs(new.xy - old.xy)).max(axis=(1, 2)) > SAME_POSE
    share = float(moved.mean())
    return Comparison(
        share <= DIFFERENT_FRAMES,
        f"{100 * share:.2f} % of frames differ by more than {SAME_POSE:g} m or rad; "
        f"at most {100 * DIFFERENT_FRAMES:g} % may",
    )


def compare_polynomials(made: Path, shipped: Path) -> Comparison:
    """Encoders agree if their predictions for the shipped capture are equal except for rounding."""
    capture = load_capture(shipped.with_name("capture.npz"))
    return _same_predictions(load_model(made, capture), load_model(shipped, capture))


def compare_population_encoders(made: Path, shipped: Path) -> Comparison:
    """Encoders agree if they were trained on the same people, and their predictions for the stored
    frames are equal except for rounding."""
    new, old = load_model(made), load_model(shipped)
    if new.meta["population"] != old.meta["population"]:
        return Comparison(False, "it was trained on other people")
    return _same_predictions(new, old)


def _same_predictions(new: TrainedModel, old: TrainedModel) -> Comparison:
    off = new.encoder.predict(old.training_u) - old.encoder.predict(old.training_u)
    size = float(np.sqrt(np.mean(off**2)))
    return Comparison(
        size <= SAME_PREDICTION,
        f"predictions differ by {size:.1e} m or rad (root mean square; at most "
        f"{SAME_PREDICTION:g})",
    )


def compare_names(made: Path, shipped: Path) -> Comparison:
    """Labellers agree if they were trained on the same people, and if they label most layouts of
    other people alike and equally often correctly."""
    new, old = load_population_belief(made), load_population_belief(shipped)
    if new.population != old.population:
        return Comparison(False, "it was trained on other people")
    layouts = _unseen_layouts()
    ours, theirs = (
        np.array([np.argmax(belief.evidence.log_posterior(xy)) for xy, _ in layouts])
        for belief in (new, old)
    )
    truth = np.array([row for _, row in layouts])
    alike = float(np.mean(ours == theirs))
    better = float(np.mean(ours == truth) - np.mean(theirs == truth))
    return Comparison(
        alike >= SAME_LABELS and abs(better) <= SAME_RIGHT,
        f"{100 * alike:.1f} % of layouts have the same labels (at least {100 * SAME_LABELS:g} %); "
        f"{100 * better:+.2f} percentage points more have correct labels (at most "
        f"{100 * SAME_RIGHT:g})",
    )


def _unseen_layouts() -> list[tuple[Array, int]]:
    """Layouts (k, 2) m of two to five contacts, of people on whom no file was trained, each with
    the row of its true labelling."""
    people = [surface_person([1, number]) for number in range(_LAYOUTS)]
    return [
        (xy[down], true_row(np.flatnonzero(down)))
        for person in people
        for xy, down in zip(person.xy, person.down, strict=True)
    ]


def compare_palm_places(made: Path, shipped: Path) -> Comparison:
    """Networks agree if their weights are equal except for the last digits."""
    new, old = (json.loads(path.read_text(encoding="utf-8")) for path in (made, shipped))
    shapes = [{name: np.shape(values) for name, values in w.items()} for w in (new, old)]
    if shapes[0] != shapes[1]:
        return Comparison(False, "the network has another shape")
    off = max(float(np.abs(np.array(new[name]) - np.array(old[name])).max()) for name in old)
    return Comparison(
        off <= SAME_WEIGHTS, f"weights differ by up to {off:g} (at most {SAME_WEIGHTS:g})"
    )


def compare_skins(made: Path, shipped: Path) -> Comparison:
    """Skins agree if their surfaces and weights are equal, except for the places at which the
    meshing library puts vertices."""
    from scipy.spatial import cKDTree

    from training.skin.mesh import volume

    (new, new_faces, new_shares), (old, old_faces, old_shares) = map(_skin, (made, shipped))
    to_new, nearest = cKDTree(old).query(new)
    away = 1000 * float(max(to_new.max(), cKDTree(new).query(old)[0].max()))
    larger = 100 * abs(volume(new, new_faces) / volume(old, old_faces) - 1.0)
    more = 100 * abs(len(new) / len(old) - 1.0)
    heavier = float(np.abs(new_shares - old_shares[nearest]).max(axis=1).mean())
    return Comparison(
        away <= SAME_SKIN
        and larger <= SAME_VOLUME
        and more <= SAME_COUNT
        and heavier <= SAME_SHARE,
        f"vertices are up to {away:.2f} mm from the other skin (at most {SAME_SKIN:g}); "
        f"the volume differs by {larger:.3f} % (at most {SAME_VOLUME:g}); "
        f"the number of vertices by {more:.1f} % (at most {SAME_COUNT:g}); "
        f"the weights by {heavier:.4f} in the mean (at most {SAME_SHARE:g})",
    )


def _skin(path: Path) -> tuple[Array, NDArray[np.int64], Array]:
    """Vertices (n, 3) m, triangles (m, 3) and weights (n, 15) of the part `skin` of a file, without
    nails, cuff and sleeve."""
    with np.load(path, allow_pickle=False) as file:
        header = json.loads(bytes(file["header"].tobytes()).decode())
        places = file["rest"] * header["step"] + np.array(header["corner"])
        triangles = file["triangles"].astype(np.int64)
        shares = dense(file["bones"], file["weights"])
    part = next(p for p in header["parts"] if p["name"] == "skin")
    vertices = slice(*part["vertices"])
    return places[vertices], triangles[slice(*part["triangles"])], shares[vertices]


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
    compare: Compare
    on_people: bool = False

    @property
    def file(self) -> Path:
        """The shipped file."""
        return ROOT / self.path


def _make_capture(out: Path, inputs: Inputs) -> None:
    from encoders.capture import save_capture
    from encoders.captures.subject import FROZEN, SEED, simulate

    save_capture(simulate(FROZEN, SEED, 0, inputs.progress), out, np.float32)


def _make_polynomial(name: str, out: Path, inputs: Inputs) -> None:
    from encoders.capture import load_capture
    from encoders.regression.trained import POLYNOMIALS
    from encoders.regression.training import save_model, train

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
    return ShippedFile(path, about, partial(_make_polynomial, name), compare_polynomials)


FILES: dict[str, ShippedFile] = {
    "capture": ShippedFile(
        "encoders/data/capture.npz",
        "the training day of the first simulated subject",
        _make_capture,
        compare_captures,
    ),
    "paper": _polynomial("paper", "the paper's encoder: a quadratic by least squares"),
    "linear": _polynomial("linear", "the linear encoder, with a validated ridge"),
    "quadratic": _polynomial("quadratic", "the quadratic encoder, with a validated ridge"),
    "cubic": _polynomial("cubic", "the cubic encoder, with a validated ridge"),
    "population": ShippedFile(
        "encoders/data/population.npz",
        "the encoder of the pose of any person",
        _make_population,
        compare_population_encoders,
        on_people=True,
    ),
    "names": ShippedFile(
        "encoders/data/names.npz",
        "the labels of any person's fingers",
        _make_names,
        compare_names,
        on_people=True,
    ),
    "palm_places": ShippedFile(
        "encoders/data/palm_places.json",
        "the places of palms beside fingers",
        _make_palm_places,
        compare_palm_places,
    ),
    "skin": ShippedFile(
        "models/data/skin.npz",
        "the skin of the hand",
        _make_skin,
        compare_skins,
    ),
}
"""Name of a command -> the file that it makes. Files come before those that are made from them."""
