"""Behaviour cloning: a policy that learns from demonstrations, and how often it succeeds.

    sandbox regress --tasks box-to-goal --arm plain --seeds 20000:20200 \\
        --record demonstrations --record-all
    sandbox export demonstrations --to demonstrations.npz --successes
    python examples/behaviour_cloning.py demonstrations.npz --seeds 30000:30100

The first line records a simulated user; `sandbox play --record` records a person. The success rate
of such a policy measures the quality of demonstrations: the better the hand follows the touches,
the more often a policy succeeds that learns from them.

The inputs of the policy are:

- of the object: its rotation, the touches and the goal relative to it, and the displacement of each
  touch that brings the object to its goal;
- of the finger that follows a touch: the position of its tip, its force, and whether it is solid;
- of time: the phase of the hand's arrival, the touches of the last half second, and how long
  fingers have touched and have not moved.

It does not use pictures, and it does not use the labels of fingers: in one of three demonstrations
the program labels the user's index and middle finger as others. Touches therefore take the slots 0,
1, 2 in the order of their fingers.

The policy plans the touches of the next 24 control periods. 20 of them (about a third of a second)
are carried out before it plans again.

Demonstrations have one hand, and a task in which one object has to be moved to one goal:
box-to-goal and insert were tried. An object that is as long as wide may be rotated by any quarter
turn at its goal, a longer one by half a turn. The inputs do not include other objects, such as the
pins of slalom.

Training takes about a minute on one processor for any number of demonstrations, and needs PyTorch
(`pip install torch`). A saved policy (`--save`) plays with NumPy alone (`--load`).
"""

from __future__ import annotations

import argparse
import sys
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from models import InputError, Surface
from models.arithmetic import Array
from models.frames import FINGERS
from models.scene import CONTROL_PERIOD
from sandbox.datasets.npz_file import read_npz
from sandbox.datasets.played_trial import Demonstration
from sandbox.gym import register_task
from sandbox.regress.run_plan import parse_seeds
from sandbox.regress.statistics import wilson

# Inputs of the policy

SEEN = ("objects", "goals", "properties", "tips", "touches", "labels", "solid", "phase", "contact")
"""Parts of an observation that the policy uses."""
LAGS = (0, 6, 15, 30)
"""Delays (control periods) of the touches among the inputs; the longest is half a second."""
MEMORY = 90
"""Number of control periods of observations that the inputs need."""
LONGEST_TOUCH, LONGEST_REST = 1.0, 0.8
"""Largest values (s) of the inputs for how long fingers have touched and have not moved."""
MOVED, WITHIN = 0.004, 5
"""Distance (m) that a finger has to move within this number of control periods to count as moving.
Tremor is less."""
NEAR, STRAIGHT = (0.01, 0.0025), np.deg2rad([10.0, 2.5])
"""Scales (m, rad) of additional inputs that resolve small differences from the goal. People let go
of an object within 2 mm of its goal after they have moved it by 80 mm."""
SQUARE = 0.01
"""Largest difference of the two edges of a square object, as a share of the longer one."""


def places_of(observations: Mapping[str, Array], surface: Surface) -> Array:
    """Returns the positions (T, 2) of the first object, m on the surface."""
    return surface.to_surface(observations["objects"][:, 0, :3])


def references(observations: Mapping[str, Array], surface: Surface) -> Array:
    """Returns the points to which planned touches are relative: (T, 5, 2) m on the surface.

    The point of a slot is its touch, or the position of the first object without a touch.
    """
    touches = observations["touches"]
    down = touches[:, :, :1] > 0.5
    return np.where(down, touches[:, :, 1:], places_of(observations, surface)[:, None])


