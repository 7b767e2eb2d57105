"""Training of the names of fingers on a population."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from encoders.capture import Capture
from encoders.labels.belief import PopulationBelief, from_weights
from models.errors import EncoderError
from training.name_network import DEFAULT, LayoutPool, TrainingSettings, train_network
from training.population.surface_people import surface_person

SHARES = {"first": 1.0, "second": 1.0, "posed": 0.5, "surface": 1.0}
"""Share of every source of people in the draws. Posed people have postures that nobody shows."""

SURFACE_PEOPLE = 150
"""People whose layouts are drawn beside those of the population, as real people put them down."""


def train_names(
    people: Sequence[Capture],
    population: str,
    say: Callable[[float, float], None] = lambda share, loss: None,
    settings: TrainingSettings = DEFAULT,
) -> PopulationBelief:
    """Trains the belief over labels for any person.

    Args:
        people: People to train on; `meta` names the source of each.
        population: Digest of the population they are from.
        say: Called with the share done and the mean loss of the last 100 steps.
        settings: Sizes and schedule.

    Raises:
        EncoderError: Nobody is there to train on.
    """
    if not people:
        raise EncoderError(
            "no person of the population is in the group to train on",
            remedy="`python -m training people --out FILE` makes one with people to train on",
        )
    drawn = [surface_person([settings.seed, i]) for i in range(SURFACE_PEOPLE)]
    sources = [str(person.meta["source"]) for person in people] + ["surface"] * len(drawn)
    shares = [SHARES[source] / sources.count(source) for source in sources]
    pool = LayoutPool([*people, *drawn], shares)
    steps = settings.steps
    weights = train_network(pool, settings, lambda step, loss: say(step / steps, loss))
    return from_weights(weights, population)
