// Positions and orientations of all bodies from {x}, by one walk over the tree from the ground outward.
//
// A pose is twelve numbers: the rotation from components of the body to inertial ones by rows, then the origin (m).

/** Numbers of a pose. */
export const POSE = 12;

/**
 * Returns the poses of the ground and of all bodies, (N + 1) times twelve numbers.
 *
 * @param {object} scene Scene as `Scene.as_table` makes it.
 * @param {ArrayLike<number>} x Coordinates {x} (rad, m, 1).
 * @param {ArrayLike<number>} prescribed Values of the prescribed freedoms (rad, m).
 * @param {Float64Array} [into] Array that is filled and returned.
 */
export function poses(scene, x, prescribed = [], into = new Float64Array(POSE * scene.bodies.length)) {
  const values = freedoms(scene, x, prescribed);
  into.set([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0], 0);
  for (let k = 1; k < scene.bodies.length; k++) {
    const joint = scene.bodies[k].joint;
    const [a, b, c, ...s] = values.slice(6 * (k - 1), 6 * k);
    const lower = into.subarray(POSE * joint.lower, POSE * (joint.lower + 1));
    const slid = apply(joint.orientation, s);
    const arm = apply(lower, joint.position.map((value, i) => value + slid[i]));
    const turned = joint.quaternion
      ? ofQuaternion(joint.quaternion.map((place) => x[place]))
      : [a, b, c].reduce((matrix, angle, i) => (angle ? product(matrix, turn(joint.axes[i], angle)) : matrix), UNIT);
    into.set(product(product(lower, joint.orientation), turned), POSE * k);
    into.set(arm.map((value, i) => lower[9 + i] + value), POSE * k + 9);
  }
  return into;
}

/** Returns the inertial coordinates of a point that is fixed in a body (m). */
export function pointOf(all, body, position) {
  const pose = all.subarray(POSE * body, POSE * (body + 1));
  return apply(pose, position).map((value, i) => value + pose[9 + i]);
}

/** Returns the inertial components of a vector, from those in a frame whose `rotation` takes them to the body's. */
export function turned(all, body, rotation, vector) {
  return apply(all.subarray(POSE * body, POSE * (body + 1)), apply(rotation, vector));
}

/** Returns the 6N values of the freedoms: three angles and three translations a body. */
function freedoms(scene, x, prescribed) {
  const values = new Array(6 * (scene.bodies.length - 1)).fill(undefined);
  const value = (k, index) => {
    const place = 6 * (k - 1) + index;
    if (values[place] === undefined) {
      const source = scene.bodies[k].joint.freedoms[index];
      values[place] = typeof source === "number" ? source : ofSource(source, x, prescribed, value);
    }
    return values[place];
  };
  for (let place = 0; place < values.length; place++) value(1 + Math.floor(place / 6), place % 6);
  return values;
}

function ofSource(source, x, prescribed, value) {
  if ("x" in source) return x[source.x];
  if ("prescribed" in source) return prescribed[source.prescribed] ?? 0;
  return source.terms.reduce((sum, [body, index, factor]) => sum + factor * value(body, index), source.offset);
}

const UNIT = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** Returns the matrix that turns a vector about a basis vector by an angle (rad). */
function turn(axis, angle) {
  const [j, k] = [(axis + 1) % 3, (axis + 2) % 3];
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  const matrix = new Array(9).fill(0);
  matrix[4 * axis] = 1;
  matrix[4 * j] = matrix[4 * k] = cosine;
  matrix[3 * k + j] = sine;
  matrix[3 * j + k] = -sine;
  return matrix;
}

/** Returns the matrix of Euler parameters of any length; no turn where all of them are zero. */
function ofQuaternion([w, x, y, z]) {
  const squares = w * w + x * x + y * y + z * z;
  if (!(squares > 0)) return UNIT;
  const t = 2 / squares;
  return [
    1 - t * (y * y + z * z), t * (x * y - w * z), t * (x * z + w * y),
    t * (x * y + w * z), 1 - t * (x * x + z * z), t * (y * z - w * x),
    t * (x * z - w * y), t * (y * z + w * x), 1 - t * (x * x + y * y),
  ];
}

function product(a, b) {
  const c = new Array(9);
  for (let i = 0; i < 3; i++) {
    for (let j = 0; j < 3; j++) c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
  }
  return c;
}

function apply(a, v) {
  return [0, 3, 6].map((i) => a[i] * v[0] + a[i + 1] * v[1] + a[i + 2] * v[2]);
}
