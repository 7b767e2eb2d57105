"""Encoders: from a contact vector to a pose."""
