"""What a session's page sees of it, step by step."""

from __future__ import annotations

from sandbox.server.page_server import PageServer
from sandbox.server.protocol.senses import senses
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


def publish(server: PageServer, session: Session, snapshot: Snapshot) -> None:
    """The newest moment, from the session's own thread; forces only where somebody looks."""
    server.publish(snapshot, senses=senses(session) if server.clients else ())
