"""Overlaps of objects at the start of a trial, which physics would throw apart."""

from __future__ import annotations

import mujoco
import numpy as np

from models.arithmetic.products import length
from models.errors import InputError
from models.scene import TABLE, Scene
from tasks.guarded import build_scene
from tasks.task import Task

DEEPEST = 0.001
"""m, largest overlap of two objects, or of an object and the table, at the start. Contacts are
soft: an object at rest sinks in by some hundredths of a millimetre."""


def check_varied(task: Task, where: str, plain: Task | None = None) -> None:
    """Checks that the objects of a varied trial are apart from each other and from the table.

    Args:
        task: The varied trial.
        where: Task and seed, for messages.
        plain: The trial before it was varied; None does not look at rings.

    Raises:
        InputError: Two objects overlap; it names both. Or an object starts inside of a ring that it
            was outside of.
    """
    before = set() if plain is None else _inside_rings(plain)
    inside = set() if plain is None else _inside_rings(task) - before
    if inside:
        raise InputError(
            "objects start inside of the ring, where they are to be brought",
            where=where,
            got=", ".join(sorted(obj for _, obj in inside)),
            remedy="Vary it less",
        )
    check_apart(
        build_scene(task), where, "Vary it less: the physics would throw them across the table"
    )


def check_apart(scene: Scene, where: str, remedy: str) -> None:
    """Checks that the objects of a scene are apart from each other and from the table.

    Args:
        scene: The scene, in its first state.
        where: Task and seed, for messages.
        remedy: The next step, for the message.

    Raises:
        InputError: Two overlap; it names both.
    """
    deepest, pair = _deepest_overlap(scene)
    if deepest > DEEPEST:
        raise InputError(
            f"{pair[0]} and {pair[1]} overlap at the start",
            where=where,
            got=f"{1000 * deepest:.1f} mm deep",
            expected=f"at most {1000 * DEEPEST:g} mm",
            remedy=remedy,
        )


def _inside_rings(task: Task) -> set[tuple[str, str]]:
    """Names of painted rings and of the objects that start in each, in pairs."""
    return {
        (ring.name, obj.name)
        for ring in task.painted
        for obj in task.objects
        if length(np.subtract(obj.position[:2], ring.middle)) <= ring.radius
    }


def _deepest_overlap(scene: Scene) -> tuple[float, tuple[str, str]]:
    """Depth (m) and names of the two bodies that overlap most; 0 if none do."""
    model = scene.model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    deepest, pair = 0.0, ("", "")
    for contact in data.contact[: data.ncon]:
        if -contact.dist > deepest:
            deepest = -float(contact.dist)
            bodies = sorted(int(model.geom_bodyid[geom]) for geom in contact.geom)
            first, second = (model.body(body).name if body else TABLE for body in bodies)
            pair = (first, second)
    return deepest, pair
