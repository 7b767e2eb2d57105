"""Fixtures of tests that run LeRobot."""

from __future__ import annotations

import pytest

from tests.system.lerobot.environment import lerobot_python


@pytest.fixture(scope="session")
def lerobot(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A Python that has LeRobot and this program."""
    return lerobot_python(tmp_path_factory.mktemp("lerobot") / "environment")