def sights(observations: Mapping[str, Array], surface: Surface) -> Array:
    """Computes the inputs (T, n) of the policy at T times, each from the observations up to then.

    Positions are relative to the first object, in m times a factor that makes them about 1. The
    rotation to the goal is the shortest one: a goal looks the same after every quarter turn if the
    object is as long as wide, and else after every half turn. A longer object adds its distances
    from the goal along and across the goal, for an object that has to be aligned with a slot. The
    inputs of a touch's finger are of the finger that follows it, whatever its label is.

    Args:
        observations: Name -> (T, ...) parts of observations with one hand.
        surface: The touch surface.
    """
    box = places_of(observations, surface)
    objects, goals = observations["objects"][:, 0], observations["goals"][:, 0]
    w, x, y, z = objects[:, 3:7].T
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    equal = _equal_turns(observations["properties"][:, 0, 1:3])
    apart = 2.0 * np.pi / equal
    turn = (goals[:, 3] - yaw + apart / 2) % apart - apart / 2
    way = surface.to_surface(goals[:, :3]) - box
    touches = observations["touches"]
    down, places = touches[:, :, 0], touches[:, :, 1:]
    count = len(box)
    named, tips, solid, force = _fingers_of_touches(observations)
    flat = surface.to_surface(tips)
    beside = named[..., None] * (flat - places)
    held = named[..., None] * (flat - box[:, None])
    left = _ways_of_touches(places - box[:, None], way, turn) * (down > 0.5)[..., None]
    parts = [
        50.0 * left.reshape(count, -1),
        50.0 * way,
        *(np.tanh(left / near).reshape(count, -1) for near in NEAR),
        *(np.tanh(way / near) for near in NEAR),
        4.0 * turn[:, None],
        np.tanh(turn[:, None] / STRAIGHT),
        np.stack([np.cos(equal * yaw), np.sin(equal * yaw)], axis=1),
        10.0 * box,
        20.0 * objects[:, 2:3],
        10.0 * objects[:, 7:9],
        named,
        50.0 * beside.reshape(count, -1),
        20.0 * held.reshape(count, -1),
        20.0 * named * tips[:, :, 2],
        solid,
        observations["phase"],
        np.log1p(force),
        2.0 * _clocks(down, places),
    ]
    if (equal < 4.0).all():
        lined = _along(goals, objects)
        parts += [50.0 * lined, *(np.tanh(lined / near) for near in NEAR)]
    for lag in LAGS:
        before = np.maximum(np.arange(count) - lag, 0)
        then = down[before]
        apart = then[..., None] * (places[before] - box[:, None])
        parts += [then, 20.0 * apart.reshape(count, -1), 50.0 * (box - box[before])]
    return np.concatenate(parts, axis=1)


def _equal_turns(half: Array) -> Array:
    """Returns the number (T,) of rotations in which an object looks the same from above.

    Args:
        half: (T, 2) half edges of the object, m.
    """
    low, high = half.min(axis=1), half.max(axis=1)
    return np.where(high - low <= SQUARE * high, 4.0, 2.0)


def _along(goals: Array, objects: Array) -> Array:
    """Returns the displacement (T, 2) m from an object to its goal, along the goal's first axis and
    across it."""
    x, y = (goals[:, :2] - objects[:, :2]).T
    c, s = np.cos(goals[:, 3]), np.sin(goals[:, 3])
    return np.stack([c * x + s * y, c * y - s * x], axis=1)


def _fingers_of_touches(
    observations: Mapping[str, Array],
) -> tuple[Array, Array, Array, Array]:
    """Looks up the finger that follows each touch, whatever its label is.

    Returns:
        (T, 5) 1 where the touch has a label; (T, 5, 3) position of that finger's tip (m); (T, 5) 1
        where the finger is solid; (T, 5) its force (N). All are 0 without a label.
    """
    labels = observations["labels"].astype(int)
    named = (labels >= 0).astype(float) * (observations["touches"][:, :, 0] > 0.5)
    finger = np.maximum(labels, 0)
    tips = np.take_along_axis(observations["tips"], finger[:, :, None], axis=1)
    solid = np.take_along_axis(observations["solid"], finger, axis=1)
    force = np.take_along_axis(observations["contact"][:, :, 0], finger, axis=1)
    return named, named[:, :, None] * tips, named * solid, named * force


