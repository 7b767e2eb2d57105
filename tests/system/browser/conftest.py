"""What tests in a real browser share: the browser of a file, and a server of pages."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sandbox.server.page_server import PageServer
from tests.sandbox.server.staged_page import TASKS
from tests.support.chromium import Browser


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer(tasks=TASKS)
    yield server
    server.close()
