"""Reconstructors turn successive frames of touches or hands into poses of the whole hand."""
