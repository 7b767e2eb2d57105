"""A hand held still in the air, as it rests on a screen, is a sample of its rest posture."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.correction import PAD_HEIGHT
from encoders.person.rest_posture import SECONDS, SeenRest, check_rest_samples
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import JOINTS, ROOT_POSITION
from models.skeleton import ADULT
from tests.encoders.person.resting_hand import resting

RATE = 30.0
HAND = Kinematics(ADULT)


def shown(seen: SeenRest, poses: Array, begin: float = 0.0) -> list[bool]:
    return [seen.add(begin + i / RATE, q) for i, q in enumerate(poses)]


def trembling(q: Array, seconds: float, by: float = 0.001, seed: int = 0) -> Array:
    """Poses of a hand whose wrist and joints shake by m and by five times as many rad."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(0.0, by, (round(seconds * RATE), len(q)))
    noise[:, 3:] *= 5.0
    return q + noise


def moved(q: Array, by: tuple[float, float, float]) -> Array:
    other = q.copy()
    other[ROOT_POSITION] += by
    return other


def test_a_still_hand_is_a_look_wherever_it_is_held() -> None:
    q = resting()
    for place in ((0.0, 0.0, 0.0), (0.2, -0.1, 0.35)):
        seen = SeenRest(ADULT)
        assert sum(shown(seen, trembling(moved(q, place), 1.5))) == 1
        (sample,) = seen.samples
        check_rest_samples(seen.samples, 1.0)
        tips, pose = HAND.tips(q), np.array(sample.pose)
        touches = np.array(sample.touches)
        # What a sample is used for is relative: layout, height of the wrist, joints.
        layout = tips[:, :2] - tips[0, :2]
        assert np.abs((touches - touches[0]) * [1.0, -1.0] - layout).max() < 0.002
        assert abs(pose[2] - (q[2] - np.median(tips[:, 2]) + PAD_HEIGHT)) < 0.002
        assert np.abs(pose[JOINTS] - q[JOINTS]).max() < np.radians(1.0)


def test_a_hand_that_moves_is_no_look() -> None:
    q = resting()
    sliding = np.array([moved(q, (0.03 * i / RATE, 0.0, 0.0)) for i in range(60)])
    seen = SeenRest(ADULT)
    assert not any(shown(seen, sliding)) and seen.trouble == ""


def test_less_than_a_second_is_no_look() -> None:
    seen = SeenRest(ADULT)
    assert not any(shown(seen, trembling(resting(), 0.8 * SECONDS)))
    seen.lose()
    assert not any(shown(seen, trembling(resting(), 0.8 * SECONDS), 1.0))


def test_the_next_look_needs_another_rest() -> None:
    seen, q = SeenRest(ADULT), resting()
    assert sum(shown(seen, trembling(q, 4.0))) == 1
    assert sum(shown(seen, trembling(moved(q, (0.05, 0.0, 0.0)), 2.0), 4.0)) == 1
    assert len(seen.samples) == 2


def test_fingertips_that_are_not_on_one_level_are_told() -> None:
    q = resting()
    q[JOINTS.start + 6] += 0.8  # the index finger, raised at its knuckle
    seen = SeenRest(ADULT)
    assert not any(shown(seen, trembling(q, 2.0)))
    assert "index is" in seen.trouble and "above the other fingertips" in seen.trouble


@pytest.mark.parametrize("size", [0.85, 1.15])
def test_hands_of_other_sizes_fit_their_touches(size: float) -> None:
    skeleton = ADULT.scaled(size)
    q = resting(size)
    seen = SeenRest(skeleton)
    assert sum(shown(seen, trembling(q, 1.5))) == 1
    check_rest_samples(seen.samples, size)
