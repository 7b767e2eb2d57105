"""Results of Chung, Kim, Han and Pollard (2015) on one real person's unpublished data.

They are printed beside our numbers to compare orders of magnitude. Our numbers are from other data.
"""

from __future__ import annotations

TABLE_1: dict[str, tuple[float, float, float, float]] = {
    "linear": (3.9837, 0.0510, 9.0774, 0.0362),
    "quadratic": (2.5520, 0.0479, 8.5656, 0.0368),
    "cubic": (3.1652, 0.0415, 9.9411, 0.0424),
    "pca-ik": (4.1488, 0.0440, 11.7594, 0.0455),
}
"""Wrist distance (cm) and joint angle (degrees), each with its standard error, by method."""

TABLE_2: dict[str, tuple[float, float, float, float]] = {
    "linear": (52.66, 34.04, 64.35, 66.87),
    "quadratic": (55.66, 70.72, 79.36, 99.88),
    "cubic": (56.24, 52.38, 86.49, 99.33),
    "pca-ik": (51.85, 51.50, 48.15, 62.88),
}
"""Percentage of frames labelled right with 2, 3, 4 and 5 fingers, by method."""

OVERFITTED_JOINTS: dict[str, float] = {"linear": 7.3, "quadratic": 9.8, "cubic": 18.6}
"""Number of joints overfitted by the Copas test, mean over ten folds, by method (section 4)."""

US_PER_POSE: dict[str, float] = {"quadratic": 2.1, "pca-ik": 66189.8}
"""Microseconds for one pose on the authors' machine of 2015, by method (section 4)."""

PCA_VARIANCE: dict[int, float] = {3: 68.0, 6: 87.0, 9: 94.0, 12: 97.0}
"""Percentage of the training data's variance by number of principal components (section 3)."""

SAME_AS: dict[str, str] = {"paper": "quadratic"}
"""Our name of a method -> the paper's name, if they differ."""


def row(name: str) -> str:
    """The paper's name of one of our methods; our name if the paper has none."""
    return SAME_AS.get(name, name)
