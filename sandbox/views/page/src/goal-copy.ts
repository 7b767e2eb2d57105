// The goal: a translucent copy of an object, with visible edges.

import {
  CylinderGeometry,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Vector3,
} from "three";
import { goalColour } from "./colours";
import type { Geom, GoalState } from "./protocol";
import { MARKED, geometry, place } from "./shapes";

const EDGE_RADIUS = 0.0008;
const CORNERS = [-1, 1] as const;
const ALONG_Y = new Vector3(0, 1, 0);

export class Ghost {
  readonly group = new Group();
  private readonly inside = new MeshBasicMaterial({
    transparent: true,
    opacity: 0.26,
    depthWrite: false,
    ...MARKED,
  });
  private readonly edges = new MeshBasicMaterial({
    transparent: true,
    opacity: 0.95,
    ...MARKED,
  });
  private readonly lines = new LineBasicMaterial(MARKED);

  /** @param geoms Geoms of the object's body. */
  constructor(geoms: Geom[]) {
    for (const geom of geoms) {
      const shape = geometry(geom);
      // A little larger than the object, so that coinciding faces do not flicker.
      const body = new Mesh(shape.clone().scale(1.006, 1.006, 1.006), this.inside);
      place(body, geom);
      body.renderOrder = 2;
      const outline =
        geom.kind === "box"
          ? this.boxEdges(geom.size)
          : new LineSegments(new EdgesGeometry(shape, 30), this.lines);
      place(outline, geom);
      this.group.add(body, outline);
    }
  }

  show(goal: GoalState, reached: boolean, held: boolean): void {
    this.group.position.set(...goal.position);
    this.group.rotation.set(0, 0, goal.yaw);
    const colour = goalColour(reached, held);
    for (const material of [this.inside, this.edges, this.lines]) material.color.set(colour);
  }

  /** Twelve thin rods; lines of WebGL are one pixel wide. */
  private boxEdges([a, b, c]: [number, number, number]): Group {
    const half = new Vector3(a, b, c);
    const group = new Group();
    for (const axis of ["x", "y", "z"] as const) {
      const [u, v] = (["x", "y", "z"] as const).filter((n) => n !== axis) as ["x", "y"];
      const direction = new Vector3();
      direction[axis] = 1;
      for (const i of CORNERS)
        for (const j of CORNERS) {
          const length = 2 * half[axis];
          const rod = new Mesh(
            new CylinderGeometry(EDGE_RADIUS, EDGE_RADIUS, length, 6),
            this.edges,
          );
          rod.quaternion.setFromUnitVectors(ALONG_Y, direction);
          rod.position[u] = i * half[u];
          rod.position[v] = j * half[v];
          group.add(rod);
        }
    }
    return group;
  }
}
