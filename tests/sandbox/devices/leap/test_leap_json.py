"""Leap messages of every dialect become the same hand frames, and wrong ones are counted."""

from __future__ import annotations

import copy
import json
import math
from dataclasses import asdict, replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import FrameError
from models.frames import HandFrame
from sandbox.devices.leap.leap_json import LeapDecoder
from sandbox.devices.leap.leap_write import leap_message
from tests.support.leap_hands import take


def message(time_us: int = 1_000_000, **changes: Any) -> dict[str, Any]:
    """A v1 message with one hand and two fingers."""
    finger = {
        "id": 4,
        "handId": 2,
        "direction": [0.0, 0.0, -1.0],
        "length": 50.0,
        "tipPosition": [10.0, 200.0, -60.0],
        "tool": False,
    }
    hand = {
        "id": 2,
        "palmPosition": [0.0, 190.0, 20.0],
        "palmNormal": [0.0, -1.0, 0.0],
        "direction": [0.0, 0.0, -1.0],
        "sphereRadius": 90.0,
    }
    return {
        "id": 1,
        "timestamp": time_us,
        "hands": [hand],
        "pointables": [finger, finger | {"id": 5, "tipPosition": [30.0, 200.0, -55.0]}],
    } | changes


def spoiled(part: str, **changes: Any) -> dict[str, Any]:
    """A message whose first hand or finger is different."""
    whole = copy.deepcopy(message())
    whole[part][0] |= changes
    return whole


def test_up_from_the_device_is_up_and_towards_the_person_is_backwards() -> None:
    frame = LeapDecoder().feed(message())
    assert frame is not None
    (hand,) = frame.hands
    assert hand.palm == pytest.approx((0.0, -0.020, 0.190))
    assert hand.normal == pytest.approx((0.0, 0.0, -1.0))
    assert hand.direction == pytest.approx((0.0, 1.0, 0.0))
    assert hand.fingers[0].tip == pytest.approx((0.010, 0.060, 0.200))
    assert hand.fingers[0].length == pytest.approx(0.050)
    assert (frame.time, hand.sphere_radius, hand.side) == (1.0, pytest.approx(0.090), None)


@pytest.mark.parametrize("dialect", ("v1", "v3"))
def test_what_a_service_would_send_of_a_frame_is_read_back_as_that_frame(dialect: str) -> None:
    decoder = LeapDecoder()
    for number, frame in enumerate(take(3, dialect).frames[:40]):
        read = decoder.feed(json.loads(json.dumps(leap_message(frame, number))))
        assert read is not None and read.dialect == frame.dialect == dialect
        assert close(asdict(read), asdict(replace(frame, source=read.source)))


