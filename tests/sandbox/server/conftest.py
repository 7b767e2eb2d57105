"""A server of pages, and a stage on it, for every test of the server."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sandbox.server.page_server import PageServer
from tests.sandbox.server.test_page_server import Stage, opened


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.close()


@pytest.fixture
def stage(server: PageServer) -> Stage:
    return opened(server)
