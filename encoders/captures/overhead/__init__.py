"""A camera over a touch surface labels touches. Each touch gets the finger whose tip is nearest to
it in the picture, or no label where two fingers are about as near.

    picture_track         landmarks of one hand over time
    tablet_plane          map from picture to surface, from the surface's corners or from touches
    lifts                 common clock of touches and pictures, from taps
    names                 belief over the fingers of all contacts, from picture to picture
    live_names            the same while a person touches
    camera_place          camera's place and field of view, from the surface in its picture
    capture_from_camera   conversion of touches and pictures to a capture
    simulated             pictures of a simulated person, with the truth
"""
