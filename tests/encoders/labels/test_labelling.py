"""The labellings are all ways to give contacts different fingers."""

from itertools import permutations

import pytest

from encoders.labels.labelling import hypotheses
from models.errors import EncoderError


@pytest.mark.parametrize(("count", "number"), [(1, 5), (2, 20), (3, 60), (4, 120), (5, 120)])
def test_there_are_as_many_labellings_as_ways_to_pick_fingers(count: int, number: int) -> None:
    assert sorted(map(tuple, hypotheses(count).tolist())) == list(permutations(range(5), count))
    assert len(hypotheses(count)) == number


@pytest.mark.parametrize("count", [0, 6, -1])
def test_no_hand_has_other_numbers_of_fingers(count: int) -> None:
    with pytest.raises(EncoderError, match="number of contacts"):
        hypotheses(count)
