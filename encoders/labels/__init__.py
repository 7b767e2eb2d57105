"""Labellers decide which finger makes each contact."""
