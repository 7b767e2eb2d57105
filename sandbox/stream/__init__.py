"""Streams moving hands live to Maya, Blender or other programs that read lines."""
