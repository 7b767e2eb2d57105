"""Hands from Hand Sandbox in Blender: a script for its text editor, its command line, or `bpy`.

    blender -P hand_sandbox_blender.py                    # a window that listens on port 7004
    python hand_sandbox_blender.py --out hand.bvh         # without a window; ends with the stream

    sandbox stream run.jsonl --blender :7004              # in another terminal

By default, a streamed hand makes a new armature, hand_sandbox_right, with keyframes for every joint
of the hand. To move an armature of your own instead, select the first bones of one to five chains
in pose mode and call start() at the end of this text. Chains have the order of the armature;
start(chains=["thumb", "index"]) gives another order. Without a window:

    python hand_sandbox_blender.py --open rig.blend --armature Rig --chains thumb index --out a.glb

The armature follows the right hand; with start(side="left"), or --side left, it follows the left
hand. For both hands, call start(side=..., armature=..., chains=[...]) once for each hand, or stream
twice: with --side right and --out one.blend, then with --open one.blend and --side left.

Keyframes are set at the scene's rate: the rate of --fps, else that of the file of --open, else 60.
A .glb or .fbx file has the armature, its skin and this motion. Two streamed hands give two files,
but a single .blend.

Chains may have any number of bones. A chain points in the direction of its finger. The distance
from the base to the tip of a chain, divided by the chain's length, is the same as for the finger.
The joints in between bend evenly. The bone above the chains starts at its own place, and then moves
as the streamed palm has moved since the first frame of the stream. If the palm was seen wrongly in
this frame, the whole take is turned. In this case use start(absolute=True), or --absolute: the bone
is then at the place of the streamed palm. Keyframes are set on the bones themselves, so that no
bake is needed. stop() releases the armature.
"""

from __future__ import annotations

import argparse
import math
import os
import select
import socket
import sys
import time
from typing import Any, Dict, List, Optional, Sequence, Set

import bpy

from sandbox.stream.blender_rigs import ForeignRig, OwnHand
from sandbox.stream.guest import LONGEST, Line, Refused

PORT = 7004
TICK = 0.008  # time between two checks of the port in a window, s
SIDES = ("right", "left")
ENDINGS = (".bvh", ".glb", ".fbx", ".blend")

hands: Dict[str, Any] = {}
counts: Dict[str, int] = {"lines": 0, "lines refused": 0}
streamed: Set[str] = set()  # sides of the hands that were streamed
shown: Set[str] = set(SIDES)  # sides that get an armature of their own if no rig waits for them
stopped: List[str] = []
listener: Optional["Listener"] = None


class Listener:
    """Receives lines from all programs on this machine that connect."""

    def __init__(self, port: int) -> None:
        self.server = socket.create_server(("127.0.0.1", port))
        self.server.setblocking(False)
        self.port = self.server.getsockname()[1]
        self.guests: Dict[socket.socket, bytes] = {}

    def poll(self) -> int:
        """Processes the received lines; returns their number."""
        count = 0
        if select.select([self.server], [], [], 0.0)[0]:
            guest, _ = self.server.accept()
            guest.setblocking(False)
            self.guests[guest] = b""
        for guest in list(self.guests):
            try:
                data = guest.recv(65536)
            except BlockingIOError:
                continue
            except OSError:
                data = b""
            *lines, left = (self.guests[guest] + data).split(b"\n")
            if not data or len(left) >= LONGEST:
                guest.close()
                del self.guests[guest]
            else:
                self.guests[guest] = left
            for text in lines:
                take(text.decode("utf-8", "replace"))
                count += 1
                if guest in self.guests:
                    _answer(guest)
        return count

    def close(self) -> None:
        """Closes the port and all connections."""
        for guest in self.guests:
            guest.close()
        self.server.close()


