"""What is to be done, and whether it was done."""

import models  # noqa: F401  (before NumPy: it pins the BLAS kernel)
