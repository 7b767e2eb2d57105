"""What can be asked for, and the settings and devices it makes.

Commands, studies and regression runs share it.
"""
