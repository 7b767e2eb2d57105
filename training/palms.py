"""Training of the network that decides by the place of a contact whether the contact is a palm.

The examples are from people of a population. An example is one contact and the positions of the
other touches of a frame. The contact is either a touching finger or the heel of a hand. Half of the
contacts are palms. Needs scikit-learn.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Sequence

import numpy as np

from encoders.capture import Capture
from encoders.reconstruction.contact_tracker import place_inputs
from models.arithmetic import Array
from models.errors import InputError
from models.rotations import exp
from training.population import simulate_population

SALT, PEOPLE = "palms to fit", 30
"""Salt of the people, and their number from each of the two generators. Posed people are not used,
since they do not grip."""

CONTACTS = 160_000
"""Number of contacts on which the network is trained."""

DOUBTFUL = 26.5
"""Diameter (mm) of the palms in the examples. For larger and smaller contacts, the size alone shows
whether the contact is a palm."""

USUAL = (7.0, 14.0)
"""Least and greatest diameter (mm) of fingertips."""

OTHER_HAND = 0.15
"""Share of palms that belong to another hand, anywhere around the fingers."""

HIDDEN, EPOCHS, BATCH, RATE, DECAY = 24, 30, 512, 3e-3, 1e-2
"""Number of hidden units (rectifiers), epochs, batch size, learning rate and weight penalty."""

DIGITS = 4
"""Number of decimal places of the weights in the file."""

_SEED = 61_031

Weights = dict[str, list[list[float]] | list[float]]
"""Content of the file: `first` (hidden, inputs), `bias` (hidden,), `second` (hidden,) and
`constant` (1,)."""


def train_palm_places(
    progress: Callable[[float], None] = lambda share: None, contacts: int = CONTACTS
) -> Weights:
    """Trains the network of `encoders.reconstruction.contact_tracker`.

    Args:
        progress: Called with the share done, 0 to 1.
        contacts: Number of contacts to train on.

    Raises:
        InputError: scikit-learn is not installed.
    """
    try:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.neural_network import MLPClassifier
    except ImportError as error:
        raise InputError(
            "scikit-learn is not installed",
            where="training.palms",
            remedy="pip install -e '.[training]' in the checkout",
        ) from error
    rng = np.random.default_rng(_SEED)
    groups = {"train": {"first": PEOPLE, "second": PEOPLE}}
    people = simulate_population(SALT, groups, lambda share: progress(0.5 * share)).people
    inputs: list[list[float]] = []
    is_palm = np.arange(contacts) % 2
    for palm in is_palm:
        person, frame, fingers = _grip(people, rng)
        others = person.xy[frame, fingers]
        if palm:
            room = 0.0005 * (DOUBTFUL + rng.uniform(*USUAL, len(others)))
            place = _clear_of(others, _palm_place(person, frame, rng), room)
        else:
            which = _chosen_finger(fingers, rng)
            place, others = others[which], np.delete(others, which, axis=0)
        inputs.append(place_inputs(_pair(place), [_pair(other) for other in others]))
    progress(0.8)
    network = MLPClassifier(
        (HIDDEN,),
        alpha=DECAY,
        batch_size=BATCH,
        learning_rate_init=RATE,
        max_iter=EPOCHS,
        random_state=1,
    )
    with warnings.catch_warnings():
        # Training ends after a fixed number of epochs on purpose.
        warnings.simplefilter("ignore", ConvergenceWarning)
        network.fit(np.array(inputs), is_palm)
    progress(1.0)
    first, second = network.coefs_
    bias, constant = network.intercepts_
    weights = {"first": first.T, "bias": bias, "second": second[:, 0], "constant": constant}
    return {name: np.round(values, DIGITS).tolist() for name, values in weights.items()}


def as_text(weights: Weights) -> str:
    """The text of the file."""
    return json.dumps(weights) + "\n"


def _grip(people: Sequence[Capture], rng: np.random.Generator) -> tuple[Capture, int, list[int]]:
    """A random person, a random frame of this person with two or more touching fingers, and these
    fingers."""
    while True:
        person = people[int(rng.integers(len(people)))]
        frame = int(rng.integers(len(person)))
        fingers = np.flatnonzero(person.down[frame]).tolist()
        if len(fingers) >= 2:
            return person, frame, fingers


def _palm_place(person: Capture, frame: int, rng: np.random.Generator) -> Array:
    """Place (2,) m on the surface where the middle of a palm touches.

    The palm is the heel of this hand, or of another hand.
    """
    if rng.random() < OTHER_HAND:
        tips = person.xy[frame, person.down[frame]]
        return np.asarray(tips.mean(axis=0) + rng.uniform(0.09, 0.16) * _direction(rng))
    kind = rng.random()
    if kind < 0.6:  # the edge below the little finger
        x, y = rng.uniform(0.0, 0.035), rng.uniform(0.005, 0.06)
    elif kind < 0.8:  # the ball of the thumb
        x, y = rng.uniform(-0.03, 0.0), rng.uniform(0.01, 0.045)
    else:
        x, y = rng.uniform(-0.015, 0.015), rng.uniform(0.0, 0.03)
    q = person.q[frame]
    on_hand = float(person.meta["size"]) * np.array([x, y, 0.0])
    right, up, _ = q[:3] + exp(q[3:6]) @ on_hand
    return np.array([right, -up])


def _clear_of(xy: Array, place: Array, room: Array) -> Array:
    """A palm's position (2,) m, moved away from the middle of touches until it is clear of them.

    Args:
        xy: (n, 2) m, the touches.
        place: (2,) m, position of the palm.
        room: (n,) m, least distance from each touch.
    """
    away = place - xy.mean(axis=0)
    away = away / max(float(np.linalg.norm(away)), 1e-6)
    while (np.linalg.norm(xy - place, axis=1) < room).any():
        place = place + 0.003 * away
    return place


def _chosen_finger(fingers: Sequence[int], rng: np.random.Generator) -> int:
    """Index of a random finger in `fingers`.

    If the thumb touches, half of the draws choose it. The other half choose among all touching
    fingers, including the thumb, with equal chances.
    """
    if 0 in fingers and rng.random() < 0.5:
        return fingers.index(0)
    return int(rng.integers(len(fingers)))


def _direction(rng: np.random.Generator) -> Array:
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


def _pair(place: Array) -> tuple[float, float]:
    x, y = place.tolist()
    return x, y
