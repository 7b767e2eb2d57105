"""The session: the one loop, and what it tells and asks."""
