"""Texts of a design that people read, and how a flaw of them is told."""
