"""Generates the shipped skin; needs the extra `skin`."""
