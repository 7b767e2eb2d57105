"""Motion that others recorded: readers of BVH, ASF/AMC, marker tables and tables of poses."""
