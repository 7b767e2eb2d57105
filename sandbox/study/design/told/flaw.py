"""Declaration of a flaw of a design."""

from __future__ import annotations

from dataclasses import dataclass

from sandbox.study.design.toml_lines import Path


@dataclass(frozen=True)
class Flaw:
    """Something that is right in form and misleads.

    Attributes:
        path: Place in the design file.
        what: What is wrong.
        remedy: What to do about it.
        error: True if the study cannot give results as it is.
    """

    path: Path
    what: str
    remedy: str
    error: bool = False
