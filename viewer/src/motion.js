// Coordinates over time, and the state between two times.

/** Decodes little-endian numbers of a type such as Float32Array from base64. */
export function decode(text, Type) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  return new Type(bytes.buffer);
}

/** Coordinates over time as a page holds them. */
export class Motion {
  constructor(scene, data) {
    this.times = decode(data.times, Float64Array);
    this.rows = [rowsOf(data.x, this.times.length), rowsOf(data.prescribed, this.times.length)];
    this.quaternions = scene.bodies.flatMap((body) => (body.joint?.quaternion ? [body.joint.quaternion] : []));
    this.series = data.series.map((one) => ({ ...one, values: decode(one.values, Float64Array) }));
    this.forces = data.forces.map((one) => ({ ...one, values: decode(one.values, Float32Array) }));
    this.start = this.times[0];
    this.end = this.times[this.times.length - 1];
  }

  /** Returns the last time that is not after `time`, as its place, and the share of the way to the next. */
  at(time) {
    let [low, high] = [0, this.times.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle;
    }
    const span = this.times[high] - this.times[low];
    return [low, span > 0 ? Math.min(1, Math.max(0, (time - this.times[low]) / span)) : 0];
  }

  /** Returns {x} and the prescribed values at a time, interpolated between the two times beside it. */
  state(time) {
    const [place, share] = this.at(time);
    const [x, prescribed] = this.rows.map((rows) => blend(rows, place, share));
    for (const places of this.quaternions) this.#shortest(x, places, place, share);
    return [x, prescribed];
  }

  /** Returns the three components of forces at a time. */
  force(one, time) {
    const [place, share] = this.at(time);
    return blend({ width: 3, values: one.values, count: this.times.length }, place, share);
  }

  // A quaternion and its negative are one orientation: take the shorter way between two times.
  #shortest(x, places, place, share) {
    const { width, values, count } = this.rows[0];
    const next = Math.min(place + 1, count - 1);
    const [a, b] = [place, next].map((row) => places.map((one) => values[width * row + one]));
    const sign = a.reduce((sum, value, i) => sum + value * b[i], 0) < 0 ? -1 : 1;
    places.forEach((one, i) => (x[one] = (1 - share) * a[i] + share * sign * b[i]));
  }
}

function rowsOf(text, count) {
  const values = decode(text, Float64Array);
  return { width: values.length / count, values, count };
}

function blend({ width, values, count }, place, share) {
  const next = Math.min(place + 1, count - 1);
  return Array.from({ length: width }, (_, i) => {
    const [a, b] = [values[width * place + i], values[width * next + i]];
    return a + share * (b - a);
  });
}
