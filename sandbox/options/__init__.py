"""Options of the command line, and the settings and devices that are made from them.

Commands, studies and regression runs share these modules.
"""
