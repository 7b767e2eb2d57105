"""Generator of the shipped skin. It needs the extra `training`."""
