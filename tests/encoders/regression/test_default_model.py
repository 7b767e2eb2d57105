"""Whoever names no encoder gets the same one everywhere."""

import inspect

from encoders.regression.model_registry import DEFAULT_MODEL, MODELS
from sandbox.cli.regress import RegressOptions
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions


def test_all_defaults_are_the_one_default() -> None:
    assert DEFAULT_MODEL in MODELS
    assert {TrialOptions().encoder, Settings().pipeline.encoder} == {DEFAULT_MODEL}
    assert inspect.signature(RegressOptions).parameters["encoder"].default == DEFAULT_MODEL
