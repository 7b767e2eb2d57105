"""Imports numba (extra `fast`), or raises an error with the way to install it."""

from __future__ import annotations

from models.errors import EncoderError

__all__ = ["ANY_ORDER", "NumbaError", "njit"]

try:
    from numba import njit
    from numba.core.errors import NumbaError
except ImportError as error:
    raise EncoderError(
        "compiled encoders need numba", remedy="pip install 'hand-sandbox[fast]', or leave out fast"
    ) from error

ANY_ORDER = {"reassoc", "contract", "nsz", "arcp"}
"""Sums may be taken in any order, which lets them run in parallel lanes; NaN stays NaN."""
