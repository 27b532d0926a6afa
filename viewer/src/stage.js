// The picture: bodies where {x} puts them, light, ground, camera, and what can be shown or hidden.

import {
  AmbientLight, Box3, BufferGeometry, Color, DirectionalLight, Float32BufferAttribute, Group, HemisphereLight, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, PCFShadowMap, PerspectiveCamera, PlaneGeometry, Quaternion, Raycaster,
  Scene as World, ShadowMaterial, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { poses, pointOf, POSE, turned } from "./kinematics.js";
import { Arrow, axes, coil, curve, lines, placement, ShapeMaker } from "./shapes.js";

const THEMES = {
  light: { background: "#eef1f5", grid: "#c3cad4", shadow: 0.22, path: "#d6336c", spring: "#57606f" },
  dark: { background: "#14181f", grid: "#323b49", shadow: 0.45, path: "#ff7aa8", spring: "#aab4c4" },
};

const FIELD_OF_VIEW = 36; // degrees
const CELLS = 24; // cells of the grid from its centre to its rim
const FAR = 5; // a motion that fills a box of more than this many lengths of the tree is followed
const VEIL = 0.45; // opacity of inertia ellipsoids of bodies with geometry
const FORCE = "#e8590c";
const WEIGHT = "#1c7ed6";

/** Directions from which the camera looks at the centre, in a frame whose third axis points up. */
export const CAMERAS = { corner: [1.1, -1.6, 0.85], front: [1, 0, 0.001], side: [0, -1, 0.001], top: [0.001, -0.001, 1] };

/** A picture in an element of a page. `setState` moves it; everything else is how it looks. */
export class Stage {
  constructor(element, scene, { theme = "light" } = {}) {
    this.element = element;
    this.scene = scene;
    this.world = new World();
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    element.append(this.renderer.domElement);
    this.up = upward(scene.gravity);
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.001, 1000);
    this.camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.shown = {};
    this.poses = poses(scene, scene.start);
    this.#makeBodies();
    this.#makeMarkers();
    this.bounds = this.#measure();
    this.#makeLight();
    this.setTheme(theme);
    this.setState(scene.start);
    this.look("corner");
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
  }

  #makeBodies() {
    this.maker = new ShapeMaker(this.scene.meshes);
    this.bodies = this.scene.bodies.map((_, number) => {
      const group = new Group();
      group.matrixAutoUpdate = false;
      this.#makeShapes(group, number);
      this.world.add(group);
      return group;
    });
    this.hasGeometry = this.scene.bodies.some((body) => body.shapes.some((shape) => shape.role === "geometry"));
    if (this.hasGeometry) this.bodies[0].children.forEach((object) => (object.userData.standsIn = false));
  }

  #makeShapes(group, number) {
    const { shapes } = this.scene.bodies[number];
    const hasGeometry = shapes.some((shape) => shape.role === "geometry");
    for (const shape of shapes) {
      const isVeil = hasGeometry && shape.role === "inertia";
      const object = this.maker.make(isVeil ? { ...shape, opacity: VEIL } : shape);
      object.userData = { number, role: shape.role, standsIn: !hasGeometry };
      group.add(object);
    }
  }

  #makeMarkers() {
    const { frames, points, springs, bodies, size } = this.scene;
    this.frames = frames.map((frame) => {
      const marker = axes(0.1 * size);
      marker.matrixAutoUpdate = false;
      marker.matrix = placement(frame.rotation, frame.position);
      return this.#attach(frame.body, marker);
    });
    this.springs = springs.map((ends) => {
      const object = lines(coil(), "#888888");
      object.matrixAutoUpdate = false;
      this.world.add(object);
      return { ends, object };
    });
    this.weights = bodies.flatMap((body, number) => (body.mass > 0 ? [{ number, body, arrow: this.#arrow(WEIGHT) }] : []));
    this.labels = [...bodies.map((body, number) => ({ name: body.name, body: number, position: body.center })).slice(1), ...points].map((place) => {
      const tag = document.createElement("span");
      tag.className = "kg-label";
      tag.textContent = place.name;
      this.element.append(tag);
      return { place, tag };
    });
    this.paths = new Group();
    this.world.add(this.paths);
    this.forceArrows = [];
  }

  #attach(body, object) {
    this.bodies[body].add(object);
    return object;
  }

  #arrow(color) {
    const arrow = new Arrow(color);
    this.world.add(arrow);
    return arrow;
  }

  /** Returns the box around all bodies in the poses that are set, never an empty one. */
  #measure() {
    this.#place();
    const box = new Box3();
    this.bodies.forEach((group, number) => {
      if (number || this.hasGeometry) group.children.forEach((one) => one.isMesh && isShown(one, this.shown) && box.expandByObject(one));
      else group.children.forEach((one) => one.isMesh && box.expandByPoint(new Vector3().setFromMatrixPosition(one.matrix)));
    });
    this.bodies.slice(1).forEach((group) => box.expandByPoint(new Vector3().setFromMatrixPosition(group.matrix)));
    if (box.isEmpty()) box.expandByPoint(new Vector3());
    const size = box.getSize(new Vector3()).length();
    return size > 1e-9 * this.scene.size ? box : box.expandByScalar(0.5 * this.scene.size);
  }

  #makeLight() {
    const reach = this.#reach();
    this.world.add(new AmbientLight("#ffffff", 0.25), new HemisphereLight("#ffffff", "#b4bdca", 1.0));
    const sun = new DirectionalLight("#fff7ea", 2.3);
    const aside = new Vector3(0.7, -0.9, 1.8).applyQuaternion(toUp(this.up)).multiplyScalar(2 * reach);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    Object.assign(sun.shadow.camera, { left: -2 * reach, right: 2 * reach, top: 2 * reach, bottom: -2 * reach, near: 0.1 * reach, far: 12 * reach });
    sun.shadow.bias = -0.0004;
    sun.shadow.normalBias = 0.004 * reach;
    this.sun = { light: sun, aside };
    this.world.add(sun, sun.target);
  }

  #reach() {
    return Math.max(0.5 * this.bounds.getSize(new Vector3()).length(), 1e-6 * this.scene.size);
  }

  // The ground lies under the lowest point that the motion reaches; the inertial origin need not be on it.
  #layGround() {
    const reach = this.#reach();
    const tilt = toUp(this.up);
    const center = this.bounds.getCenter(new Vector3());
    const depth = Math.min(...corners(this.bounds).map((corner) => corner.dot(this.up)));
    const foot = center.clone().addScaledVector(this.up, depth - 0.002 * reach - center.dot(this.up));
    const step = (this.step = niceStep(reach / 3));
    const colors = THEMES[this.theme];
    if (this.ground) this.world.remove(this.ground);
    this.ground = new Group();
    const grid = gridOf(step, new Color(colors.grid), new Color(colors.background));
    const plane = new Mesh(new PlaneGeometry(2 * CELLS * step, 2 * CELLS * step), new ShadowMaterial({ opacity: colors.shadow }));
    plane.receiveShadow = true;
    this.ground.add(grid, plane);
    this.ground.quaternion.copy(tilt);
    this.ground.position.copy(foot);
    this.world.add(this.ground);
    this.sun.light.position.copy(center).add(this.sun.aside);
    this.sun.light.target.position.copy(center);
    this.ground.visible = this.shown.grid ?? true;
  }

  /** Sets the colours: "light" or "dark". */
  setTheme(theme) {
    this.theme = theme;
    const colors = THEMES[theme];
    this.world.background = new Color(colors.background);
    this.springs.forEach(({ object }) => object.material.color.set(colors.spring));
    this.#layGround();
    this.paths.children.forEach((line) => line.material.color.set(colors.path));
    this.draw();
  }

  /** Shows or hides "geometry", "inertia", "joints", "frames", "names", "weights", "forces", "paths", "springs", "grid". */
  show(what, isShown) {
    this.shown[what] = isShown;
    this.#refresh();
  }

  /** Puts all bodies where {x} and the prescribed values put them. */
  setState(x, prescribed = []) {
    poses(this.scene, x, prescribed, this.poses);
    if (this.isFollowing) this.#moveAlong();
    this.#refresh();
  }

  /** Puts all bodies into poses: (N + 1) times twelve numbers, as `poses` returns them. */
  setPoses(all) {
    this.poses.set(all);
    this.#refresh();
  }

  /** Draws the shapes of the scene anew, where they have changed. */
  reshape() {
    this.bodies.forEach((group, number) => {
      for (const object of group.children.filter((one) => one.isMesh)) {
        group.remove(object);
        object.geometry.dispose();
      }
      this.#makeShapes(group, number);
    });
    this.#refresh();
  }

  /**
   * Sets forces, and the size of the largest (N): each has the number of its body, its point in the body (m), and
   * components, which are inertial unless a `rotation` takes them to those of the body.
   */
  setForces(forces, largest) {
    while (this.forceArrows.length < forces.length) this.forceArrows.push(this.#arrow(FORCE));
    this.forces = { forces, largest };
    this.#refresh();
  }

  /** Draws the paths of points: each an array of inertial positions (m). */
  setPaths(paths) {
    this.paths.clear();
    for (const points of paths) if (points.length > 1) this.paths.add(curve(points, THEMES[this.theme].path));
    this.draw();
  }

  /** Makes room for all poses that a motion reaches; returns whether it goes so far that the camera should follow. */
  include(states) {
    const boxes = states.map(([x, prescribed]) => {
      poses(this.scene, x, prescribed, this.poses);
      return this.#measure();
    });
    const whole = boxes.reduce((box, one) => box.union(one), boxes[0].clone());
    const isFar = lengthOf(whole) > FAR * this.scene.size;
    this.bounds = isFar ? boxes[0] : whole;
    this.#layGround();
    poses(this.scene, ...states[0], this.poses);
    this.follow(isFar);
    this.look("corner");
    return isFar;
  }

  /** Lets the camera follow the mass centre, or not. */
  follow(isFollowing) {
    this.isFollowing = isFollowing;
    this.center = this.#massCenter();
  }

  #massCenter() {
    const center = new Vector3();
    let total = 0;
    this.scene.bodies.forEach((body, number) => {
      if (number) center.addScaledVector(new Vector3(...pointOf(this.poses, number, body.center)), body.mass);
      total += body.mass;
    });
    return total ? center.divideScalar(total) : center;
  }

  // Camera and sun move with the mass centre; the grid moves by whole cells along the ground, so that it never ends.
  #moveAlong() {
    const center = this.#massCenter();
    const shift = center.clone().sub(this.center);
    this.center = center;
    for (const one of [this.camera.position, this.controls.target, this.sun.light.position, this.sun.light.target.position]) one.add(shift);
    const inside = this.ground.worldToLocal(center.clone());
    const cells = new Vector3(Math.round(inside.x / this.step) * this.step, Math.round(inside.y / this.step) * this.step, 0);
    this.ground.position.add(cells.applyQuaternion(this.ground.quaternion));
    this.controls.update();
  }

  /** Looks at the centre from a direction of `CAMERAS`. */
  look(name) {
    const direction = new Vector3(...CAMERAS[name]).normalize().applyQuaternion(toUp(this.up));
    const center = this.isFollowing ? this.#massCenter() : this.bounds.getCenter(new Vector3());
    const aspect = Math.max(this.camera.aspect, 1e-3);
    const angle = (FIELD_OF_VIEW * Math.PI) / 360;
    const distance = (1.12 * this.#reach()) / Math.sin(Math.atan(Math.tan(angle) * Math.min(1, aspect)));
    this.camera.position.copy(center).addScaledVector(direction, distance);
    this.camera.near = 0.005 * distance;
    this.camera.far = 60 * distance;
    this.controls.target.copy(center);
    this.controls.update();
    this.resize();
  }

  /** Returns the name of the body under a place of the page, and what the file says of it; null for none. */
  under(clientX, clientY) {
    const frame = this.renderer.domElement.getBoundingClientRect();
    const place = new Vector2((2 * (clientX - frame.left)) / frame.width - 1, 1 - (2 * (clientY - frame.top)) / frame.height);
    const ray = new Raycaster();
    ray.setFromCamera(place, this.camera);
    const hits = ray.intersectObjects(this.bodies, true).filter(({ object }) => object.visible && object.userData.number !== undefined);
    return hits.length ? this.scene.bodies[hits[0].object.userData.number] : null;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Asks for a picture at the next chance; many calls make one picture. */
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.#refreshLabels();
      this.renderer.render(this.world, this.camera);
    });
  }

  #place() {
    this.bodies.forEach((group, number) => {
      const pose = this.poses.subarray(POSE * number, POSE * (number + 1));
      group.matrix = placement(pose.subarray(0, 9), pose.subarray(9, 12));
      group.matrixWorldNeedsUpdate = true;
    });
    this.world.updateMatrixWorld();
  }

  #refresh() {
    this.#place();
    for (const group of this.bodies) {
      for (const object of group.children) if (object.isMesh) object.visible = isShown(object, this.shown);
    }
    this.frames.forEach((marker) => (marker.visible = this.shown.frames ?? false));
    if (this.ground) this.ground.visible = this.shown.grid ?? true;
    this.paths.visible = this.shown.paths ?? true;
    this.#refreshSprings();
    this.#refreshArrows();
    this.draw();
  }

  #refreshSprings() {
    for (const { ends, object } of this.springs) {
      const [start, end] = ends.map((place) => new Vector3(...pointOf(this.poses, place.body, place.position)));
      const along = end.clone().sub(start);
      const length = along.length();
      object.visible = (this.shown.springs ?? true) && length > 0;
      if (!object.visible) continue;
      const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), along.divideScalar(length));
      const radius = Math.min(0.025 * this.scene.size, 0.15 * length);
      object.matrix = new Matrix4().compose(start, turn, new Vector3(radius, radius, length));
      object.matrixWorldNeedsUpdate = true;
    }
  }

  #refreshArrows() {
    const longest = 0.3 * this.scene.size;
    const gravity = Math.hypot(...this.scene.gravity);
    const heaviest = Math.max(...this.scene.bodies.map((body) => body.mass));
    for (const { number, body, arrow } of this.weights) {
      const share = gravity ? body.mass / heaviest : 0;
      this.#point(arrow, number, body.center, this.scene.gravity, share * longest, this.shown.weights ?? false);
    }
    const { forces = [], largest = 0 } = this.forces ?? {};
    forces.forEach((one, i) => {
      const share = largest ? Math.hypot(...one.force) / largest : 0;
      const vector = one.rotation ? turned(this.poses, one.body, one.rotation, one.force) : one.force;
      this.#point(this.forceArrows[i], one.body, one.position, vector, share * longest, this.shown.forces ?? true);
    });
  }

  #point(arrow, body, position, vector, length, isShown) {
    arrow.visible = isShown && length > 1e-6 * this.scene.size;
    if (!arrow.visible) return;
    arrow.set(pointOf(this.poses, body, position), vector, length, 0.006 * this.scene.size);
  }

  #refreshLabels() {
    const { clientWidth: width, clientHeight: height } = this.element;
    const taken = []; // corners and widths of the names above which the next ones move
    for (const { place, tag } of this.labels) {
      const spot = new Vector3(...pointOf(this.poses, place.body, place.position)).project(this.camera);
      tag.hidden = !(this.shown.names ?? false) || spot.z > 1;
      if (tag.hidden) continue;
      const label = { left: ((spot.x + 1) * width) / 2, top: ((1 - spot.y) * height) / 2, width: tag.offsetWidth, height: tag.offsetHeight };
      liftOver(label, taken);
      taken.push(label);
      tag.style.transform = `translate(${label.left}px, ${label.top}px)`;
    }
  }
}

