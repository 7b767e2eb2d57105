"""The belief over labels for people whom nobody knows: its trained model, stored and checked."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import astuple, dataclass
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.labels.belief import CERTAIN, BeliefLabels
from encoders.labels.label_sums import LEAST
from encoders.labels.network_evidence import FRESH, LONE_FINGER, USUAL_SETS, NetworkEvidence
from encoders.labels.own_layouts import FAR, MOST, NEW, SHAPE, OwnLayouts
from encoders.labels.pair_network import PairNetwork
from encoders.labels.recent_liftoffs import AT_ONCE, LATER, REACH
from encoders.npz import read_npz, write_npz
from models.errors import EncoderError
from models.frames import FINGERS

SCHEMA = 1
"""Version of the file's layout."""

SHARPNESS = dict.fromkeys(range(2, len(FINGERS) + 1), 0.8)
"""Factors on the network's log probabilities. Of 1, 0.8 and 0.65, this one costs people to choose
on 0.2 points of names, and their probabilities err by 2.7 points, of 3.3 with 1."""

ETA, STAY = 0.5, 0.3
"""Weights of new evaluations; see `belief.BeliefModel`. Chosen on people to choose on, where
probabilities of the truth hardly depend on them."""

_ASSUMED = {
    "usual": [[*fingers, odds] for fingers, odds in USUAL_SETS.items()],
    "lone": list(LONE_FINGER),
    "fresh": FRESH,
    "lifted": [REACH, AT_ONCE, LATER],
    "least": LEAST,
    "own": [CERTAIN, MOST, NEW, *FAR, *astuple(SHAPE)],
}
"""The constants that affect labels in addition to the file, for digests."""


@dataclass(frozen=True)
class PopulationBelief:
    """All trained parameters of the belief over labels for any person.

    Attributes:
        evidence: Evidence of a single frame.
        eta: See `belief.BeliefModel`.
        stay: See `belief.BeliefModel`.
        population: Digest of the people it was trained on.
    """

    evidence: NetworkEvidence
    eta: float
    stay: float
    population: str

    @property
    def header(self) -> dict[str, Any]:
        """The settings as JSON values."""
        return {
            "schema": SCHEMA,
            "simulated": True,
            "sharpness": {str(k): v for k, v in self.evidence.sharpness.items()},
            "eta": self.eta,
            "stay": self.stay,
            "population": self.population,
        }

    @cached_property
    def digest(self) -> str:
        """BLAKE2b, hexadecimal, of everything that decides a label, with the assumed constants."""
        known = json.dumps({**self.header, **_ASSUMED}, sort_keys=True)
        hash_ = blake2b(known.encode(), digest_size=16)
        for name, array in sorted(self.evidence.network.weights.items()):
            hash_.update(name.encode() + array.tobytes())
        return hash_.hexdigest()

    def save(self, path: Path) -> None:
        """Writes the model as npz; weights have half precision, which they were rounded to."""
        weights = self.evidence.network.weights
        write_npz(path, self.header, {k: v.astype(np.float16) for k, v in weights.items()})


def from_weights(weights: Mapping[str, NDArray[Any]], population: str) -> PopulationBelief:
    """The belief of a network, whose weights are rounded as its file stores them."""
    rounded = {k: np.asarray(v, np.float16).astype(float) for k, v in weights.items()}
    return PopulationBelief(NetworkEvidence(PairNetwork(rounded), SHARPNESS), ETA, STAY, population)


def load_population_belief(path: Path) -> PopulationBelief:
    """Reads a belief.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    remedy = "`python -m training names --out FILE` in a checkout makes a valid one"
    header, arrays = read_npz(path, None, EncoderError, "names for any person", remedy)
    if header.get("schema") != SCHEMA:
        raise EncoderError(
            "the names have another version",
            where=str(path),
            got=header.get("schema"),
            expected=f"schema {SCHEMA}",
            remedy=remedy,
        )
    try:
        sharpness = {k: float(header["sharpness"][str(k)]) for k in range(2, len(FINGERS) + 1)}
        eta, stay = float(header["eta"]), float(header["stay"])
        population = str(header["population"])
    except (KeyError, TypeError, ValueError) as error:
        raise EncoderError(
            "not names for any person, or they are damaged",
            where=str(path),
            got=f"{type(error).__name__}: {error}",
            remedy=remedy,
        ) from error
    weights = {name: array.astype(float) for name, array in arrays.items()}
    return PopulationBelief(NetworkEvidence(PairNetwork(weights), sharpness), eta, stay, population)


@cache
def builtin_population_model() -> PopulationBelief:
    """The model trained on the population."""
    return load_population_belief(Path(str(files("encoders") / "data" / "names.npz")))


def builtin_population_belief(known: OwnLayouts | None = None) -> BeliefLabels:
    """The belief trained on the population, without contacts.

    Args:
        known: The person's own layouts of five fingers, where some are known.
    """
    return BeliefLabels(builtin_population_model(), known, learns=True)
