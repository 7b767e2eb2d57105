"""JSON values and damaged texts for tests of what is read from outside."""

from __future__ import annotations

from hypothesis import strategies as st

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=6,
)
"""Anything that `json` writes, NaN and Infinity included."""

_PIECES = [
    b"",
    b"null",
    b"true",
    b"0",
    b"-1",
    b"1e999",
    b"NaN",
    b'"x"',
    b"[]",
    b"{}",
    b"}",
    b"]",
    b",",
    b"\xff",
    b"\x00",
    b"\n",
    b'"\\ud800"',
    b"[" * 3000,
    b"9" * 400,
]


@st.composite
def damaged(draw: st.DrawFn, sound: bytes) -> bytes:
    """A sound text with a piece of it replaced, cut short or doubled."""
    at = draw(st.integers(0, len(sound)))
    to = min(len(sound), at + draw(st.integers(0, 12)))
    kind = draw(st.sampled_from(["replace", "cut", "double", "shuffle"]))
    if kind == "replace":
        return sound[:at] + draw(st.sampled_from(_PIECES)) + sound[to:]
    if kind == "cut":
        return sound[:at]
    if kind == "double":
        return sound[:to] + sound[at:]
    return sound[:at] + sound[at:to][::-1] + sound[to:]
