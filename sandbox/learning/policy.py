"""A policy: from what is seen to the touches of the next moments, by a small neural network."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.frames import FINGERS
from models.surface import Surface
from sandbox.learning.sight import SEEN, recent, references, sights

CHUNK, STRIDE = 24, 2
"""Control periods that a policy plans, and between two of the moments that it plans; the touches
between them are on straight lines."""
DONE_AT_ONCE = 20
"""Control periods of a plan that are carried out before the next one is made. A policy that plans
anew at every moment never begins what people wait with: it only sees that nothing has begun."""
LANDS, STAYS = 0.5, 0.25
"""Probabilities above which a finger touches: one that does not yet, and one that does."""
NUMBERS = 3
"""Numbers of a finger at a moment: whether it touches, and where."""


@dataclass(frozen=True)
class Policy:
    """A multilayer perceptron with rectified units.

    Attributes:
        mean, scale: (n,) of what is seen, by which it is standardised.
        weights, biases: Of each layer, (inputs, outputs) and (outputs,).
    """

    mean: Array
    scale: Array
    weights: tuple[Array, ...]
    biases: tuple[Array, ...]

    def plan(self, sight: Array) -> tuple[Array, Array]:
        """The touches of the next moments.

        Args:
            sight: (n,) what is seen now.

        Returns:
            Probabilities (K, 5) that fingers touch, and places (K, 5, 2) m from the references.
        """
        x = np.clip((sight - self.mean) / self.scale, -BOUND, BOUND)
        *hidden, last = zip(self.weights, self.biases, strict=True)
        for weight, bias in hidden:
            x = np.maximum(x @ weight + bias, 0.0)
        out = (x @ last[0] + last[1]).reshape(-1, len(FINGERS), NUMBERS)
        return 1.0 / (1.0 + np.exp(-np.clip(out[..., 0], -50.0, 50.0))), out[..., 1:] / UNIT

    def save(self, path: Path) -> None:
        """Writes the policy to a file `.npz`."""
        layers: dict[str, Any] = {f"weight{i}": w for i, w in enumerate(self.weights)}
        layers |= {f"bias{i}": b for i, b in enumerate(self.biases)}
        np.savez_compressed(path, mean=self.mean, scale=self.scale, **layers)

    @classmethod
    def load(cls, path: Path) -> Policy:
        """Reads a policy.

        Raises:
            InputError: The file is not one.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                count = sum(name.startswith("weight") for name in file.files)
                weights, biases = (
                    tuple(file[f"{kind}{i}"] for i in range(count)) for kind in ("weight", "bias")
                )
                return cls(file["mean"], file["scale"], weights, biases)
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise InputError("this is not a policy", where=str(path), got=str(error)) from None


BOUND = 6.0
"""Standard deviations beyond which nothing is seen."""
UNIT = 20.0
"""Factor by which places, m, are about 1."""


class Player:
    """Plays one episode by a policy.

    Args:
        policy: The policy.
        surface: The touch surface.
        first: The first observation.

    Raises:
        InputError: The policy was trained on what another version sees.
    """

    def __init__(self, policy: Policy, surface: Surface, first: Mapping[str, Array]) -> None:
        self._policy, self._surface = policy, surface
        self._history: dict[str, list[Array]] = {name: [] for name in SEEN}
        self._plan: list[Array] = []
        self._down = np.zeros(len(FINGERS), bool)
        self.see(first)
        size = sights(recent(self._history), surface).shape[1]
        if size != len(policy.mean):
            raise InputError(
                "this policy was trained by another version of Hand Sandbox",
                got=f"{len(policy.mean)} numbers that it sees",
                expected=str(size),
                remedy="Train it again from its demonstrations",
            )

    def see(self, observation: Mapping[str, Array]) -> None:
        """Takes in an observation."""
        for name, values in self._history.items():
            values.append(observation[name])

    def act(self) -> Array:
        """The action (15,) for the next control period."""
        if not self._plan:
            self._plan = self._planned()
        return self._plan.pop(0)

    def _planned(self) -> list[Array]:
        seen = recent(self._history)
        touch, places = self._policy.plan(sights(seen, self._surface)[-1])
        places = places + references(seen, self._surface)[-1]
        actions = []
        for step in range(DONE_AT_ONCE):
            key, share = step // STRIDE, step % STRIDE / STRIDE
            self._down = touch[key] > np.where(self._down, STAYS, LANDS)
            where = (1.0 - share) * places[key] + share * places[key + 1]
            rows = np.column_stack([self._down, where])
            actions.append(rows.ravel())
        return actions


def play(env: Any, policy: Policy, seed: int) -> tuple[bool, float]:
    """Plays one episode.

    Args:
        env: An environment for learning whose actions are touches, with everything to be observed.
        policy: The policy.
        seed: Seed of the trial.

    Returns:
        Whether it succeeded, and how long it took, s.
    """
    (surface,) = env.surfaces
    seen, info = env.reset(seed=seed)
    player = Player(policy, surface, seen)
    over = False
    while not over:
        seen, _, terminated, truncated, info = env.step(player.act())
        player.see(seen)
        over = terminated or truncated
    return bool(info["is_success"]), float(seen["time"][0])
