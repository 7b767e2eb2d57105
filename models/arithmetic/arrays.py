"""The array types that signatures name.

Shapes and units are in the docstrings of what uses them.
"""

import numpy as np
from numpy.typing import NDArray

# Numbers: positions, poses, times, probabilities.
Array = NDArray[np.float64]
# Which elements of another array.
Mask = NDArray[np.bool_]
