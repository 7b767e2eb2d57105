"""The labellings are all ways to give contacts different fingers."""

from itertools import permutations

import pytest

from encoders.labels.labelling import hypotheses
from models.errors import EncoderError


@pytest.mark.parametrize("count", range(1, 6))
def test_every_way_to_pick_fingers_is_a_labelling(count: int) -> None:
    assert sorted(map(tuple, hypotheses(count).tolist())) == list(permutations(range(5), count))


@pytest.mark.parametrize("count", [0, 6, -1])
def test_no_hand_has_other_numbers_of_fingers(count: int) -> None:
    with pytest.raises(EncoderError, match="number of contacts"):
        hypotheses(count)
