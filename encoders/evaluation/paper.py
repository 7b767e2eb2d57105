"""What Chung, Kim, Han and Pollard (2015) measured: one real person's hand, which nobody else has.

It stands beside our numbers for comparison of orders of magnitude; it is another data set.
"""

from __future__ import annotations

TABLE_1: dict[str, tuple[float, float, float, float]] = {
    "linear": (3.9837, 0.0510, 9.0774, 0.0362),
    "quadratic": (2.5520, 0.0479, 8.5656, 0.0368),
    "cubic": (3.1652, 0.0415, 9.9411, 0.0424),
    "pca-ik": (4.1488, 0.0440, 11.7594, 0.0455),
}
"""Method -> wrist distance (cm) and its standard error, joint angle (degrees) and its own."""

TABLE_2: dict[str, tuple[float, float, float, float]] = {
    "linear": (52.66, 34.04, 64.35, 66.87),
    "quadratic": (55.66, 70.72, 79.36, 99.88),
    "cubic": (56.24, 52.38, 86.49, 99.33),
    "pca-ik": (51.85, 51.50, 48.15, 62.88),
}
"""Method -> frames labelled right (%) with 2, 3, 4 and 5 fingers."""

OVERFITTED_JOINTS: dict[str, float] = {"linear": 7.3, "quadratic": 9.8, "cubic": 18.6}
"""Method -> joints that the Copas test calls overfitted, mean over ten folds (section 4)."""

US_PER_POSE: dict[str, float] = {"quadratic": 2.1, "pca-ik": 66189.8}
"""Method -> microseconds for one pose, on the authors' machine of 2015 (section 4)."""

PCA_VARIANCE: dict[int, float] = {3: 68.0, 6: 87.0, 9: 94.0, 12: 97.0}
"""Principal components -> percent of the training data's variance (section 3)."""

SAME_AS: dict[str, str] = {"paper": "quadratic"}
"""Our name -> the paper's row that it stands for, where the names differ."""


def row(name: str) -> str:
    """The paper's name of one of our methods; its own name where the paper has none."""
    return SAME_AS.get(name, name)