def take(text: str) -> None:
    """Processes a line of the stream. A bad line raises no error, so that Blender continues."""
    try:
        line = Line(text)
        if line.kind == "stop":
            stop(line.side)
            stopped.append(line.side)
        elif line.kind == "rig":
            streamed.add(line.side)
            if line.side not in hands and line.side in shown:
                hands[line.side] = OwnHand(line)
        elif line.side in hands:
            hands[line.side].update(line)
        counts["lines"] += 1
    except Exception as error:  # a timer that fails once is not called again
        counts["lines refused"] += 1
        if counts["lines refused"] <= 3:
            print("hand_sandbox: %s" % error)


def start(
    side: str = "right",
    armature: Optional[str] = None,
    chains: Optional[Sequence[str]] = None,
    fingers: Optional[Sequence[int]] = None,
    root: Optional[str] = None,
    scale: Optional[float] = None,
    absolute: bool = False,
) -> None:
    """Makes the selected chains, or the named chains, follow a streamed hand."""
    if side not in SIDES:
        raise Refused("side=%s is not a hand: use right or left" % side)
    rig = bpy.data.objects.get(armature) if armature else bpy.context.object
    if rig is None or rig.type != "ARMATURE":
        there = [each.name for each in bpy.data.objects if each.type == "ARMATURE"]
        said = "no armature has the name %s" % armature if armature else "no armature is selected"
        raise Refused("%s; the file's armatures: %s" % (said, ", ".join(there) or "none"))
    names = chains or [bone.name for bone in bpy.context.selected_pose_bones or []]
    hands[side] = ForeignRig(rig, names, fingers, side, root, scale, absolute)


def stop(side: Optional[str] = None) -> None:
    """Releases the rigs of one hand, or of all hands; their keys remain."""
    for name in [side] if side else list(hands):
        hand = hands.pop(name, None)
        if hand is not None and hand.frames:
            scene = bpy.context.scene
            scene.frame_end = max(scene.frame_end, hand.frames[1])


def listen(port: int = PORT) -> "Listener":
    """Starts to listen. In a window, a timer processes the lines."""
    global listener  # noqa: PLW0603
    if listener is None:
        listener = Listener(port)
        if not bpy.app.background:
            bpy.app.timers.register(_tick, persistent=True)
    return listener


def _tick() -> float:
    if listener is not None:
        listener.poll()
    return TICK


def _answer(guest: socket.socket) -> None:
    try:
        guest.sendall(b"ok\n")
    except OSError as error:
        print("hand_sandbox: %s" % error)


def export(path: str, armature: Any, frames: Sequence[int]) -> None:
    """Writes an armature with its skin and only this motion; a .blend file has the whole scene.

    The ending of the name chooses the format: .bvh, .glb, .fbx, .blend.
    """
    if not path.endswith(".blend"):
        bpy.context.scene.frame_start, bpy.context.scene.frame_end = frames
    bpy.ops.object.select_all(action="DESELECT")
    for each in [armature, *_skins(armature)]:
        each.select_set(True)
    bpy.context.view_layer.objects.active = armature
    if path.endswith(".bvh"):
        bpy.ops.export_anim.bvh(
            filepath=path,
            frame_start=frames[0],
            frame_end=frames[1],
            global_scale=100.0,
            rotate_mode="ZXY",
            root_transform_only=True,
        )
    elif path.endswith(".glb"):
        # By default, all actions of the file would be written, including those of the other hand.
        bpy.ops.export_scene.gltf(
            filepath=path, use_selection=True, export_animation_mode="ACTIVE_ACTIONS"
        )
    elif path.endswith(".fbx"):
        bpy.ops.export_scene.fbx(
            filepath=path,
            use_selection=True,
            bake_anim_use_all_actions=False,
            bake_anim_use_nla_strips=False,
            bake_anim_simplify_factor=0.0,
            add_leaf_bones=False,
        )
    else:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(path))


