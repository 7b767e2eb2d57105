"""How the shipped models are made, by command; in the checkout only, not in the wheel.

`python -m training` lists the commands, and README.md beside this file explains them. `models`,
`encoders`, `tasks` and `sandbox` do not import this package.
"""
