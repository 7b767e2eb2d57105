"""Hands in motion, live, into Maya, Blender or whatever else reads lines."""
