"""Ends a benchmark with bad input by an error of one line, like `sandbox`, without traceback."""

from __future__ import annotations

import sys
from collections.abc import Callable

from models.errors import InputError

BAD_INPUT = 2
"""Exit status after bad input, the same as that of `sandbox`."""


def run(main: Callable[[], None]) -> None:
    """Runs a benchmark. An `InputError` ends the program with one line on stderr."""
    try:
        main()
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(BAD_INPUT)
