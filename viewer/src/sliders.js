// Sliders for all coordinates of a model without motion, and the motion that plays through their ranges.

import { make, withUnit } from "./elements.js";

/** One slider for each coordinate and each prescribed freedom. */
export class Sliders {
  constructor(scene, onChange) {
    this.scene = scene;
    this.onChange = onChange;
    this.all = [...scene.coordinates, ...scene.prescribed];
    this.start = [...scene.start, ...scene.prescribed.map(() => 0)];
    this.rows = this.all.map((one, i) => this.#row(one, this.start[i]));
    const reset = make("button", { type: "button", class: "kg-quiet", onclick: () => this.reset() }, "Reset");
    const title = make("div", { class: "kg-heading" }, make("h2", {}, "Positions"), reset);
    this.element = make("section", { "aria-label": "Positions of all freedoms" }, title, ...this.rows.map((row) => row.element));
  }

  #row(one, value) {
    const [lower, upper] = [Math.min(one.lower, value), Math.max(one.upper, value)];
    const input = make("input", { type: "range", min: lower, max: upper, step: "any", "aria-label": `${one.name}, ${one.unit}` });
    input.value = value;
    const output = make("output", {}, withUnit(value, one.unit));
    const kind = this.scene.prescribed.includes(one) ? ", prescribed" : "";
    const title = `${one.name}${kind}${one.is_limited ? ": limits of the model" : ""}`;
    const name = make("span", { class: "kg-name", title }, `${one.name}${kind}`);
    const row = { one, input, output, element: make("label", { class: "kg-slider" }, name, output, input), value };
    input.addEventListener("input", () => {
      this.#write(row, Number(input.value));
      this.onChange();
    });
    return row;
  }

  #write(row, value) {
    row.value = value;
    row.output.textContent = withUnit(value, row.one.unit);
  }

  /** Puts all coordinates back where they began. */
  reset() {
    this.set(this.start);
  }

  /** Sets all values, {x} and then the prescribed ones. */
  set(values) {
    this.rows.forEach((row, i) => {
      this.#write(row, values[i]);
      row.input.value = values[i];
    });
    this.onChange();
  }

  /** Returns {x} and the prescribed values. */
  state() {
    const values = this.rows.map((row) => row.value);
    return [values.slice(0, this.scene.coordinates.length), values.slice(this.scene.coordinates.length)];
  }

  /** Moves every coordinate through a part of its range, each with its own period; at time 0 all are at their start. */
  wave(time) {
    const values = this.all.map((one, i) => {
      const start = this.start[i];
      const swing = Math.sin((2 * Math.PI * time) / (5 + 1.7 * (i % 4)));
      const room = swing > 0 ? one.upper - start : start - one.lower;
      const share = one.is_limited ? 0.8 : one.unit === "m" ? 0.3 : 0.25;
      return start + share * Math.max(0, room) * swing;
    });
    this.set(values);
  }
}
