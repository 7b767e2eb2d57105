"""Export of hand motion from recordings, captures and sessions to files of other programs."""
