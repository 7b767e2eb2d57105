"""Copies of a study (anonymous, merged), and withdrawal of participants."""
