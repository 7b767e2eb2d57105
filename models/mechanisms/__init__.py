"""Mechanisms: bodies that are joined by hinges and slides, described in MJCF."""
