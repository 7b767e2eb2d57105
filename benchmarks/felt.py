"""Measures what a hand feels: the friction of things, how hard it squeezes, and what it can carry.

Friction as felt is the force along the surface over the force into it. A flat thing slides down the
table, which is tilted until it does; and a heavy slab is drawn over one link of the hand after the
other. A squeeze is that of thumb and index finger whose targets are inside of a box that does not
give way. A thing is carried if it is still up after a second in the air.

    python -m benchmarks.felt
    python -m benchmarks.felt --plot docs/pictures/feel.svg
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from math import atan, sqrt
from pathlib import Path

import mujoco
import numpy as np

from benchmarks.feel import grasp, hold
from benchmarks.machine import describe_machine
from models.hand import IMPULSE_PROFILES, SERVOS, Hand, finger_armature
from models.objects import Box
from models.scene import CONTROL_PERIOD, TABLE, Scene, SceneSpec
from sandbox.figures.canvas import COLOURS, STYLE, figure
from tasks.sensing import Sensing

WRITTEN = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Coefficients of friction that a thing is made with."""
STEEPER = 0.5
"""How much more than the written friction and the table's the table is tilted, as a tangent."""
TABLE_FRICTION = 0.5
"""That of the table, as in most tasks."""
PRESSED, SPEED = 0.0005, 0.02
"""m by which the slab is pressed against a link, and m/s at which it is drawn over it."""
SLIDES = 0.2
"""s that a thing slides, of which the second half is measured."""
INSETS = (0.0005, 0.001, 0.002, 0.0035, 0.005, 0.0075, 0.010)
"""m by which targets of fingertips are inside of a face. The simulated user squeezes by 3.5 mm."""
MASSES = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""kg."""
CARRIED = (0.1, 0.2, 0.3, 0.5, 1.0)
"""Coefficients of friction of things to be carried."""
EDGE = 0.025
"""m, half an edge of a box between fingers."""


def on_table(written: float, own: bool) -> float:
    """Friction felt by a thing that slides on the table.

    Args:
        written: Coefficient that the thing is made with.
        own: The thing's friction counts.
    """
    box = Box("thing", (0.03, 0.03, 0.01), 0.1, (0.0, 0.0, 0.01), friction=written)
    scene = Scene(SceneSpec((), (box,), TABLE_FRICTION, own_friction=own))
    model, data = scene.model, mujoco.MjData(scene.model)
    weight = float(np.linalg.norm(model.opt.gravity))
    angle = atan(max(written, TABLE_FRICTION) + STEEPER)
    model.opt.gravity[:] = weight * np.sin(angle), 0.0, -weight * np.cos(angle)
    return _felt(scene, data, box.name, TABLE)


def on_link(written: float, own: bool, part: int) -> float:
    """Friction felt by a slab that is drawn over a part of the hand.

    Args:
        written: Coefficient that the slab is made with.
        own: The slab's friction counts.
        part: Index into the hand's parts that can be solid.
    """
    hand = Hand(solid_palm=True)
    slab = Box("slab", (0.2, 0.2, 0.01), 1.0, (0.0, 0.0, 1.0), friction=written)
    scene = Scene(SceneSpec((hand,), (slab,), TABLE_FRICTION, own_friction=own))
    model, data = scene.model, mujoco.MjData(scene.model)
    pose = np.concatenate([[0.0, 0.0, 0.3], np.zeros(45)])
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, pose)
    data.ctrl[:] = hand.controls(pose)
    geom = scene.parts(0)[part]
    scene.set_solid_geoms(0, {geom})
    model.opt.gravity[:] = 0.0
    mujoco.mj_forward(model, data)
    top = _top(model, data, geom)
    x, y = data.geom_xpos[geom][:2].tolist()
    at, dof = (int(adr[0]) for adr in (model.joint("slab").qposadr, model.joint("slab").dofadr))
    # Whatever pushes back, the slab keeps its height and its speed.
    sensing, forces = Sensing(scene, data), []
    steps = round(SLIDES / scene.spec.timestep)
    for step in range(steps):
        way = SPEED * step * scene.spec.timestep
        data.qpos[at : at + 7] = x + way, y, top - PRESSED + 0.01, 1.0, 0.0, 0.0, 0.0
        data.qvel[dof : dof + 6] = SPEED, 0.0, 0.0, 0.0, 0.0, 0.0
        mujoco.mj_step(model, data)
        if step >= steps // 2:
            forces.append(sensing.force("slab", hand.name).copy())
    return _ratio(np.mean(forces, axis=0))


def parts() -> tuple[str, ...]:
    """Names of the hand's parts that can be solid, in the order of `on_link`."""
    scene = Scene(SceneSpec((Hand(solid_palm=True),)))
    return tuple(scene.model.geom(part).name or f"palm {part}" for part in scene.parts(0))


def squeeze(impulse: float, inset: float) -> float:
    """Force in N with which thumb and index finger squeeze a box that does not give way.

    Args:
        impulse: Limit of the servos, N s per 1/60 s.
        inset: m from the box's faces to the targets of the fingertips' surfaces, inwards.
    """
    hand = Hand(impulse=impulse, finger_armature=finger_armature(impulse))
    box = Box("box", (EDGE,) * 3, 100.0, (0.0, 0.0, EDGE))
    scene = Scene(SceneSpec((hand,), (box,)))
    model, data = scene.model, mujoco.MjData(scene.model)
    opened, closed = (grasp(box, 2, gap) for gap in (0.002, -inset))
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, opened)
    scene.set_solid(0, frozenset(range(2)))
    for share in (*np.linspace(0.0, 1.0, round(0.4 / CONTROL_PERIOD)), *[1.0] * 30):
        data.ctrl[:] = opened + share * (closed - opened)
        mujoco.mj_step(model, data, scene.substeps)
    mujoco.mj_forward(model, data)
    total, force = 0.0, np.zeros(6)
    fingers = set(scene.parts(0))
    for i in range(data.ncon):
        if fingers & set(data.contact.geom[i].tolist()):
            mujoco.mj_contactForce(model, data, i, force)
            total += float(force[0])
    return total / 2


