"""A snapshot shows its own moment, and computes what somebody looks at."""

import numpy as np

from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings


def test_a_snapshot_shows_its_own_moment_whenever_it_is_looked_at() -> None:
    chosen = trial_settings(TrialOptions(seed=1))
    session = build(chosen, device_makers(chosen))
    show = session.rigs[0].device.show
    while not session.solid(0):
        show(session.advance())
    looked_at, later = session.snapshot(), session.snapshot()
    hand, box = looked_at.hands[0], looked_at.objects["box"]
    for _ in range(60):
        show(session.advance())
    assert not np.array_equal(session.snapshot().objects["box"].position, box.position)
    np.testing.assert_array_equal(later.hands[0].tips, hand.tips)
    np.testing.assert_array_equal(later.hands[0].target, hand.target)
    assert (later.hands[0].solid, later.hands[0].phase) == (hand.solid, hand.phase)
    assert hand.contacts and len(later.hands[0].contacts) == len(hand.contacts)
    for a, b in zip(later.hands[0].contacts, hand.contacts, strict=True):
        assert (a.id, a.label, a.state) == (b.id, b.label, b.state)
    np.testing.assert_array_equal(later.hands[0].places, hand.places)
    np.testing.assert_array_equal(later.objects["box"].position, box.position)
    np.testing.assert_array_equal(later.objects["box"].rotation, box.rotation)
    assert later.goals == looked_at.goals
    assert later.hands is later.hands and later.goals is later.goals
