"""Trials: settings, how a session is put together, run, paced, recorded and replayed."""