def close(a: Any, b: Any) -> bool:
    """True if two values are equal, numbers within 1e-6."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(close(a[key], b[key]) for key in a)
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(map(close, a, b))
    return a == pytest.approx(b, abs=1e-6) if isinstance(a, float) else a == b


@pytest.mark.parametrize(
    ("more", "dialect"),
    (
        ((), "v2"),
        (("bases",), "bridge"),
        (("bases", "stabilizedTipPosition", "touchDistance"), "v3"),
        (("bases", "stabilizedTipPosition"), "v2"),
    ),
)
def test_the_fields_of_a_finger_tell_who_is_speaking(more: tuple[str, ...], dialect: str) -> None:
    sent = leap_message(replace(take(0, "v3").frames[0], dialect=None), 1)
    for pointable in sent["pointables"]:
        pointable |= dict.fromkeys(more, 0)
    decoder = LeapDecoder()
    assert decoder.feed(sent) is not None
    assert decoder.dialect == dialect


def test_the_last_bone_ends_where_the_device_says_and_at_the_tip_where_it_says_nothing() -> None:
    frame = take(0, "v3").frames[0]
    sent = leap_message(frame, 1)
    apart = [
        math.dist(p["btipPosition"], p["tipPosition"])
        / math.dist(p["btipPosition"], p["dipPosition"])
        for p in sent["pointables"]
        if p["type"] != 0
    ]
    # As in the real recording pinch-57fps.
    assert apart == pytest.approx([0.23] * 4)
    read = LeapDecoder().feed(sent)
    assert read is not None
    for known, found in zip(frame.hands[0].fingers, read.hands[0].fingers, strict=True):
        assert found.end == pytest.approx(known.end) and found.tip == pytest.approx(known.tip)
        assert found.end != found.tip
    for pointable in sent["pointables"]:
        del pointable["btipPosition"]
    old = LeapDecoder().feed(sent)
    assert old is not None and all(f.end == f.tip for f in old.hands[0].fingers)


@pytest.mark.parametrize(
    "changes",
    (
        *({"tipPosition": [math.nan, 0.0, 0.0]}, {"tipPosition": None}, {"direction": [0.0] * 3}),
        *({"direction": [0.0, 1.0]}, {"length": 0.0}, {"length": "long"}, {"id": True}),
        {"tipPosition": [1e9, 0.0, 0.0]},
    ),
)
def test_a_damaged_finger_is_counted_and_its_neighbour_kept(changes: dict[str, Any]) -> None:
    decoder = LeapDecoder()
    frame = decoder.feed(spoiled("pointables", **changes))
    assert frame is not None and [f.id for f in frame.hands[0].fingers] == [5]
    assert sum(n for why, n in decoder.counts.items() if why.startswith("fingers skipped")) == 1


@pytest.mark.parametrize(
    "damaged",
    (
        spoiled("hands", palmPosition=[0.0, math.inf, 0.0]),
        spoiled("hands", palmNormal=[0.0, 0.0, 0.0]),
        spoiled("hands", direction=[0.0, -1.0, 0.0]),
        message(pointables=5),
        spoiled("pointables", id=5),
        message(hands=[3]),
        message(timestamp="now"),
        message(timestamp=math.nan),
        {k: v for k, v in message().items() if k != "hands"} | {"hands": [{}]},
    ),
)
def test_a_damaged_frame_is_counted_and_the_next_one_is_as_good_as_ever(
    damaged: dict[str, Any],
) -> None:
    decoder = LeapDecoder()
    assert decoder.feed(damaged) is None
    assert sum(n for why, n in decoder.counts.items() if why.startswith("frames refused")) == 1
    assert decoder.feed(message()) == LeapDecoder().feed(message())


def test_a_late_frame_is_left_out_and_a_new_clock_goes_on_from_the_old_one() -> None:
    decoder = LeapDecoder()
    times = [decoder.feed(message(t)) for t in (50_000_000, 50_010_000, 50_005_000, 50_010_000)]
    assert [f is not None for f in times] == [True, True, False, False]
    assert decoder.counts["frames whose time ran backwards"] == 2
    # The first frame of a restart may be a single wrong time.
    doubtful, *restarted = [decoder.feed(message(t)) for t in (1_000, 11_000, 21_000)]
    assert doubtful is None and restarted[0] is not None and restarted[1] is not None
    assert restarted[0].time > 50.01
    assert restarted[1].time - restarted[0].time == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("sent", "read"),
    [
        *(
            ((50.0, 50.01, wrong, 50.03, 50.04), (50.0, 50.01, None, 50.03, 50.04))
            for wrong in (0.0, 53.0, 1e9)
        ),
        # After a pause, the second frame is believed.
        ((0.0, 0.01, 9.0, 9.01, 9.02), (0.0, 0.01, None, 9.01, 9.02)),
    ],
)
def test_a_single_wrong_time_is_left_out_and_what_follows_has_its_time(
    sent: tuple[float, ...], read: tuple[float | None, ...]
) -> None:
    decoder = LeapDecoder()
    frames = [decoder.feed(message(round(1e6 * time))) for time in sent]
    assert [frame and frame.time for frame in frames] == pytest.approx(read)
    assert decoder.counts["frames whose time leapt"] == 1
    assert "restarts of the device's clock" not in decoder.counts


@pytest.mark.parametrize("wrong", [0, 3_600_000_000, 10**15])
def test_a_first_time_that_is_wrong_stretches_no_recording(wrong: int) -> None:
    decoder = LeapDecoder()
    times = (wrong, 50_010_000, 50_020_000, 50_030_000)
    first, _, *others = [decoder.feed(message(t)) for t in times]
    assert first is not None
    assert [f and f.time - first.time for f in others] == pytest.approx([0.01, 0.02], abs=1e-6)


def test_handshakes_events_and_foreign_messages_are_no_frames() -> None:
    decoder = LeapDecoder()
    said: Any = (
        {"version": 6, "serviceVersion": "2.3.1"},
        {"event": {}},
        {"weather": "fine"},
        [1],
        7,
    )
    assert [decoder.feed(m) for m in said] == [None] * 5
    assert decoder.version == "2.3.1"
    assert decoder.counts["messages of another program"] == 1
    assert decoder.counts["messages that are not JSON objects"] == 2


def test_tools_and_fingers_without_a_hand_are_counted_and_left_out() -> None:
    decoder = LeapDecoder()
    frame = decoder.feed(spoiled("pointables", tool=True))
    assert frame is not None and len(frame.hands[0].fingers) == 1
    frame = LeapDecoder().feed(spoiled("pointables", handId=-1))
    assert frame is not None and len(frame.hands[0].fingers) == 1
    assert decoder.counts["tools"] == 1


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.just("id"), inner),
    max_leaves=4,
)


@settings(max_examples=60)
@given(data=st.data())
def test_nothing_that_json_can_say_stops_the_decoder(data: st.DataObject) -> None:
    sent = leap_message(take(0, data.draw(st.sampled_from(("v1", "v3")))).frames[0], 1)
    for _ in range(data.draw(st.integers(1, 3))):
        target: Any = data.draw(
            st.sampled_from([sent, *sent["hands"], *sent["pointables"]])
            if isinstance(sent.get("hands"), list) and isinstance(sent.get("pointables"), list)
            else st.just(sent)
        )
        if isinstance(target, dict) and target:
            target[data.draw(st.sampled_from(sorted(target)))] = data.draw(JSON)
    decoder = LeapDecoder()
    frame = decoder.feed(sent)
    assert frame is None or isinstance(frame, HandFrame)
    assert decoder.feed(message(10**15)) is not None or decoder.counts


def test_hand_frames_refuse_what_no_hand_can_be() -> None:
    frame = take(0).frames[0]
    (hand,) = frame.hands
    finger = hand.fingers[0]
    wrong: tuple[tuple[Any, dict[str, Any]], ...] = (
        *((finger, {"tip": (math.nan, 0.0, 0.0)}), (finger, {"direction": (0.0, 2.0, 0.0)})),
        *((finger, {"length": -0.05}), (finger, {"finger": 5}), (hand, {"direction": hand.normal})),
        *((hand, {"fingers": (finger, finger)}), (hand, {"side": "upper"})),
        *((frame, {"time": math.inf}), (frame, {"hands": (hand, hand)})),
    )
    for part, values in wrong:
        with pytest.raises(FrameError):
            replace(part, **values)