def in_first_slots(
    observations: Mapping[str, Array], actions: Array
) -> tuple[dict[str, Array], Array]:
    """Moves the touches of a demonstration to the first slots, in the order of their fingers.

    The program's labels of fingers differ between trials in which people did the same. From the
    first touch to a time without touches, the fingers that touch take the slots 0, 1, 2 ... in
    their order.

    Args:
        observations: Name -> (T + 1, ...) parts of observations with one hand.
        actions: (T, 15) touches of each control period.

    Returns:
        Observations and actions with the slots exchanged.
    """
    rows = actions.reshape(len(actions), -1, 3)
    order = _orders(rows[:, :, 0] > 0.5)
    rows = np.take_along_axis(rows, order[:, :, None], axis=1)
    order = np.concatenate([order[:1], order])
    touches = np.take_along_axis(observations["touches"], order[:, :, None], axis=1)
    labels = np.take_along_axis(observations["labels"], order, axis=1)
    return {**observations, "touches": touches, "labels": labels}, rows.reshape(actions.shape)


def _orders(down: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Returns the old slot of each new slot (T, 5). It stays the same from a first touch until no
    finger touches."""
    order = np.tile(np.arange(down.shape[1]), (len(down), 1))
    any_down = np.concatenate([[False], down.any(axis=1), [False]])
    edges = np.flatnonzero(np.diff(any_down.astype(int)))
    for begin, end in edges.reshape(-1, 2):
        used = down[begin:end].any(axis=0)
        # An observation shows the touches of the step before, so the order holds one step longer.
        order[begin : end + 1] = np.concatenate([np.flatnonzero(used), np.flatnonzero(~used)])
    return order


def _ways_of_touches(grip: Array, way: Array, turn: Array) -> Array:
    """Returns the displacement (T, 5, 2) m of each touch that brings the object to its goal.

    Args:
        grip: (T, 5, 2) displacement from the object to the touches, m on the surface.
        way: (T, 2) displacement from the object to its goal, m on the surface.
        turn: (T,) rotation (rad) to the goal about the upward vertical. Its sense is opposite in
            the axes of the surface, whose second axis points towards the person.
    """
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    x, y = grip[..., 0], grip[..., 1]
    turned = np.stack([c * x + s * y, c * y - s * x], axis=-1)
    return way[:, None] + turned - grip


def _clocks(down: Array, places: Array) -> Array:
    """Returns the times (T, 2) s since the last touch began or ended, and since fingers moved. They
    are 0 while no finger touches."""
    count = len(down)
    out = np.zeros((count, 2))
    touching = moving = 0.0
    for t in range(1, count):
        before = max(0, t - WITHIN)
        went = np.abs(places[t] - places[before])[down[t] > 0.5] > MOVED
        touching = 0.0 if (down[t] != down[t - 1]).any() else touching + CONTROL_PERIOD
        still = not (went.any() or (down[t] != down[before]).any())
        moving = moving + CONTROL_PERIOD if still else 0.0
        if (down[t] > 0.5).any():
            out[t] = min(touching, LONGEST_TOUCH), min(moving, LONGEST_REST)
    return out


def recent(history: Mapping[str, list[Array]]) -> dict[str, Array]:
    """Returns the last `MEMORY` observations, as arrays."""
    return {name: np.array(values[-MEMORY:]) for name, values in history.items()}


# The policy

CHUNK, STRIDE = 24, 2
"""Number of control periods of a plan, and number between two planned times. Touches between these
times are interpolated linearly."""
DONE_AT_ONCE = 20
"""Number of control periods of a plan that are carried out before the next plan. A policy that
plans again in every control period never begins a movement before which people wait: its inputs
only show that no movement has begun."""
LANDS, STAYS = 0.5, 0.25
"""Probability above which a finger begins to touch, and above which it continues to touch."""
NUMBERS = 3
"""Number of values of a finger at a planned time: whether it touches, and its position."""
BOUND = 6.0
"""Limit of the standardised inputs, in standard deviations."""
UNIT = 20.0
"""Factor that makes positions in m about 1."""


@dataclass(frozen=True)
class Policy:
    """A multilayer perceptron with rectified units.

    Attributes:
        mean, scale: (n,) mean and standard deviation of the inputs, which standardise them.
        weights, biases: Weights (inputs, outputs) and biases (outputs,) of each layer.
    """

    mean: Array
    scale: Array
    weights: tuple[Array, ...]
    biases: tuple[Array, ...]

    def plan(self, sight: Array) -> tuple[Array, Array]:
        """Plans the touches of the next K times, which are `STRIDE` control periods apart.

        Args:
            sight: (n,) current inputs.

        Returns:
            Probabilities (K, 5) that fingers touch, and their positions (K, 5, 2) relative to
            `references`, m on the surface.
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
            InputError: The file does not contain a policy.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                count = sum(name.startswith("weight") for name in file.files)
                weights, biases = (
                    tuple(file[f"{kind}{i}"] for i in range(count)) for kind in ("weight", "bias")
                )
                return cls(file["mean"], file["scale"], weights, biases)
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise InputError(
                "the file does not contain a policy",
                where=str(path),
                got=str(error),
                expected="a file of --save",
            ) from None


# Training

STEPS, BATCH = 5000, 256
"""Number of training steps, and of samples in each, for any number of demonstrations."""
WIDTH, LAYERS, DROPOUT = 256, 3, 0.1
"""Units of a hidden layer, number of hidden layers, and share of units that dropout sets to 0."""
RATE, DECAY = 2e-3, 1e-3
"""Largest learning rate, and weight decay."""
EVERY = 2
"""Number of control periods between two samples of a demonstration."""
REST = 45
"""Number of control periods after the last touch that are used. After them the user only waits."""


def clone(episodes: Sequence[Demonstration], surface: Surface, seed: int = 0) -> Policy:
    """Trains a policy.

    The loss is the cross entropy of whether fingers touch, plus the absolute error of the positions
    of those that touch. Tremor disturbs the absolute error less than the squared error.

    Args:
        episodes: Demonstrations with one hand, whose actions are touches by finger.
        surface: The touch surface.
        seed: Seed of the initial weights and of the order of samples.

    Raises:
        InputError: PyTorch is not installed.
    """
    try:
        import torch
    except ImportError:
        raise InputError(
            "PyTorch is not installed", where="training", remedy="pip install torch"
        ) from None
    seen, touch, places = _moments(episodes, surface)
    mean, scale = seen.mean(axis=0), seen.std(axis=0) + 1e-3
    x = torch.tensor(np.clip((seen - mean) / scale, -BOUND, BOUND), dtype=torch.float32)
    down, where = (torch.tensor(v, dtype=torch.float32) for v in (touch, UNIT * places))
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    sizes = [x.shape[1], *[WIDTH] * LAYERS]
    layers: list[torch.nn.Module] = []
    for one, two in pairwise(sizes):
        layers += [torch.nn.Linear(one, two), torch.nn.ReLU(), torch.nn.Dropout(DROPOUT)]
    out = torch.nn.Linear(WIDTH, down.shape[1] * len(FINGERS) * NUMBERS)
    net = torch.nn.Sequential(*layers, out)
    optimiser = torch.optim.AdamW(net.parameters(), weight_decay=DECAY)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=STEPS)
    net.train()
    for _ in range(STEPS):
        rows = torch.randint(len(x), (BATCH,))
        guess = net(x[rows]).view(BATCH, -1, len(FINGERS), NUMBERS)
        wanted = down[rows]
        touching = torch.nn.functional.binary_cross_entropy_with_logits(guess[..., 0], wanted)
        off = (guess[..., 1:] - where[rows]).abs().mean(dim=-1) * wanted
        loss = touching + off.sum() / wanted.sum().clamp(min=1.0)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
    linear = [layer for layer in net if isinstance(layer, torch.nn.Linear)]
    return Policy(
        mean,
        scale,
        tuple(layer.weight.detach().numpy().T.astype(float) for layer in linear),
        tuple(layer.bias.detach().numpy().astype(float) for layer in linear),
    )


