// Positions of bodies by the C of a module, what parameters change of the picture, and distances between positions.

const NUMBERS_OF_A_POSE = 12; // the rotation from components of the body to inertial ones by rows, then the origin (m)

/** Computes poses, energies, and mass centres and joints of bodies, by a module in double precision. */
class Mechanism {
  constructor(evaluator, formulation) {
    this.evaluator = evaluator;
    this.scene = formulation.scene;
    this.places = formulation.places;
  }

  /** Sets the parameters, and changes the scene to the lengths that follow from them. */
  prepare(parameters, x) {
    if (this.evaluator.prepare(parameters) || !this.places.length) return;
    const all = this.poses(x);
    this.evaluator.calls.point_positions();
    const points = this.evaluator.arrays.point_positions;
    this.places.forEach(({ body, kind, of, row }) => {
      const place = inBody(all, body, points.subarray(3 * row, 3 * row + 3));
      const before = kind === "center" ? this.scene.bodies[body].center : this.scene.bodies[of].joint.position;
      this.scene.bodies[body].shapes.forEach((shape) => moveShape(shape, before, place));
      if (kind === "center") this.scene.bodies[body].center = place;
      else this.scene.bodies[of].joint.position = place;
    });
  }

  /** Returns the poses of the ground and of all bodies. */
  poses(x) {
    const { arrays, calls } = this.evaluator;
    arrays.x.set(x);
    calls.body_poses();
    const found = new Float64Array(NUMBERS_OF_A_POSE * this.scene.bodies.length);
    found.set([1, 0, 0, 0, 1, 0, 0, 0, 1]);
    for (let k = 1; k < this.scene.bodies.length; k++) {
      const rows = arrays.body_poses.subarray(NUMBERS_OF_A_POSE * (k - 1), NUMBERS_OF_A_POSE * k);
      for (let i = 0; i < 9; i++) found[NUMBERS_OF_A_POSE * k + i] = rows[3 * (i % 3) + Math.floor(i / 3)];
      found.set(rows.subarray(9), NUMBERS_OF_A_POSE * k + 9);
    }
    return found;
  }

  /** Returns the energy (J), NaN where forces have none. */
  energy(x, y) {
    const { arrays, calls } = this.evaluator;
    if (!calls.potential_energy) return NaN;
    arrays.x.set(x);
    arrays.y.set(y);
    calls.kinetic_energy();
    calls.potential_energy();
    return arrays.kinetic_energy[0] + arrays.potential_energy[0];
  }
}

/** Returns the largest angle (rad) or distance (m) between the bodies of two mechanisms in their poses. */
function distance(poses, others) {
  let largest = 0;
  for (let k = NUMBERS_OF_A_POSE; k < poses.length; k += NUMBERS_OF_A_POSE) {
    let [turn, way] = [0, 0];
    for (let i = 0; i < 9; i++) turn += (poses[k + i] - others[k + i]) ** 2;
    for (let i = 9; i < 12; i++) way += (poses[k + i] - others[k + i]) ** 2;
    largest = Math.max(largest, 2 * Math.asin(Math.min(1, Math.sqrt(turn / 8))), Math.sqrt(way));
    if (Number.isNaN(turn + way)) return NaN;
  }
  return largest;
}

/** Returns the components in a body of a point in the inertial frame (m). */
function inBody(all, body, point) {
  const pose = all.subarray(NUMBERS_OF_A_POSE * body, NUMBERS_OF_A_POSE * (body + 1));
  const arm = [0, 1, 2].map((i) => point[i] - pose[9 + i]);
  return [0, 1, 2].map((i) => pose[i] * arm[0] + pose[3 + i] * arm[1] + pose[6 + i] * arm[2]);
}

/** Moves what is drawn at a point of a body, or along the line from its origin to that point. */
function moveShape(shape, before, after) {
  const isAt = (place) => shape.position.every((value, i) => Math.abs(value - place[i]) <= 1e-9 * Math.hypot(...place));
  if (!before.some(Boolean)) return;
  if (shape.role === "inertia" && isAt(before)) shape.position = after;
  if (shape.kind === "rod" && shape.role === "link" && isAt(before.map((value) => value / 2))) {
    const length = Math.hypot(...after);
    shape.size = [shape.size[0], length];
    shape.position = after.map((value) => value / 2);
    if (length > 0) shape.rotation = along(after.map((value) => value / length));
  }
}

/** Returns a rotation by rows whose third column is a unit vector. */
function along(direction) {
  const least = direction.reduce((best, value, i) => (Math.abs(value) < Math.abs(direction[best]) ? i : best), 0);
  const other = [0, 1, 2].map((i) => (i === least ? 1 : 0));
  const first = cross(other, direction);
  const length = Math.hypot(...first);
  const columns = [first.map((value) => value / length)];
  columns.push(cross(direction, columns[0]), direction);
  return [0, 1, 2].flatMap((i) => columns.map((column) => column[i]));
}

function cross(a, b) {
  return [0, 1, 2].map((i) => a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
}
