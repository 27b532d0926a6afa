// Shapes of bodies, markers of frames and springs, as objects of three.js.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Color, ConeGeometry, CylinderGeometry, Group, Matrix4, Mesh,
  MeshStandardMaterial, SphereGeometry, Vector3,
} from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import { decode } from "./motion.js";

const CREASE = Math.PI / 6; // faces that meet at a smaller angle are shaded as one smooth surface (rad)

/** Returns the 4 x 4 matrix of a rotation by rows and a position. */
export function placement(rotation, position) {
  const [a, b, c, d, e, f, g, h, i] = rotation;
  const [x, y, z] = position;
  return new Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

/** Makes the objects of shapes; equal materials and meshes are made once. */
export class ShapeMaker {
  constructor(meshes) {
    this.geometries = meshes.map((one) => () => meshGeometry(one));
    this.made = new Map();
    this.materials = new Map();
  }

  /** Returns the object of a shape, in the frame of its body. */
  make(shape) {
    const object = new Mesh(this.#geometry(shape), this.#material(shape));
    const size = shape.kind === "ellipsoid" || shape.kind === "mesh" ? shape.size : [1, 1, 1];
    object.matrixAutoUpdate = false;
    object.matrix = placement(shape.rotation, shape.position).multiply(new Matrix4().makeScale(...size));
    object.castShadow = object.receiveShadow = true;
    return object;
  }

  #geometry(shape) {
    if (shape.kind !== "mesh") return primitive(shape.kind, shape.size);
    if (!this.made.has(shape.mesh)) this.made.set(shape.mesh, this.geometries[shape.mesh]());
    return this.made.get(shape.mesh);
  }

  #material({ color, opacity, role }) {
    const key = `${color} ${opacity} ${role}`;
    if (!this.materials.has(key)) {
      const isClear = opacity < 1;
      const material = new MeshStandardMaterial({
        color: new Color(color), roughness: role === "joint" ? 0.45 : 0.6, metalness: role === "joint" ? 0.25 : 0.05,
        transparent: isClear, opacity, depthWrite: !isClear,
      });
      this.materials.set(key, material);
    }
    return this.materials.get(key);
  }
}

// Cylinders and capsules of three.js stand along y, those of a scene along z.
function primitive(kind, size) {
  if (kind === "box") return new BoxGeometry(...size);
  if (kind === "sphere") return new SphereGeometry(size[0], 32, 20);
  if (kind === "ellipsoid") return new SphereGeometry(1, 40, 26);
  const upright = { cylinder: () => new CylinderGeometry(size[0], size[0], size[1], 32), capsule: () => new CapsuleGeometry(size[0], size[1], 10, 28), rod: () => new CylinderGeometry(size[0], size[0], size[1], 12) };
  return upright[kind]().rotateX(Math.PI / 2);
}

function meshGeometry({ vertices, faces, origin, step }) {
  const integers = decode(vertices, Uint16Array);
  const positions = new Float32Array(integers.length);
  integers.forEach((value, i) => (positions[i] = origin[i % 3] + step[i % 3] * value));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(decode(faces, Uint16Array), 1));
  return toCreasedNormals(geometry, CREASE);
}

const AXES = ["#e5484d", "#30a46c", "#3e63dd"];

/** Returns three coloured axes of a length (m). */
export function axes(length) {
  const group = new Group();
  AXES.forEach((color, i) => {
    const end = [0, 0, 0];
    end[i] = length;
    group.add(lines([[0, 0, 0], end], color));
  });
  return group;
}

/** Returns line segments between pairs of points, of a width in pixels. */
export function lines(points, color, linewidth = 2) {
  return new LineSegments2(new LineSegmentsGeometry().setPositions(points.flat()), new LineMaterial({ color, linewidth }));
}

/** Returns a line through points, of a width in pixels. */
export function curve(points, color, linewidth = 1.8) {
  return new Line2(new LineGeometry().setPositions(points.flat()), new LineMaterial({ color, linewidth }));
}

const HEAD = 0.28; // length of the head of an arrow over its length

/** An arrow: a shaft and a head, which point along any direction. */
export class Arrow extends Group {
  constructor(color) {
    super();
    const material = new MeshStandardMaterial({ color, roughness: 0.5 });
    const shaft = new Mesh(new CylinderGeometry(1, 1, 1 - HEAD, 16).translate(0, (1 - HEAD) / 2, 0), material);
    const head = new Mesh(new ConeGeometry(2.6, HEAD, 24).translate(0, 1 - HEAD / 2, 0), material);
    this.add(shaft, head);
  }

  /** Puts the arrow at a point, along a vector of any length but zero, with its own length and radius (m). */
  set(point, vector, length, radius) {
    this.position.set(...point);
    this.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...vector).normalize());
    this.scale.set(radius, length, radius);
  }
}

const COILS = 8;
const STEPS = 16;

/** Returns the vertices of a helix of radius 1 along z from 0 to 1, with straight ends, as segments. */
export function coil() {
  const points = [[0, 0, 0], [0, 0, 0.08]];
  for (let i = 0; i <= COILS * STEPS; i++) {
    const angle = (2 * Math.PI * i) / STEPS;
    const grown = Math.min(1, i / STEPS, COILS - i / STEPS);
    points.push([grown * Math.cos(angle), grown * Math.sin(angle), 0.08 + (0.84 * i) / (COILS * STEPS)]);
  }
  points.push([0, 0, 1]);
  return points.slice(1).flatMap((point, i) => [points[i], point]);
}
