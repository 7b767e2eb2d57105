"""Evaluations of encoders and of PAALM: their data, what is judged, and the tables of it."""
