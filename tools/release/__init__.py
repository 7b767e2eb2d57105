"""What a release promises: its recordings, and the models that they name, kept."""
