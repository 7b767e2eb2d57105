"""The page's colours differ for every kind of colour vision, and can be read on its dark ground."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from models.arithmetic import Array
from sandbox.views import palette

ROOT = Path(__file__).resolve().parents[3]
PALETTES = json.loads((ROOT / "sandbox/views/page/src/palettes.json").read_text(encoding="utf-8"))
TABLE, PILL = "#26333c", "#080c0f"
"""Behind rings and goals, and behind names."""

VISION = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
"""Linear RGB as others see it, at full severity: Machado, Oliveira and Fernandes, A
Physiologically-based Model for Simulation of Color Vision Deficiency (2009), table 1."""

XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""Linear sRGB to XYZ, D65 (IEC 61966-2-1)."""


def linear(colour: str) -> Array:
    """(3,) linear RGB of a colour like #ff8800."""
    srgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def lab(colour: str, vision: str) -> Array:
    """(3,) CIE L*a*b* of what somebody sees."""
    seen = np.clip(np.asarray(VISION[vision]) @ linear(colour), 0.0, 1.0)
    x = XYZ @ seen / (XYZ @ np.ones(3))
    f = np.where(x > (6 / 29) ** 3, np.cbrt(x), x / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def distance(one: str, other: str, vision: str) -> float:
    """CIE 1976 difference of two colours as somebody sees them; 2.3 can just be noticed."""
    return float(np.linalg.norm(lab(one, vision) - lab(other, vision)))


def nearest(name: str, vision: str) -> float:
    """Smallest difference of two fingers, or of a finger and the goal."""
    chosen = PALETTES[name]
    pairs = combinations([*chosen["fingers"], chosen["goal"]], 2)
    return min(distance(one, other, vision) for one, other in pairs)


def contrast(one: str, other: str) -> float:
    """Contrast ratio (WCAG 2.2)."""
    light, dark = sorted((float(XYZ[1] @ linear(c)) for c in (one, other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("vision", VISION)
def test_colours_for_colour_blind_people_differ_for_every_kind_of_vision(vision: str) -> None:
    # Seven times what can just be noticed.
    assert nearest("okabe-ito", vision) > 16.0


@pytest.mark.parametrize("vision", VISION)
def test_a_goal_changes_visibly_when_it_is_reached_and_held(vision: str) -> None:
    chosen = PALETTES["okabe-ito"]
    states = [chosen[state] for state in ("goal", "reached", "held")]
    assert min(distance(a, b, vision) for a, b in combinations(states, 2)) > 20.0


@pytest.mark.parametrize("name", PALETTES)
def test_all_colours_can_be_read_on_the_dark_page(name: str) -> None:
    chosen = PALETTES[name]
    for colour in chosen["fingers"]:
        assert contrast(colour, PILL) > 4.5
    for colour in (*chosen["fingers"], chosen["goal"], chosen["reached"], chosen["held"]):
        assert contrast(colour, TABLE) > 3.0


def test_the_standard_colours_are_those_of_the_window() -> None:
    chosen = PALETTES["standard"]
    window = [*palette.FINGER_COLOURS, palette.GOAL, palette.REACHED, palette.HELD]
    page = [*chosen["fingers"], chosen["goal"], chosen["reached"], chosen["held"]]
    for one, other in zip(window, page, strict=True):
        rgb = [int(other[i : i + 2], 16) for i in (1, 3, 5)]
        np.testing.assert_allclose(palette.bytes_of(one)[:3], rgb, atol=1)
