"""Simulated users. They play tasks by touch, and see only what a person would see."""
