"""Behaviour cloning: a policy that learns from demonstrations, and how often it succeeds.

    sandbox regress --tasks box-to-goal --arm plain --seeds 20000:20200 \\
        --record demonstrations --record-all
    sandbox export demonstrations --to demonstrations.npz --successes
    python examples/behaviour_cloning.py demonstrations.npz --seeds 30000:30100

The first line records a simulated user; `sandbox play --record` records a person. Such a policy
shows what demonstrations are worth: the better a hand is followed, the more often those succeed who
learn from it.

It sees, of the thing: its turn, touches and the goal relative to it, and how far each touch has to
go to bring it to its goal. Of the finger that follows a touch: where its tip is, its force, and
whether it is solid. Of time: the phase of the hand's arrival, touches of the last half second, and
how long fingers have touched and have not moved. No pictures. It does not see how fingers were
named: in one of three demonstrations the program takes the user's index and middle finger for
others; so touches take the slots 0, 1, 2 in the order of their fingers.

It plans the touches of the next 24 control periods, of which 20 (about a third of a second) are
carried out before it plans anew.

Demonstrations have one hand, and a task in which one thing has to come to one goal: box-to-goal and
insert were tried. A thing that is as long as wide may lie at its goal by any quarter turn, a longer
one by half a turn. Other things, such as the pins of slalom, are not seen.

Training takes about a minute of one processor for any number of demonstrations, and needs PyTorch
(`pip install torch`). A policy that was trained (`--save`) plays with NumPy alone (`--load`).
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

# What it sees

SEEN = ("objects", "goals", "properties", "tips", "touches", "labels", "solid", "phase", "contact")
"""Parts of an observation that it uses."""
LAGS = (0, 6, 15, 30)
"""Control periods ago at which touches are seen as well; the longest is half a second."""
MEMORY = 90
"""Control periods that an observer has to remember."""
LONGEST_TOUCH, LONGEST_REST = 1.0, 0.8
"""s after which a policy does not tell how long fingers have touched, and have not moved."""
MOVED, WITHIN = 0.004, 5
"""m by which a finger has to move, within so many control periods, to count as moving: trembling is
less."""
NEAR, STRAIGHT = (0.01, 0.0025), np.deg2rad([10.0, 2.5])
"""m and rad, within which differences from the goal are seen in more detail: people let go of a
thing that is within 2 mm of its goal, after they have moved it by 80."""
SQUARE = 0.01
"""Share by which two edges of a square thing differ at most."""


def places_of(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, 2) m on the surface, where the first object is."""
    return surface.to_surface(observations["objects"][:, 0, :3])


def references(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, 5, 2) m on the surface, the references of the next places of touches.

    It is where a touch is, and where the first object is for a finger that does not touch.
    """
    touches = observations["touches"]
    down = touches[:, :, :1] > 0.5
    return np.where(down, touches[:, :, 1:], places_of(observations, surface)[:, None])


def sights(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, n) what is seen at each of T moments, from those moments and the ones before.

    Places are relative to the first object, in m times a factor that makes them about 1. A turn is
    the shortest one to a goal that looks the same every quarter turn, if the thing is as long as
    wide, and else every half turn. Of a longer thing it is also seen how far it is from its goal
    along the goal and across it, as for what has to be lined up with a slot. Of the hand, a touch
    shows the finger that follows it, by whatever name.

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
    """(T,) number of turns in which a thing looks the same from above, by half its edges (T, 2)
    m."""
    low, high = half.min(axis=1), half.max(axis=1)
    return np.where(high - low <= SQUARE * high, 4.0, 2.0)


def _along(goals: Array, objects: Array) -> Array:
    """(T, 2) m from a thing to its goal, along the goal's first axis and across it."""
    x, y = (goals[:, :2] - objects[:, :2]).T
    c, s = np.cos(goals[:, 3]), np.sin(goals[:, 3])
    return np.stack([c * x + s * y, c * y - s * x], axis=1)


