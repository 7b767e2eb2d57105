"""Readers and writers of hand motion in files: BVH, ASF/AMC, C3D, glTF, Vicon, and tables of
markers and poses."""
