"""The report on a study, made from its tables only.

data                    reads the tables
numbers                 person means, and their statistics by SciPy
exclusions              excluded data, and notes on the remaining data
page, plots, formats    one HTML page
analysis.R              models in R, which read the tables, too
make                    creates all files of the report
"""