def _moments(episodes: Sequence[Demonstration], surface: Surface) -> tuple[Array, Array, Array]:
    """Returns the samples: inputs (N, n), whether fingers touch (N, K, 5), and their positions (N,
    K, 5, 2) relative to `references`, m."""
    seen, touch, places = [], [], []
    for episode in episodes:
        observed, actions = in_first_slots(episode.observations, episode.actions)
        actions = actions.reshape(-1, len(FINGERS), NUMBERS)
        touched = np.flatnonzero(actions[:, :, 0].max(axis=1) > 0.5)
        end = min(len(actions), int(touched[-1]) + REST if len(touched) else len(actions))
        moments = np.arange(0, end, EVERY)
        ahead = np.minimum(moments[:, None] + np.arange(0, CHUNK, STRIDE), len(actions) - 1)
        start = references(observed, surface)[moments]
        seen.append(sights(observed, surface)[moments])
        touch.append(actions[ahead, :, 0])
        places.append(actions[ahead, :, 1:] - start[:, None])
    return np.concatenate(seen), np.concatenate(touch), np.concatenate(places)


# Playing


class Player:
    """Plays one episode with a policy.

    Args:
        policy: The policy.
        surface: The touch surface.
        first: The first observation.

    Raises:
        InputError: The policy was trained by another version, which has other inputs.
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
                got=f"a policy with {len(policy.mean)} inputs",
                expected=str(size),
                remedy="Train it again from its demonstrations",
            )

    def see(self, observation: Mapping[str, Array]) -> None:
        """Adds an observation."""
        for name, values in self._history.items():
            values.append(observation[name])

    def act(self) -> Array:
        """Returns the action (15,) for the next control period."""
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
        env: An environment whose actions are touches, with all parts of the observation.
        policy: The policy.
        seed: Seed of the trial.

    Returns:
        Whether the episode succeeded, and its duration (s).
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


# The command


def main() -> None:
    """Trains or reads a policy, plays the trials, and prints the success rate."""
    options = _options()
    data = read_npz(options.demonstrations)
    env: Any = gymnasium.make(register_task(data.task), **data.options).unwrapped
    (surface,) = env.surfaces
    if options.load:
        policy = Policy.load(options.load)
    else:
        episodes = data.episodes[: options.count]
        print(f"trains on {len(episodes)} demonstrations")
        policy = clone(episodes, surface, options.seed)
    if options.save:
        policy.save(options.save)
    won = 0
    for seed in options.seeds:
        success, seconds = play(env, policy, seed)
        won += success
        print(seed, "succeeded" if success else "failed", f"after {seconds:.1f} s", flush=True)
    env.close()
    count = len(options.seeds)
    low, high = (100 * end for end in wilson(won, count))
    print(f"{won} of {count} succeeded, 95 % interval {low:.0f} to {high:.0f} %")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "demonstrations", type=Path, help="a data set that `sandbox export --to FILE.npz` wrote"
    )
    parser.add_argument("--count", type=int, help="train on the first COUNT demonstrations")
    parser.add_argument(
        "--seeds",
        type=parse_seeds,
        default="30000:30100",
        help="trials for the policy to play, such as 30000:30100 (the default) or 3,17,40:50",
    )
    parser.add_argument(
        "--seed", type=int, default=0, help="seed of the initial weights and of the samples' order"
    )
    parser.add_argument("--save", type=Path, metavar="POLICY.npz", help="write the policy")
    parser.add_argument(
        "--load", type=Path, metavar="POLICY.npz", help="play a saved policy instead of training"
    )
    return parser.parse_args()


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        sys.exit(str(error))
