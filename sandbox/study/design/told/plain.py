"""Letters without case and accents, in which words are looked for."""

from __future__ import annotations

import unicodedata


def plain(text: str) -> str:
    """Lower case without accents."""
    apart = unicodedata.normalize("NFKD", text.casefold().translate(_STROKES))
    return unicodedata.normalize(
        "NFC", "".join(c for c in apart if unicodedata.category(c) != "Mn")
    )


_STROKES = str.maketrans({"ø": "o", "ł": "l", "đ": "d", "’": "'"})
# Letters that Unicode does not take for one with an accent, and the apostrophe of printers.
