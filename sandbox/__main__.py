"""`python -m sandbox` runs the command `sandbox`, for when the command is not on the path."""

from __future__ import annotations

import sys

from sandbox.cli.main import main

sys.exit(main())
