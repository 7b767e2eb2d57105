"""Evaluations of encoders and of PAALM: their data, their computation, and their tables."""
