"""Evaluation of reconstruction methods: the paper's tables and further measures.

This package computes numbers. `sandbox evaluate` prints them, and `docs/evaluation.md` defines
them.
"""

from encoders.evaluation.measure_method import MethodResult, evaluate_method
from encoders.evaluation.methods import EncoderMethod, Method

__all__ = ["EncoderMethod", "Method", "MethodResult", "evaluate_method"]
