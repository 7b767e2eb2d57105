"""Values that only the owner of the project knows, and that may not be filled in yet.

A value in <angle brackets> is a placeholder.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SETTINGS = ROOT / "docs" / "site" / "settings.toml"
CLONED = "git clone ADDRESS"
"""Placeholder, in pages, of the command that clones the public repository."""
BEGINNINGS = ("README.md", "docs/getting-started.md")
"""Pages that contain this placeholder."""
_NO_ADDRESS = re.compile(r"^ADDRESS is .*\n\n", re.M)
"""Explanation of the placeholder in a page."""
_PLACEHOLDER = re.compile(r"<([^<>\n]+)>")


def settings() -> dict[str, str]:
    """Settings of the site. A setting that is not filled in is empty."""
    values = tomllib.loads(SETTINGS.read_text(encoding="utf-8"))
    return {n: "" if _PLACEHOLDER.fullmatch(str(v)) else str(v) for n, v in values.items()}


def with_address(text: str, address: str) -> str:
    """A page with the address of the public repository; unchanged if the address is empty."""
    if not address:
        return text
    return _NO_ADDRESS.sub("", text.replace(CLONED, f"git clone {address}"))


def to_fill_in() -> list[str]:
    """A line for each placeholder, with the file that contains it."""
    empty = [name for name, value in settings().items() if not value]
    left = [f"docs/site/settings.toml: {name} is to be filled in" for name in empty]
    for cited in ("CITATION.cff", "docs/comparison.md"):
        if "Hand Sandbox developers" in (ROOT / cited).read_text(encoding="utf-8"):
            left.append(f"{cited}: authors are to be filled in")
    for page in BEGINNINGS:
        if CLONED in (ROOT / page).read_text(encoding="utf-8"):
            left.append(f"{page}: ADDRESS is to be filled in (the site takes that of its settings)")
    return left
