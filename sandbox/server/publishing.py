"""Publishes a session's steps to its page."""

from __future__ import annotations

from sandbox.server.page_server import PageServer
from sandbox.server.protocol.contact_forces import hand_feedback
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


def publish(server: PageServer, session: Session, snapshot: Snapshot) -> None:
    """Publishes the newest snapshot from the session's thread.

    Contact forces are only computed if a page is connected.
    """
    server.publish(snapshot, feedback=hand_feedback(session) if server.clients else ())