// Moves a label up until it covers none of those that are placed; each of them lifts it at most once.
function liftOver(label, placed) {
  const byHeight = placed.toSorted((one, other) => other.top - one.top);
  for (const { left, top, width, height } of byHeight) {
    const isBeside = label.left >= left + width || left >= label.left + label.width;
    if (!isBeside && label.top < top + height && top < label.top + label.height) label.top = top - label.height;
  }
}

// Ellipsoids, lines and joints stand in for geometry that a body lacks, and are shown beside it when asked for.
function isShown({ userData: { role, standsIn } }, shown) {
  if (role === "geometry") return shown.geometry ?? true;
  const group = role === "inertia" ? "inertia" : "joints";
  return shown[group] ?? standsIn;
}

/** Returns the lines of a square grid that fade towards its rim; each cell has its own segments. */
function gridOf(step, color, background) {
  const positions = [];
  const colors = [];
  const add = (i, j) => {
    positions.push(i * step, j * step, 0);
    const faded = color.clone().lerp(background, Math.min(1, Math.hypot(i, j) / CELLS) ** 1.5);
    colors.push(faded.r, faded.g, faded.b);
  };
  for (let i = -CELLS; i <= CELLS; i++) {
    for (let j = -CELLS; j < CELLS; j++) {
      if (Math.hypot(i, j) >= CELLS) continue;
      add(i, j), add(i, j + 1);
      add(j, i), add(j + 1, i);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colors, 3));
  return new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
}

function lengthOf(box) {
  return box.getSize(new Vector3()).length();
}

function upward(gravity) {
  const up = new Vector3(...gravity).negate();
  return up.length() > 0 ? up.normalize() : new Vector3(0, 0, 1);
}

function toUp(up) {
  return new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), up);
}

function corners({ min, max }) {
  return [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
}

/** Returns 1, 2 or 5 times a power of ten near a length. */
export function niceStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  const share = length / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}
