"""The report on a study, made from its tables only.

data                    reads the tables
numbers                 person means, and what SciPy says of them
exclusions              what is left out, and what a reader must know of the rest
page, plots, formats    one HTML page
analysis.R              models in R, which read the tables, too
make                    creates all files of the report
"""
