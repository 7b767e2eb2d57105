"""Behaviour cloning: a policy that does what demonstrations did, the extra `learn`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.frames import FINGERS
from models.surface import Surface
from sandbox.datasets.demonstration import Demonstration
from sandbox.learning.policy import BOUND, CHUNK, NUMBERS, STRIDE, UNIT, Policy
from sandbox.learning.sight import in_first_slots, references, sights

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
            "PyTorch is not installed", where="learning", remedy="pip install 'hand-sandbox[learn]'"
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
