"""Sentences for people that can be said in other languages."""
