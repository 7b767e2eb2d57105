"""The report on a study, made from its tables only.

data                    reads the tables
numbers                 computes person means, and statistics of these by SciPy
exclusions              lists excluded data, and describes the remaining data
page, plots, formats    make one HTML page
analysis.R              fits models in R; it reads the tables itself
make                    creates all files of the report
"""
