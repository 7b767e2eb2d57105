"""Kinds of data sets, by the words after --to that stand for them."""

from __future__ import annotations

from pathlib import Path

from models.errors import InputError

MINARI, LEROBOT, NPZ = "minari", "lerobot", ".npz"
"""Words after --to that stand for data sets, and the ending of a file that is one."""
NAMED = {MINARI: "hand_sandbox/box-to-goal/mine-v0", LEROBOT: "me/box-to-goal"}
"""Word of a kind whose data sets have names -> such a name."""


def is_data_set(to: Path) -> bool:
    """True if a word after --to stands for a data set.

    Raises:
        InputError: It is that of a data set, and lacks a part.
    """
    if str(to) == "npz":
        raise InputError("name the file", where=f"--to {to}", expected="FILE.npz")
    return str(to) in NAMED or to.suffix.lower() == NPZ
