"""Texts of the page, one file per language."""
