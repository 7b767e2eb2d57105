"""Simulated users: they play tasks by touch, and see only what a person would see."""
