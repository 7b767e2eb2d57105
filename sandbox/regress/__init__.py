"""Success over many seeds, serially or on many cores, and against what it was before."""
