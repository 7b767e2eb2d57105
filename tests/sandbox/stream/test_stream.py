"""Streaming: what is sent, to ports that behave badly, from recordings and from devices."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.errors import InputError
from models.motion.armature import Y_UP, Armature, Keys
from models.motion.bvh import read_bvh
from models.motion.sampling import Poses
from models.rotations import quaternion_to_matrix
from models.skeleton import ADULT
from sandbox.cli.main import main
from sandbox.cli.stream import script
from sandbox.export.motion_source import MotionSource, poses_of
from sandbox.stream.guest import (
    Line,
    Quaternion,
    Vector,
    angles_of,
    between,
    inverse,
    palm_frame,
    product,
    quaternion_of,
    rotated,
    rows_of,
)
from sandbox.stream.hand_sources import StreamPace, StreamPlayer
from sandbox.stream.lines import BLENDER, LIMIT, MAYA, MAYA_MEL, HandLines, StreamTarget
from sandbox.stream.sender import Sender, parse_address
from tests.sandbox.export.test_export_leap import alone, write
from tests.sandbox.stream.command_port import CommandPort, Manners
from tests.sandbox.stream.fake_maya import FakeMaya, maya_with
from tests.sandbox.stream.fake_maya_joints import turned
from tests.support.motion_poses import HANDS, legal, moving

PATIENT = 20.0


def one(keys: Keys, i: int) -> Keys:
    return Keys(keys.root[i : i + 1], keys.turns[i : i + 1])


def inside(command: str) -> str:
    """The line in a command."""
    return command.split("'")[1] if "'" in command else command


@pytest.mark.parametrize("hand", HANDS)
@settings(max_examples=15)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_line_says_where_fingers_reach_and_how_joints_are_turned(hand: str, seed: int) -> None:
    armature = Armature(HANDS[hand])
    keys = armature.keys(legal(HANDS[hand], 1, seed))
    (command,) = HandLines(armature, "right", BLENDER).lines(1.25, keys)
    line = Line(command)
    joints, tips = armature.place(keys)
    assert line.time == 1.25 and np.allclose(line.place, keys.root[0], atol=6e-7)
    for j in range(1, 15):
        assert np.allclose(quaternion_to_matrix(line.turns[j]), keys.turns[0, j], atol=1e-6)
    for k, first in enumerate(HANDS[hand].first_bone + 1):
        way, _, size = line.chains[k]
        reach = np.array(rotated(line.turn, way)) * size
        assert np.allclose(reach, tips[0, k] - joints[0, first], atol=2e-5)
        assert np.linalg.norm(way) < 1.0


@pytest.mark.parametrize("target", [MAYA, MAYA_MEL, BLENDER])
@given(limit=st.integers(330, LIMIT))
@settings(max_examples=25)
def test_a_moment_too_long_for_one_command_is_split_and_nothing_is_lost(
    target: StreamTarget, limit: int
) -> None:
    armature = Armature(ADULT)
    keys = armature.keys(legal(ADULT, 1, 5))
    whole = Line(inside(HandLines(armature, "right", target, run="r").lines(0.0, keys)[0]))
    commands = HandLines(armature, "right", target, limit, run="r").lines(0.0, keys)
    assert all(len(c.encode()) + 1 < limit for c in commands)
    lines = [Line(inside(c)) for c in commands]
    assert all((x.place, x.turn, x.time) == (whole.place, whole.turn, 0.0) for x in lines)
    assert {k: v for x in lines for k, v in x.chains.items()} == whole.chains
    assert {k: v for x in lines for k, v in x.turns.items()} == whole.turns


unit_vectors = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: 0.1 < np.linalg.norm(q) < 2)


@given(unit_vectors, st.tuples(*[st.floats(-1000, 1000)] * 3))
@example((0.0, 0.7071, 0.0, 0.7071), (0.0, 0.0, 0.0))
@example((1.0, 0.0, 1.0, 0.0), (30.0, 0.0, 200.0))
@example((1.0, 0.0, -1.0, 0.0), (30.0, 0.0, 200.0))
@example((1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
def test_turns_survive_matrices_and_angles_however_many_times_round(
    q: Quaternion, before: Vector
) -> None:
    w, x, y, z = (np.array(q) / np.linalg.norm(q)).tolist()
    q = (w, x, y, z)
    again = product(quaternion_of(rows_of(q)), inverse(q))
    assert abs(abs(again[0]) - 1) < 1e-9
    angles = angles_of(q, before)
    assert np.allclose(turned(angles), rows_of(q), atol=1e-6)
    # The nearest of all triples that are the same turn.
    x, y, z = angles
    for same in (angles, (x + 180.0, 180.0 - y, z + 180.0)):
        assert np.allclose(turned(same), rows_of(q), atol=1e-6)
        off = np.subtract(same, before)
        least = np.abs(off - 360.0 * np.round(off / 360.0)).sum()
        assert np.abs(np.subtract(angles, before)).sum() <= least + 1e-6


@given(
    st.tuples(*[st.floats(-400, 400)] * 2),
    st.just(0.0) | st.floats(-17, -2).map(lambda power: 10**power),
    st.sampled_from((1, -1)),
    st.tuples(*[st.floats(-1000, 1000)] * 3),
)
@example((20.0, 50.0), 1e-7, 1, (30.0, 0.0, 200.0))
def test_angles_give_back_the_turn_at_and_near_the_pole(
    outer: tuple[float, float], off: float, sign: int, before: Vector
) -> None:
    x, z = outer
    half = np.deg2rad([x, sign * 90.0, z]) / 2 - [0.0, off / 2, 0.0]
    (sx, sy, sz), (cx, cy, cz) = np.sin(half), np.cos(half)
    q = product((cz, 0.0, 0.0, sz), product((cy, 0.0, sy, 0.0), (cx, sx, 0.0, 0.0)))
    assert np.allclose(turned(angles_of(q, before)), rows_of(q), atol=4e-7)


@given(unit_vectors, unit_vectors)
def test_the_turn_between_two_directions_brings_one_to_the_other(
    a: Quaternion, b: Quaternion
) -> None:
    one, two = np.array(a[:3]) + 1e-3, np.array(b[:3]) - 1e-3
    for other in (two, -one, one):
        turn = between(one.tolist(), other.tolist())
        found = np.array(rotated(turn, one.tolist())) / np.linalg.norm(one)
        assert np.allclose(found, other / np.linalg.norm(other), atol=2e-3)


@given(unit_vectors, st.tuples(*[st.floats(-1, 1)] * 3))
def test_the_palm_of_a_left_rig_is_that_of_the_right_one_in_the_mirror(
    q: Quaternion, at: Vector
) -> None:
    skeleton = ADULT
    joints, tips = Armature(skeleton).place(Armature(skeleton).keys(moving(skeleton, 1, 5)))
    turn = np.array(rows_of(tuple((np.array(q) / np.linalg.norm(q)).tolist())))
    mirror = np.diag([-1.0, 1.0, 1.0])
    names = Armature(skeleton).names
    rows = [[names.index(b.name) for b in skeleton.bones if b.finger == f] for f in range(5)]
    right = [[*joints[0, row], tips[0, f]] for f, row in enumerate(rows)]
    right = [[turn @ place + at for place in chain] for chain in right]
    left = [[mirror @ place for place in chain] for chain in right]
    up = (0.0, 0.0, 1.0)
    one = np.array(palm_frame(right, range(5), "right", up))
    other = np.array(palm_frame(left, range(5), "left", up))
    assert np.allclose(one.T @ one, np.eye(3), atol=1e-9) and np.linalg.det(one) > 0
    assert np.allclose(other, mirror @ one @ mirror, atol=1e-9)


BAD = {
    "answers": Manners(),
    "says nothing": Manners(answer=None),
    "answers without an end": Manners(answer=b"x"),
    "answers a lot": Manners(answer=b"y" * 5000),
    "dies of every answer": Manners(dies=True),
    "dies without an answer": Manners(answer=None, dies=True),
    "closes now and then": Manners(drops_after=7),
    "reads a few bytes at a time": Manners(piece=5),
    "is slow, so that commands merge": Manners(answer=None, delay=0.05),
}


@pytest.mark.parametrize("how", BAD)
def test_the_last_moment_and_the_order_to_stop_reach_a_port_that(how: str) -> None:
    heard: list[str] = []
    port = CommandPort(heard.append, BAD[how])
    sender = Sender("127.0.0.1", port.port, ["greeting"])
    try:
        for i in range(40):
            sender.show("right", lambda i=i: [f"right {i}"])  # type: ignore[misc]
            sender.show("left", lambda i=i: [f"left {i}", f"left {i} too"])  # type: ignore[misc]
            time.sleep(0.002)
        sender.order("stop")
        assert sender.flush(PATIENT), sender.trouble
        deadline = time.monotonic() + PATIENT
        while "stop" not in heard and time.monotonic() < deadline:
            time.sleep(0.01)
    finally:
        sender.close()
        port.close()
    lossless = "without an answer" not in how and "now and then" not in how
    assert heard[0] == "greeting" and heard[-1] == "stop"
    for hand in ("right", "left"):
        told = [int(text.split()[1]) for text in heard if text.startswith(hand)]
        assert told == sorted(told) and told
        assert told[-1] == 39 or not lossless
    assert port.counts["too long"] == 0
    counts = sender.counts
    assert counts["moments sent"] + counts.get("moments dropped", 0) >= 80


def test_a_program_that_is_started_late_and_again_is_found_and_greeted_each_time() -> None:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        number = probe.getsockname()[1]
    sender = Sender("127.0.0.1", number, ["hello"])
    heard: list[str] = []
    try:
        for turn in range(2):
            sender.show("right", lambda turn=turn: [f"moment {turn}"])  # type: ignore[misc]
            sender.show("right", lambda turn=turn: [f"newer {turn}"])  # type: ignore[misc]
            port = CommandPort(heard.append, Manners(), number)
            assert sender.flush(PATIENT)
            port.close()
    finally:
        sender.close()
    again = heard.index("hello", 1)
    for turn, some in enumerate((heard[:again], heard[again:])):
        assert some[0] == "hello" and some[-1] == f"newer {turn}"
        assert set(some[1:-1]) <= {f"moment {turn}", f"newer {turn}"}


def test_whoever_hands_over_moments_never_waits_for_a_port_that_takes_nothing_in() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        sender = Sender("127.0.0.1", server.getsockname()[1])
        made = []
        for i in range(2000):
            sender.show("right", lambda i=i: [made.append(i) or "x" * 4000])  # type: ignore[misc]
        sender.close()
    assert sender.counts["moments dropped"] > 1000
    assert len(made) < 1000  # what was dropped was never written


def test_a_wait_for_a_program_that_does_not_listen_is_ended_by_a_stop() -> None:
    """Ctrl-C waited ten seconds for a key of a recording that nobody took."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        nobody = probe.getsockname()[1]
    sender, stop = Sender("127.0.0.1", nobody), threading.Event()
    try:
        assert sender.show("right", lambda: ["first"], PATIENT, stop)
        threading.Timer(0.2, stop.set).start()
        assert not sender.show("right", lambda: ["second"], 3600.0, stop)
    finally:
        sender.close()


