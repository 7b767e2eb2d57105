"""Robot hands in place of the built-in hand: their models, mappings, and retargeting."""
