"""The report on a study, made from its tables only.

models/data                       reads the tables
models/intervals, comparisons     numbers with their uncertainty
models/mixed, censored, success   statistical models
models/order, answers             effects of order and learning; questionnaires
page, out_tables, script          output: an HTML page with plots, CSV files, an R script
make                              creates all files of the report
"""
