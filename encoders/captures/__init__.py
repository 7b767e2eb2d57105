"""Captures, made by simulated subjects or from recordings of real hands."""
