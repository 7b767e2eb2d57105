"""Models that earlier releases shipped, as they were."""
