"""Copies of a study (anonymous, Motion-BIDS, backup, merged), and withdrawal of participants."""
