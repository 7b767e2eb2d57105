"""Serves a session to web pages: poses down, touches up, one socket each."""
