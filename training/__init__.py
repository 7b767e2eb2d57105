"""Commands that make the shipped models. This package is only in the checkout, not in the wheel.

`python -m training` lists the commands, and README.md beside this file explains them. `models`,
`encoders`, `tasks` and `sandbox` do not import this package.
"""
