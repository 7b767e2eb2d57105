"""The report on a study: what was found, from its tables alone; nothing in here takes part in one.

data      the tables, and what follows from their columns
intervals, comparisons        numbers with their uncertainty
mixed, censored, success      the models
order, answers                checks of order and learning; questionnaires
plots, page, script, make     what comes out: pictures, one HTML, an R script, CSVs
planted   studies whose truth is known, to check all of the above
"""
