"""Verification of a study's folder: journals, recordings, derived tables and the lock."""
