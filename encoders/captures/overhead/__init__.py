"""Labels touches with a camera over the touch surface. Each touch gets the finger whose pad is
nearest to it in the picture, or no label if two fingers are about equally near.

    picture_track         landmarks of one hand over time, and the offset of their clock
    tablet_plane          map from picture to surface, and the camera's place and field of view
    naming                probabilities of the fingers of all contacts from picture to picture, and
                          labels of the contacts of a recording
    capture_from_camera   conversion of touches and pictures to a capture
    simulated_camera      pictures of a simulated person, with the truth
"""
