"""Server of a session's web pages: sends poses to them and receives their touches."""
