"""The window of a session."""