def _warn(rig: Any) -> None:
    """Prints the largest implausible turn of a rig's palm; nothing without such a turn."""
    if rig.jumps:
        angle, frame = max(rig.jumps)
        print(
            "hand_sandbox: the palm turned by %.0f degrees at once at frame %d, so its pose before "
            "or after this frame is wrong%s"
            % (
                math.degrees(angle),
                frame,
                "" if rig.absolute else "; if the rig points in a wrong direction, use --absolute",
            )
        )


def _skins(armature: Any) -> List[Any]:
    """The meshes that an armature moves."""
    return [
        each
        for each in bpy.context.scene.objects
        if each.type == "MESH"
        and (
            each.parent == armature
            or any(m.type == "ARMATURE" and m.object == armature for m in each.modifiers)
        )
    ]


def main(words: Sequence[str]) -> int:
    """Runs without a window: listens until every streamed hand has stopped.

    Returns the exit status: 1 if a rig got no hand; 2, with one line of explanation, if a request
    cannot be met; otherwise 0.
    """
    try:
        return run(words)
    except (Refused, OSError, OverflowError) as error:
        print("hand_sandbox: %s" % error, file=sys.stderr)
        return 2


def run(words: Sequence[str]) -> int:
    """Runs the words of a command line; returns the exit status."""
    parser = argparse.ArgumentParser("hand_sandbox_blender.py")
    parser.add_argument("--port", type=int, default=PORT)
    parser.add_argument(
        "--fps", type=int, help="default: 60, or the rate of the scene that was opened"
    )
    parser.add_argument("--open", default="", metavar="FILE.blend")
    parser.add_argument("--armature", default="")
    parser.add_argument("--chains", nargs="*", default=[])
    parser.add_argument("--side", choices=SIDES, default="right", help="hand that moves the chains")
    parser.add_argument(
        "--absolute",
        action="store_true",
        help="put the palm at the place of the streamed palm; default: move it from its own place",
    )
    parser.add_argument("--out", default="", metavar="FILE")
    asked = parser.parse_args(list(words))
    if asked.out and not asked.out.endswith(ENDINGS):
        raise Refused("--out needs a name that ends in %s, not %s" % (" ".join(ENDINGS), asked.out))
    if asked.armature and not asked.chains:
        raise Refused("--armature needs --chains with the first bones of one to five chains")
    if asked.open:
        try:
            bpy.ops.wm.open_mainfile(filepath=asked.open)
        except RuntimeError as error:
            raise Refused(" ".join(str(error).split())) from None
    else:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    if asked.fps or not asked.open:
        bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = asked.fps or 60, 1.0
    if asked.chains:
        shown.clear()  # only the rig is needed
        start(
            asked.side,
            armature=asked.armature or None,
            chains=asked.chains,
            absolute=asked.absolute,
        )
    port = listen(asked.port)
    print("hand_sandbox: listening on 127.0.0.1:%d" % port.port, flush=True)
    rigs = dict(hands)
    try:
        # Only streamed hands count: a rig without a streamed hand does not keep this loop running.
        while not stopped or streamed - set(stopped):
            if not port.poll():
                time.sleep(0.001)
            rigs.update(hands)
    except KeyboardInterrupt:
        print("hand_sandbox: stopped")
    finally:
        port.close()
    idle = set(hands) - streamed
    for side in idle:
        print(
            "hand_sandbox: %s waited for the %s hand, which was not streamed; --side chooses the "
            "hand" % (rigs.pop(side).armature.name, side)
        )
    for side, rig in rigs.items():
        path = asked.out
        if len(rigs) > 1 and path and not path.endswith(".blend"):
            path = ("-%s" % side).join(os.path.splitext(path))
        if path and rig.frames:
            export(path, rig.armature, rig.frames)
        print("hand_sandbox: %s, frames %s, %s" % (rig.armature.name, rig.frames, path or "kept"))
        _warn(rig)
    return 0 if rigs and not idle else 1


if __name__ == "__main__":
    if bpy.app.background:
        sys.exit(main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]))
    listen()
