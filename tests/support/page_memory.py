"""What the page remembers in a browser's storage, for tests that begin with it."""

from __future__ import annotations

from tasks.registry import TASKS

NO_HINTS = {f"hand-sandbox:hint-closed:{task}": "yes" for task in TASKS}
"""Of a player who has closed the hint of every task."""
