"""Fits encoders, which map contact vectors to poses, and reads fitted encoders."""
