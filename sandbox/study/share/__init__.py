"""Copies of a study: anonymous, as Motion-BIDS, backed up, merged; and withdrawal."""
