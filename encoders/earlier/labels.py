"""Names of fingers as an earlier release shipped them, for its recordings."""

from __future__ import annotations

from functools import cache

from encoders.kept import HISTORY, POPULATION, checked, kept_folder, kept_model
from encoders.labels.belief import BeliefLabels, BeliefModel
from encoders.labels.own_layouts import OwnLayouts
from encoders.labels.population_belief import load_population_belief
from encoders.labels.trained_belief import load_belief


def kept_labels(digest: str, known: OwnLayouts | None = None) -> BeliefLabels:
    """The belief over labels of a digest, without contacts.

    Args:
        digest: Digest of kept names.
        known: The person's own layouts of five fingers; used by names of the population.

    Raises:
        EncoderError: None is kept, or it is damaged.
    """
    learns = kept_model(digest, HISTORY, POPULATION).kind == POPULATION
    return BeliefLabels(kept_names(digest), known if learns else None, learns=learns)


@cache
def kept_names(digest: str) -> BeliefModel:
    """The trained model of a digest, as it was.

    Raises:
        EncoderError: None is kept, or it is damaged.
    """
    kept = kept_model(digest, HISTORY, POPULATION)
    path = kept_folder() / kept.file
    model: BeliefModel = (
        load_population_belief(path) if kept.kind == POPULATION else load_belief(path)
    )
    checked(model.digest, kept)
    return model
