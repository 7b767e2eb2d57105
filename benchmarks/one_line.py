"""Bad input to a benchmark is one clear line, as it is for `sandbox`, and no traceback."""

from __future__ import annotations

import sys
from collections.abc import Callable

from models.errors import InputError

BAD_INPUT = 2
"""Exit status, as that of `sandbox`."""


def run(main: Callable[[], None]) -> None:
    """Runs a benchmark; a file or a value that cannot be used ends it with one line."""
    try:
        main()
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(BAD_INPUT)
