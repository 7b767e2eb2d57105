"""Hands from Hand Sandbox in Blender: a script for its text editor, its command line, or `bpy`.

    blender -P hand_sandbox_blender.py                    # a window that listens on port 7004
    python hand_sandbox_blender.py --out hand.bvh         # no window: the module bpy, until a stop

    sandbox stream run.jsonl --blender :7004              # in another terminal

A streamed hand makes an armature of its own, hand_sandbox_right, that does what the hand does,
joint by joint, keyed. To move an armature of yours, select the first bones of one to five chains
in pose mode and call start() at the end of this text. Chains are taken in the order in which the
armature has them; start(chains=["thumb", "index"]) says another. Without a window:

    python hand_sandbox_blender.py --open rig.blend --armature Rig --chains thumb index --out a.glb

It follows the right hand; start(side="left"), or --side left, lets it follow the left one. For both
hands, call start(side=..., armature=..., chains=[...]) once for each, or stream twice: with --side
right and --out one.blend, then with --open one.blend and --side left.

Keys are set at the scene's rate: what --fps says, that of the file that --open opens, or 60. A .glb
or .fbx file has the armature, its skin and this motion; two streamed hands make two files, but one
.blend.

Chains may have any number of bones. They point where the fingers point and reach as far, as shares
of their lengths; the joints between bend evenly. The bone above the chains follows the palm from
where it stands, by what the palm moves and turns after its first moment. If that moment was seen
wrongly, the whole take is turned: start(absolute=True), or --absolute, puts the palm where the
streamed one is. Keys go straight onto the bones: there is nothing to bake. stop() lets go.
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
from sandbox.stream.guest_line import LONGEST, Line
from sandbox.stream.guest_math import Refused

PORT = 7004
TICK = 0.008  # s between two looks at the port in a window
SIDES = ("right", "left")
ENDINGS = (".bvh", ".glb", ".fbx", ".blend")

hands: Dict[str, Any] = {}
counts: Dict[str, int] = {"lines": 0, "lines refused": 0}
streamed: Set[str] = set()  # sides of hands that came
shown: Set[str] = set(SIDES)  # sides that get an armature of their own if no rig waits for them
stopped: List[str] = []
listener: Optional["Listener"] = None


class Listener:
    """Receives lines from any program that connects, on this machine only."""

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
        """Ends it."""
        for guest in self.guests:
            guest.close()
        self.server.close()


def take(text: str) -> None:
    """Processes a line of the stream; no content of the line stops Blender."""
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
    """Lets the selected chains, or named ones, follow a streamed hand."""
    if side not in SIDES:
        raise Refused("no hand is %s: right or left" % side)
    rig = bpy.data.objects.get(armature) if armature else bpy.context.object
    if rig is None or rig.type != "ARMATURE":
        there = [each.name for each in bpy.data.objects if each.type == "ARMATURE"]
        said = "no armature has the name %s" % armature if armature else "no armature is selected"
        raise Refused("%s; the file has: %s" % (said, ", ".join(there) or "none"))
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
    """Begins to listen; in a window, a timer processes the lines."""
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
    """Writes an armature with its skin and this motion alone; .blend has the whole scene.

    The end of the name chooses the format: .bvh, .glb, .fbx, .blend.
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
        # Otherwise all actions of the file would be written, those of the other hand, too.
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
    """Prints the largest sudden turn of a rig's palm, which no hand makes; nothing without one."""
    if rig.jumps:
        angle, frame = max(rig.jumps)
        print(
            "hand_sandbox: the palm turned by %.0f degrees at once at frame %d, so it was seen "
            "wrongly before or after it%s"
            % (
                math.degrees(angle),
                frame,
                "" if rig.absolute else "; if the rig stands the wrong way round, use --absolute",
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
    """Without a window: listens until every hand that was streamed has stopped.

    The exit status is 1 if a rig got no hand, and 2, with one line of explanation, if a request
    cannot be met.
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
        help="puts the palm where the streamed one is, not on from where the rig stands",
    )
    parser.add_argument("--out", default="", metavar="FILE")
    asked = parser.parse_args(list(words))
    if asked.out and not asked.out.endswith(ENDINGS):
        raise Refused("--out needs a name that ends in %s, not %s" % (" ".join(ENDINGS), asked.out))
    if asked.armature and not asked.chains:
        raise Refused("--armature needs --chains: the first bones of one to five chains")
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
        # A rig without a streamed hand waits for nothing; a hand without a rig stops, too.
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
            "hand_sandbox: %s waited for the %s hand, which was not streamed; --side says another"
            % (rigs.pop(side).armature.name, side)
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
