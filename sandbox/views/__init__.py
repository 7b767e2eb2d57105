"""Views look at a session and change nothing."""
