"""A rest posture seen once: it removes what a hand does differently all the time."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.capture import Capture
from encoders.person.rest_posture import (
    MOST,
    check_rest_samples,
    knowing_rest,
    load_rest,
    rest_samples,
    save_rest,
)
from encoders.regression.trained import TrainedModel, builtin
from encoders.store import save_capture
from models.errors import EncoderError, InputError
from models.person import RestSample
from models.pose import absolute_pose
from training.population import simulate_population
from training.pose import at_trained_size

PLANTED = 0.1
"""rad, bending of all fingers' middle joints beyond what the encoder expects."""
BENT = 6 + 3 * np.array([3, 6, 9, 12])


@cache
def person() -> Capture:
    one = simulate_population("rest", {"judge": {"second": 1}}).people[0]
    return at_trained_size(one, one.meta["size"])


def model() -> TrainedModel:
    return builtin("population")


def planted() -> Capture:
    """A person who does what the encoder expects, but bends the fingers more."""
    q = absolute_pose(model().encoder.predict(person().u), person().leftmost)
    q[:, BENT] += PLANTED
    return replace(person(), q=q)


def missing(known: TrainedModel, capture: Capture) -> float:
    """Mean error (rad) of the bent joints, with its sign."""
    off = known.encoder.predict(capture.u) - capture.relative
    return float(off[:, BENT].mean())


def test_a_planted_offset_is_removed_and_more_looks_remove_more() -> None:
    seen = planted()
    samples = rest_samples(seen)
    left = [
        abs(missing(knowing_rest(model(), samples[:n], 1.0), seen)) for n in (1, 4, len(samples))
    ]
    assert abs(missing(model(), seen)) == pytest.approx(PLANTED, abs=1e-9)
    assert PLANTED > left[0] > left[1] > left[2]
    assert left[2] < 0.6 * PLANTED


def test_looks_at_what_the_encoder_expects_change_nothing() -> None:
    expected = absolute_pose(model().encoder.predict(person().u), person().leftmost)
    known = knowing_rest(model(), rest_samples(replace(person(), q=expected)), 1.0)
    u = person().u[:20]
    np.testing.assert_allclose(known.encoder.predict(u), model().encoder.predict(u), atol=1e-4)


def test_one_pose_is_the_pose_of_many() -> None:
    known = knowing_rest(model(), rest_samples(planted()), 1.0).encoder
    u = person().u[:5]
    np.testing.assert_allclose([known.predict(row) for row in u], known.predict(u), atol=1e-9)


def test_a_seen_hand_is_less_uncertain_in_no_direction_more() -> None:
    known = knowing_rest(model(), rest_samples(planted()), 1.0)
    told = model().residual_covariance - known.residual_covariance
    assert np.linalg.eigvalsh(told).min() > -1e-7 < np.linalg.eigvalsh(told).max()
    assert np.linalg.eigvalsh(known.residual_covariance).min() > -1e-6


def test_size_changes_lengths_and_no_angles() -> None:
    samples = rest_samples(planted())
    larger = tuple(
        RestSample(
            tuple(p and (1.1 * p[0], 1.1 * p[1]) for p in sample.touches),
            tuple((np.array(sample.pose) * np.r_[np.full(3, 1.1), np.ones(45)]).tolist()),
        )
        for sample in samples
    )
    u = person().u[:20]
    same = knowing_rest(model(), larger, 1.1).encoder.predict(u)
    np.testing.assert_allclose(
        same, knowing_rest(model(), samples, 1.0).encoder.predict(u), atol=1e-6
    )


def test_an_encoder_of_one_person_cannot_use_a_rest_posture() -> None:
    with pytest.raises(EncoderError, match="--encoder cubic: this encoder cannot use"):
        knowing_rest(builtin("cubic"), rest_samples(person()), 1.0)


@pytest.mark.parametrize("hand", ("right", "left"))
def test_a_file_gives_back_its_looks(tmp_path: Path, hand: str) -> None:
    samples = rest_samples(person(), 3)
    save_rest(samples, tmp_path / "rest.json", hand, simulated=True)
    assert load_rest(tmp_path / "rest.json", hand, 1.0) == samples
    first = json.loads((tmp_path / "rest.json").read_text())["looks"][0]
    touch = next(i for i, place in enumerate(samples[0].touches) if place)
    sign = 1 if hand == "right" else -1
    known = samples[0].touches[touch]
    assert known is not None and first["touches"][touch] == [sign * known[0], known[1]]


def test_a_capture_is_a_rest_posture_as_well(tmp_path: Path) -> None:
    save_capture(person(), tmp_path / "me.npz", np.float64)
    assert load_rest(tmp_path / "me.npz", "right", 1.0) == rest_samples(person())
    assert 1 <= len(rest_samples(person())) <= MOST


def test_a_capture_of_a_left_hand_is_a_left_hands_rest_posture(tmp_path: Path) -> None:
    # As `sandbox capture --side left` writes it: mirrored, and saying so.
    meta = {**person().meta, "side": "right", "recorded_side": "left"}
    save_capture(replace(person(), meta=meta), tmp_path / "me.npz", np.float64)
    assert load_rest(tmp_path / "me.npz", "left", 1.0) == rest_samples(person())
    with pytest.raises(InputError, match="other hand"):
        load_rest(tmp_path / "me.npz", "right", 1.0)


def test_a_file_that_cannot_be_written_costs_nothing_that_was_there(tmp_path: Path) -> None:
    (tmp_path / "me.json").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        save_rest(rest_samples(person()), tmp_path / "me.json", "right", simulated=True)
    assert (tmp_path / "me.json").is_dir()


@pytest.mark.parametrize(
    "wrong",
    (
        {"schema": 9},
        {"kind": "a cake"},
        {"hand": "left"},
        {"looks": []},
        {"looks": [{"touches": [None] * 5, "pose": [0.0] * 48}]},
        {"looks": [{"touches": [[0, 0]] * 5, "pose": [0.0]}]},
        {"looks": [{"touches": [[0, 0]] * 5, "pose": [0.0] * 20 + [3.0] * 28}]},
        {"looks": [{"touches": [[0, 0]] * 5, "pose": [0.0] * 48}]},
    ),
)
def test_a_file_that_cannot_be_used_is_refused(tmp_path: Path, wrong: dict[str, Any]) -> None:
    path = tmp_path / "rest.json"
    save_rest(rest_samples(person(), 2), path, "right", simulated=True)
    path.write_text(json.dumps(json.loads(path.read_text()) | wrong))
    with pytest.raises(InputError):
        load_rest(path, "right", 1.0)


def test_two_swapped_fingers_are_noticed() -> None:
    sample = next(k for k in rest_samples(person()) if None not in k.touches)
    thumb, *others, little = sample.touches
    with pytest.raises(EncoderError, match="far from its touch"):
        check_rest_samples([RestSample((little, *others, thumb), sample.pose)], 1.0)
