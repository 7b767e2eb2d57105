"""The shipped skin is what its recipe makes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.skin.skin import FULL, Skin, dense, normals_of
from training.skin.field import HandField
from training.skin.make_skin import STEP, extras, tone_of
from training.skin.weights import weights_of


def flesh() -> tuple[Array, NDArray[np.int64], Array]:
    """Vertices, triangles and shares of the skin proper."""
    skin = Skin.builtin()
    part = skin.part("skin")
    return skin.rest[part.vertices], skin.triangles[part.triangles], skin.shares[part.vertices]


def test_the_shipped_skin_lies_on_the_field_it_was_made_from() -> None:
    rest, _, _ = flesh()
    assert np.abs(HandField()(rest)).max() < 3 * STEP


def test_the_shipped_weights_and_tones_are_those_of_the_shipped_surface() -> None:
    rest, triangles, shares = flesh()
    bones, weights = weights_of(HandField(), rest, triangles)
    # Places were rounded after the weights were made.
    assert np.abs(dense(bones, weights) - shares).max() <= 3 / FULL
    tone = tone_of(HandField(), rest, normals_of(rest, triangles))
    part = Skin.builtin().part("skin")
    assert np.abs(tone - Skin.builtin().tone[part.vertices]).max() <= 5 / 255


def test_shipped_nails_cuff_and_sleeve_are_those_of_the_recipe() -> None:
    skin = Skin.builtin()
    made = extras(HandField())
    assert [p.name for p in skin.parts[1:]] == [piece[0] for piece in made]
    for part, piece in zip(skin.parts[1:], made, strict=True):
        assert np.abs(skin.rest[part.vertices] - piece[1]).max() <= STEP
        assert np.array_equal(skin.triangles[part.triangles] - part.vertices.start, piece[2])
