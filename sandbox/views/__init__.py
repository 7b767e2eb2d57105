"""Views of a session, which only read it: films, windows and pictures."""
