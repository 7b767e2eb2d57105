"""Devices around other devices: merged, split, spoiled, with a lift control."""
