"""Captures: made by simulated subjects, or out of recordings of real hands."""
