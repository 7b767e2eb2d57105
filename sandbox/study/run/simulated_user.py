"""The simulated user of a simulated participant."""

from __future__ import annotations

from dataclasses import fields

from sandbox.study.record.folder import Participant
from tasks.user import UserConfiguration


def simulated_user(person: Participant) -> UserConfiguration:
    """Configuration of the user who plays for a simulated participant.

    Args:
        person: A simulated participant; besides the configuration, `user` has the skill, and of an
            earlier version perhaps settings that are no more.
    """
    known = {each.name for each in fields(UserConfiguration)}
    values = {name: v for name, v in (person.user or {}).items() if name in known}
    return UserConfiguration(**{**values, "reaction": tuple(values["reaction"])})
