"""Training of the labeller of fingers on a population."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from encoders.capture import Capture
from encoders.labels.belief import PopulationBelief, from_weights
from models.errors import EncoderError
from training.name_network import DEFAULT, LayoutPool, TrainingSettings, train_network
from training.population.surface_people import surface_person

SHARES = {"first": 1.0, "second": 1.0, "posed": 0.5, "surface": 1.0}
"""Weight of every source of people in the draws. Posed people have a small weight, since real
people do not show many of their postures."""

SURFACE_PEOPLE = 150
"""Number of additional people, whose layouts are like those of real people (`surface_people`)."""


def train_names(
    people: Sequence[Capture],
    population: str,
    say: Callable[[float, float], None] = lambda share, loss: None,
    settings: TrainingSettings = DEFAULT,
) -> PopulationBelief:
    """Trains the belief over labels for any person.

    Args:
        people: People to train on; `meta` names the source of each.
        population: Digest of the population that contains these people.
        say: Called with the share done and the mean loss of the last 100 steps.
        settings: Sizes and schedule.

    Raises:
        EncoderError: `people` is empty.
    """
    if not people:
        raise EncoderError(
            "no person of the population is in the group to train on",
            remedy="`python -m training people --out FILE` makes a population with such people",
        )
    drawn = [surface_person([settings.seed, i]) for i in range(SURFACE_PEOPLE)]
    sources = [str(person.meta["source"]) for person in people] + ["surface"] * len(drawn)
    shares = [SHARES[source] / sources.count(source) for source in sources]
    pool = LayoutPool([*people, *drawn], shares)
    steps = settings.steps
    weights = train_network(pool, settings, lambda step, loss: say(step / steps, loss))
    return from_weights(weights, population)
