"""Connections to the server: access rules, limits, and the state of each connection."""
