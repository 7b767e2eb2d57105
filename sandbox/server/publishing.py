"""Publishes a session's steps to its page."""

from __future__ import annotations

from sandbox.server.page_server import PageServer
from sandbox.server.protocol.contact_forces import senses
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


def publish(server: PageServer, session: Session, snapshot: Snapshot) -> None:
    """Publishes the newest moment, from the session's thread; with forces only if a page is
    connected."""
    server.publish(snapshot, senses=senses(session) if server.clients else ())
