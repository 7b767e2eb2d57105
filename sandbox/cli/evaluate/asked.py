"""The request to `sandbox evaluate`, read before anything heavy is imported."""

from __future__ import annotations

STRANGERS = ("--hold-out", "--people")
"""Options that are about strangers alone."""


def is_about_strangers(argv: list[str]) -> bool:
    """True if options are about people on whom nothing was trained."""
    pairs = zip(argv, [*argv[1:], ""], strict=True)
    return any(
        option.partition("=")[0] in STRANGERS
        or option == "--train=population"
        or (option, value) == ("--train", "population")
        for option, value in pairs
    )
