"""The skin of the hand."""
