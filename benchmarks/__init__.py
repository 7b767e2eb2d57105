"""Measurements: each prints the machine, what was measured and against what."""

import models  # noqa: F401  (before NumPy: it pins the BLAS kernel)