def heaviest(impulse: float, friction: float) -> float:
    """Largest of `MASSES`, kg, that thumb and two fingers carry as the simulated user does; 0 if
    none.

    Args:
        impulse: Limit of the servos, N s per 1/60 s.
        friction: Coefficient of the thing, which counts.
    """
    carried = 0.0
    box = Box("box", (EDGE,) * 3, 1.0, (0.0, 0.0, EDGE), friction=friction)
    for mass in MASSES:
        own = replace(box, mass=mass)
        if not hold(own, 3, SERVOS[0], impulse, hold=1.0, own_friction=True).held:
            break
        carried = mass
    return carried


def _felt(scene: Scene, data: mujoco.MjData, name: str, other: str) -> float:
    """Mean force along the table over that into it, of a thing that slides."""
    sensing, forces = Sensing(scene, data), []
    steps = round(SLIDES / scene.spec.timestep)
    for step in range(steps):
        mujoco.mj_step(scene.model, data)
        if step >= steps // 2:
            forces.append(sensing.force(name, other).copy())
    return _ratio(np.mean(forces, axis=0))


def _ratio(force: np.ndarray) -> float:
    """Horizontal over vertical part of a force (3,)."""
    x, y, z = force.tolist()
    return sqrt(x * x + y * y) / abs(z)


def _top(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Height in m of the highest point of a capsule or a box."""
    up = data.geom_xmat[geom].reshape(3, 3)[2]
    size = model.geom_size[geom]
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CAPSULE:
        above = size[0] + abs(up[2]) * size[1]
    elif model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE:
        above = size[0]
    else:
        above = float(np.abs(up) @ size)
    return float(data.geom_xpos[geom][2] + above)


def draw(
    felt: dict[str, list[float]],
    forces: dict[str, list[float]],
    carried: dict[str, list[float]],
    path: Path,
) -> None:
    """Draws the three measurements side by side.

    Args:
        felt: Friction as felt at each of `WRITTEN`, by name of a line.
        forces: N at each of `INSETS`, by profile.
        carried: kg at each of `CARRIED`, by profile.
        path: The picture.
    """
    from matplotlib import rc_context

    with rc_context({**STYLE, "svg.fonttype": "none"}):
        made = figure(9.6, 3.2)
        left, middle, right = made.subplots(1, 3)
        for (name, values), colour in zip(felt.items(), COLOURS, strict=False):
            style = "-" if "own" in name else "--"
            left.plot(WRITTEN, values, style, marker=".", color=colour, label=name)
        left.set(xlabel="friction as written", ylabel="friction as felt", ylim=(0.0, 1.1))
        for (name, values), colour in zip(forces.items(), COLOURS, strict=False):
            middle.plot(1000 * np.array(INSETS), values, marker=".", color=colour, label=name)
        middle.set(xlabel="fingertips inside of a face, mm", ylabel="squeeze, N")
        for (name, values), colour in zip(carried.items(), COLOURS, strict=False):
            right.plot(CARRIED, values, marker=".", color=colour, label=name)
        right.set(xlabel="friction as written, which counts", ylabel="heaviest thing carried, kg")
        for axes in (left, middle, right):
            axes.legend()
        made.savefig(path, metadata={"Date": None})


def main() -> None:
    """Prints three tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--plot", type=Path, help="also draws them, as SVG")
    args = parser.parse_args()
    print(describe_machine())
    names = parts()
    print(f"friction as felt; the table's is {TABLE_FRICTION:g}, {len(names)} parts of the hand")
    print("| written | table | table, own | hand, least to most | hand, own, least to most |")
    print("|" + " --- |" * 5)
    felt: dict[str, list[float]] = {}
    for written in WRITTEN:
        table = [on_table(written, own) for own in (False, True)]
        hand = [[on_link(written, own, i) for i in range(len(names))] for own in (False, True)]
        ranges = " | ".join(f"{min(each):.3f} to {max(each):.3f}" for each in hand)
        print(f"| {written:g} | {table[0]:.3f} | {table[1]:.3f} | {ranges} |", flush=True)
        values = (table[0], float(np.median(hand[0])), table[1], float(np.median(hand[1])))
        lines = ("on the table", "on the hand", "on the table, own", "on the hand, own")
        for line, value in zip(lines, values, strict=True):
            felt.setdefault(line, []).append(value)
    print()
    print("squeeze of thumb and index finger, N")
    print("| profile | " + " | ".join(f"{1000 * inset:g} mm" for inset in INSETS) + " |")
    print("|" + " --- |" * (1 + len(INSETS)))
    forces = {n: [squeeze(i, inset) for inset in INSETS] for n, i in IMPULSE_PROFILES.items()}
    for name, row in forces.items():
        print(f"| `{name}` | " + " | ".join(f"{value:.1f}" for value in row) + " |")
    print()
    print("heaviest thing that thumb and two fingers carry, kg, by its friction, which counts")
    print("| profile | " + " | ".join(f"{friction:g}" for friction in CARRIED) + " |")
    print("|" + " --- |" * (1 + len(CARRIED)))
    carried = {n: [heaviest(i, f) for f in CARRIED] for n, i in IMPULSE_PROFILES.items()}
    for name, row in carried.items():
        print(f"| `{name}` | " + " | ".join(f"{value:g}" for value in row) + " |", flush=True)
    if args.plot:
        draw(felt, forces, carried, args.plot)


if __name__ == "__main__":
    main()
