"""Stored data of a study: folders, journals, recordings and pseudonyms of participants."""
