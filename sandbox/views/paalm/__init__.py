"""Pictures of the PAALM method and their window."""
