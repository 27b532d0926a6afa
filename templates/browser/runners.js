// Motions in steps: by the C of a variant, and by the reference, the classical Runge-Kutta method in pairs of doubles.

/** A motion whose steps are made by a function of a module, such as "step_rk4". */
class Runner {
  constructor(evaluator, step) {
    this.evaluator = evaluator;
    this.makeStep = evaluator.calls[step];
  }

  /** Puts the motion at its start and returns whether there is one: the parameters may be those of no model. */
  start(parameters, x, y) {
    this.steps = 0;
    this.stopped = this.evaluator.prepare(parameters) ? { steps: 0, status: 0 } : null;
    this.evaluator.set("x", x);
    this.evaluator.set("y", y);
  }

  /** Makes steps of a length (s) until one has no result. */
  advance(count, length) {
    const { arrays } = this.evaluator;
    arrays.step[0] = length;
    for (let i = 0; i < count && !this.stopped; i++) {
      if (arrays.t) arrays.t[0] = this.steps * length;
      const status = this.makeStep();
      if (status > 0) {
        this.stopped = { steps: this.steps, status };
        return;
      }
      arrays.x.set(arrays.x_next);
      arrays.y.set(arrays.y_next);
      this.steps++;
    }
  }

  /** The coordinates as doubles. */
  get x() {
    return this.evaluator.get("x");
  }

  /** The speeds as doubles. */
  get y() {
    return this.evaluator.get("y");
  }
}

/**
 * The motion that others are compared with: rates by a module in double-double arithmetic, and sums of steps here.
 * Each step of the others is cut into `substeps`, so that the error of the method shows where there are several.
 */
class Reference {
  constructor(evaluator) {
    this.evaluator = evaluator;
    this.substeps = 1;
  }

  start(parameters, x, y) {
    this.steps = 0;
    this.stopped = this.evaluator.prepare(parameters) ? { steps: 0, status: 0 } : null;
    this.evaluator.set("x", x);
    this.evaluator.set("y", y);
    this.state = [this.evaluator.arrays.x.slice(), this.evaluator.arrays.y.slice()];
  }

  advance(count, length) {
    const h = length / this.substeps;
    for (let i = 0; i < count && !this.stopped; i++) {
      for (let k = 0; k < this.substeps; k++) this.#step((this.steps + k / this.substeps) * length, h);
      if (!this.stopped) this.steps++;
    }
  }

  get x() {
    return this.state[0].filter((_, i) => i % 2 === 0);
  }

  get y() {
    return this.state[1].filter((_, i) => i % 2 === 0);
  }

  #step(time, h) {
    const [start, stage] = [this.state, this.state.map((one) => one.slice())];
    const sum = this.#rates(start, time).map((one) => one.slice());
    const add = (weight, share, at) => {
      stage.forEach((one, i) => addScaled(one, start[i], share * h, this.rates[i]));
      this.#rates(stage, at).forEach((one, i) => addScaled(sum[i], sum[i], weight, one));
    };
    add(2, 0.5, time + h / 2);
    add(2, 0.5, time + h / 2);
    add(1, 1, time + h);
    if (this.stopped) return;
    start.forEach((one, i) => addScaled(one, one, h, sixth(sum[i])));
  }

  #rates([x, y], time) {
    const { arrays, calls } = this.evaluator;
    arrays.x.set(x);
    arrays.y.set(y);
    if (arrays.t) arrays.t[0] = time;
    const statuses = [calls.forward_dynamics(), calls.coordinate_rates?.() ?? 0];
    const status = Math.max(...statuses);
    if (status > 0) this.stopped ??= { steps: this.steps, status };
    this.rates = [arrays.xdot ?? arrays.y, arrays.acceleration].map((one) => one.slice());
    return this.rates;
  }
}