@pytest.mark.parametrize(
    "text", ["", "host", "7002:x", ":0", ":70000", "a:-1", "a:1.5", "a:٣", "a..b:7004"]
)
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="not an address"):
        parse_address(text)


@pytest.mark.parametrize("how", ["answers", "dies of every answer", "reads a few bytes at a time"])
def test_keys_of_a_recorded_hand_all_reach_a_scene_over_a_port_that(
    how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # On a busy machine this scene takes its time to answer, and to hang up.
    monkeypatch.setattr("sandbox.stream.sender.FIRST_PATIENCE", PATIENT)
    monkeypatch.setattr("sandbox.stream.sender.LINGER", 1.0)
    q = moving(ADULT, 30, 7)
    scene = FakeMaya()

    def play(take: Callable[[Poses], None]) -> str:
        take(poses_of(np.arange(30) / 60.0, q))
        return ""

    source = MotionSource((Armature(ADULT),), ("right",), 0.5, "a hand", play)
    player = StreamPlayer(source, MAYA, StreamPace(60.0, 50.0, PATIENT))
    with maya_with(script("maya"), scene) as (names, run):
        names["start"](key=True)
        port = CommandPort(run, BAD[how])
        sender = Sender("127.0.0.1", port.port, player.greeting)
        try:
            assert player.play(sender, threading.Event()) == ""
            assert sender.flush(PATIENT)
            deadline = time.monotonic() + PATIENT
            # Greeting, thirty keys and the stop; what is said twice is counted twice.
            while port.counts["commands"] < 32 or names["hands"]:
                assert time.monotonic() < deadline, port.counts
                time.sleep(0.01)
        finally:
            sender.close()
            port.close()
    assert not port.errors and not scene.warnings and not names["hands"]
    curves = [n.curves["rotateX"] for n in scene.nodes if n.curves]
    assert len(curves) == 15 and all(sorted(c) == list(range(1, 31)) for c in curves)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stream") / "run.jsonl"
    assert (
        main(["run", "box-to-goal", "--device", "simulated", "--seed", "3", "--record", str(path)])
        == 0
    )
    return path


def moments(out: str) -> list[Line]:
    lines = [Line(inside(text)) for text in out.splitlines()]
    assert lines[0].kind == "rig" and lines[-1].kind == "stop"
    return lines[1:-1]


@pytest.mark.parametrize("device", ["simulated", "leap"])
def test_a_recording_is_streamed_as_it_is_exported(
    device: str, recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, hand = str(recording), []
    if device == "leap":
        source, hand = str(write(tmp_path / "leap.json", alone("right")[:200])), ["--hand", "right"]
    assert main(["export", source, "--to", str(tmp_path / "a.bvh"), *hand]) == 0
    capsys.readouterr()
    assert main(["stream", source, "--print", "--blender", ":1", "--speed", "100", *hand]) == 0
    told = moments(capsys.readouterr().out)
    truth = read_bvh(tmp_path / "a.bvh").place().positions[:, 0] @ Y_UP
    assert np.allclose([line.place for line in told], truth, atol=2e-6)
    assert np.allclose([line.time for line in told], np.arange(len(told)) / 60.0, atol=1e-4)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "the receiver is missing"),
        (["--maya", ":7002"], "the source of the hand is missing"),
        (["--maya", "nowhere", "--device", "tuio"], "not an address"),
        (["--maya", ":7002", "--device", "mouse"], "needs a window"),
        (["--script", "houdini"], "houdini"),
        (["--maya", ":7002", "--device", "tuio", "--json", "/no/such/x.json"], "no such folder"),
    ],
)
def test_options_that_make_no_sense_are_one_clear_line(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["stream", *words]) == 2
    told = capsys.readouterr().err
    assert said in told and told.count("\n") == 1
