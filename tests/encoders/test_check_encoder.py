"""`check_encoder` finds what is wrong with an encoder, and nothing wrong with ours."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike

from encoders import check_encoder
from encoders.capture import Capture
from encoders.regression.encoder_registry import ENCODERS
from encoders.regression.trained import builtin_capture
from models.arithmetic import Array
from models.errors import EncoderError
from tests.encoders.test_own_encoder import NAME, Mean


@pytest.fixture(scope="module")
def capture() -> Capture:
    """Every fortieth frame of the built-in capture: all takes, quickly learned."""
    return builtin_capture().select(np.arange(0, len(builtin_capture()), 40))


class Counting(Mean):
    """Predicts something else every time."""

    predictions = 0

    def predict(self, U: ArrayLike) -> Array:
        self.predictions += 1
        return super().predict(U) + 1e-4 * self.predictions


class NoPose(Mean):
    """Predicts nothing."""

    def predict(self, U: ArrayLike) -> Array:
        return np.full((*np.shape(U)[:-1], 48), np.nan)


class Drawn(Mean):
    """Learns something else every time, and stores it."""

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Drawn:
        super().fit(U, Q)
        self.mean = self.mean + np.random.default_rng().normal(0.0, 1.0, 48)
        return self

    def arrays(self) -> dict[str, Array]:
        return {"mean": self.mean}

    def restore(self, arrays: object, U: Array, Q: Array) -> Drawn:
        assert isinstance(arrays, dict)
        self.mean = arrays["mean"]
        return self


@pytest.mark.parametrize("name", ["linear", "quadratic", "turned"])
def test_our_encoders_keep_to_the_rules(name: str, capture: Capture) -> None:
    check_encoder(ENCODERS[name], capture)


def test_the_example_keeps_to_the_rules_by_its_place() -> None:
    check_encoder(NAME)


@pytest.mark.parametrize("encoder", [Counting, NoPose, Drawn, dict, "no-such-encoder"])
def test_an_encoder_that_breaks_a_rule_is_refused_in_one_line(
    encoder: type | str, capture: Capture
) -> None:
    with pytest.raises(EncoderError) as error:
        check_encoder(encoder, capture)
    assert "\n" not in str(error.value)
