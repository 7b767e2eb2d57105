"""A webcam whose pictures a page in the browser turns into landmarks of hands."""