def _fingers_of_touches(
    observations: Mapping[str, Array],
) -> tuple[Array, Array, Array, Array]:
    """The finger that follows each touch, whatever it was named.

    Returns:
        (T, 5) 1 where the touch has a name; (T, 5, 3) m where that finger's tip is; (T, 5) 1 where
        it is solid; (T, 5) N its force. All are 0 without a name.
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
    """A demonstration whose touches have the first slots, in the order of their fingers.

    Fingers are named as the program found them, which differs between trials in which people did
    the same. From the first touch to a moment without touches, the fingers that touch take the
    slots 0, 1, 2 ... in their order.

    Args:
        observations: Name -> (T + 1, ...) parts of observations with one hand.
        actions: (T, 15) the touches of each control period.
    """
    rows = actions.reshape(len(actions), -1, 3)
    order = _orders(rows[:, :, 0] > 0.5)
    rows = np.take_along_axis(rows, order[:, :, None], axis=1)
    order = np.concatenate([order[:1], order])
    touches = np.take_along_axis(observations["touches"], order[:, :, None], axis=1)
    labels = np.take_along_axis(observations["labels"], order, axis=1)
    return {**observations, "touches": touches, "labels": labels}, rows.reshape(actions.shape)


def _orders(down: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(T, 5) old slot of each new slot, the same from a first touch to the end of the last one."""
    order = np.tile(np.arange(down.shape[1]), (len(down), 1))
    any_down = np.concatenate([[False], down.any(axis=1), [False]])
    edges = np.flatnonzero(np.diff(any_down.astype(int)))
    for begin, end in edges.reshape(-1, 2):
        used = down[begin:end].any(axis=0)
        # An observation shows the touches of the step before, so the order holds one step longer.
        order[begin : end + 1] = np.concatenate([np.flatnonzero(used), np.flatnonzero(~used)])
    return order


def _ways_of_touches(grip: Array, way: Array, turn: Array) -> Array:
    """(T, 5, 2) m from where touches are to where they would be with the thing at its goal.

    Args:
        grip: (T, 5, 2) m from the thing to the touches.
        way: (T, 2) m from the thing to its goal.
        turn: (T,) rad by which the thing has yet to be turned about the upward vertical; the
            surface's second axis points towards the person, so it is the other way round there.
    """
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    x, y = grip[..., 0], grip[..., 1]
    turned = np.stack([c * x + s * y, c * y - s * x], axis=-1)
    return way[:, None] + turned - grip


def _clocks(down: Array, places: Array) -> Array:
    """(T, 2) s since fingers touched or left, and since they moved; 0 while none touches."""
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
    """The moments that a policy remembers."""
    return {name: np.array(values[-MEMORY:]) for name, values in history.items()}


# The policy

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
BOUND = 6.0
"""Standard deviations beyond which nothing is seen."""
UNIT = 20.0
"""Factor by which places, m, are about 1."""


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


# Training

STEPS, BATCH = 5000, 256
"""Steps of the training and moments in each, the same for any number of demonstrations."""
WIDTH, LAYERS, DROPOUT = 256, 3, 0.1
RATE, DECAY = 2e-3, 1e-3
"""Greatest rate of learning, and weight decay."""
EVERY = 2
"""Moments of demonstrations that are learned from are so many control periods apart."""
REST = 45
"""Control periods after the last touch that are learned from: what follows is only waiting."""


def clone(episodes: Sequence[Demonstration], surface: Surface, seed: int = 0) -> Policy:
    """Trains a policy.

    Whether fingers touch is learned by cross entropy, and where, for those that do, by the absolute
    error, which trembling disturbs less than the squared one.

    Args:
        episodes: Demonstrations with one hand, whose actions are touches by finger.
        surface: The touch surface.
        seed: Seed of the first weights and of the order of moments.

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
    """What was seen (N, n), what touched (N, K, 5), and where (N, K, 5, 2) m from references."""
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
        env: An environment whose actions are touches, with everything to be observed.
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


# The command


def main() -> None:
    """Trains a policy or reads one, plays, and prints how often it succeeded."""
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
    parser.add_argument("--count", type=int, help="trains on the first COUNT demonstrations")
    parser.add_argument(
        "--seeds",
        type=parse_seeds,
        default="30000:30100",
        help="trials that the policy plays, such as 30000:30100 (the default) or 3,17,40:50",
    )
    parser.add_argument(
        "--seed", type=int, default=0, help="of the first weights and of the order of moments"
    )
    parser.add_argument("--save", type=Path, metavar="POLICY.npz", help="writes the policy")
    parser.add_argument(
        "--load", type=Path, metavar="POLICY.npz", help="plays by a policy in place of training one"
    )
    return parser.parse_args()


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        sys.exit(str(error))
