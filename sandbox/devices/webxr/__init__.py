"""A headset whose page draws the table and sends the joints of hands."""
