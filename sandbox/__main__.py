"""`python -m sandbox` is `sandbox`, where the command is not on the path."""

from __future__ import annotations

import sys

from sandbox.cli.main import main

sys.exit(main())
