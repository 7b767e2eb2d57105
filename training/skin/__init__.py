"""Generates the shipped skin; needs the extra `training`."""
