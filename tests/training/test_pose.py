"""The pose of any person: trained on people, normalised by the size of their hands."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from encoders.capture import Capture
from encoders.evaluation.pose_errors import pose_errors
from encoders.input_vector import contact_vectors
from encoders.regression.trained import TrainedModel, builtin, load_model
from encoders.regression.training import save_model
from models.pose import ROOT_POSITION, relative_pose
from training.population import Population, simulate_population
from training.pose import at_trained_size, train_population


@cache
def few() -> Population:
    groups = {
        "train": {"first": 2, "second": 5, "posed": 25},
        "choose": {"first": 1, "second": 2, "posed": 0},
    }
    return simulate_population("pose", groups)


def trained_on(population: Population) -> TrainedModel:
    people = population.of(group="train")
    return train_population(people.people, {"digest": people.digest, **people.meta})


@cache
def trained() -> TrainedModel:
    return trained_on(few())


def grown(person: Capture, factor: float) -> Capture:
    """The same person, scaled."""
    q = person.q.copy()
    q[:, ROOT_POSITION] *= factor
    size = factor * person.meta["size"]
    return replace(person, xy=person.xy * factor, q=q, meta=person.meta | {"size": size})


@pytest.mark.slow
def test_a_larger_hand_in_the_same_posture_gets_the_same_joint_angles() -> None:
    person = few().of(group="choose").people[0]
    encoder = builtin("population").encoder
    for factor in (0.9, 1.1):
        larger = grown(person, factor)
        alike = at_trained_size(larger, larger.meta["size"])
        expected = at_trained_size(person, person.meta["size"])
        q, known = encoder.predict(alike.u), encoder.predict(expected.u)
        np.testing.assert_allclose(q, known, atol=1e-7)


def test_training_does_not_depend_on_the_size_of_hands() -> None:
    people = few().of(group="train").people
    larger = [grown(person, 1.1) for person in people]
    model = train_population(larger, trained().meta["population"])
    u = few().of(group="choose").people[0].u
    np.testing.assert_allclose(model.encoder.predict(u), trained().encoder.predict(u), atol=1e-4)


def test_people_who_are_held_out_are_not_trained_on() -> None:
    shipped = builtin("population").meta["population"]["people"]
    assert set(shipped) == {"first", "second", "posed"}
    without = few().of(without="second")
    model = trained_on(without)
    numbers = model.meta["population"]["people"]
    assert set(numbers) == {"first", "posed"}
    learned = {(source, n) for source, known in numbers.items() for n in known}
    expected = {
        (p.meta["source"], p.meta["number"])
        for p in few().people
        if p.meta["group"] == "train" and p.meta["source"] != "second"
    }
    assert learned == expected
    # Whoever is left out changes nothing, and whoever is not does.
    again = trained_on(without)
    assert again.digest == model.digest != trained().digest


def test_equal_people_give_equal_models_and_a_file_keeps_all_of_them(tmp_path: Path) -> None:
    assert trained_on(few()).digest == trained().digest
    save_model(trained(), tmp_path / "p.npz")
    back = load_model(tmp_path / "p.npz")
    assert back.digest == trained().digest
    np.testing.assert_array_equal(back.personal_covariance, trained().personal_covariance)


def test_strangers_of_both_generators_get_better_poses_than_from_one_persons_encoder() -> None:
    errors: dict[str, list[list[float]]] = {name: [] for name in ("population", "quadratic")}
    for person in simulate_population("strangers", {"judge": {"first": 4, "second": 4}}).people:
        sized = at_trained_size(person, person.meta["size"])
        u, leftmost = contact_vectors(sized.xy)
        truth = relative_pose(sized.q, leftmost)
        for name, found in errors.items():
            e = pose_errors(builtin(name).encoder.predict(u), truth)
            found.append([e.wrist.mean(), e.angle.mean()])
    population, one_person = (np.mean(found, axis=0) for found in errors.values())
    assert (population < one_person).all()
