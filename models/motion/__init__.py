"""Hand motion in files: readers and writers of BVH, ASF/AMC, C3D, glTF, Vicon, marker and pose
tables."""
