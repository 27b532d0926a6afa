// The page: pictures, the clock, errors beside the reference, and sliders for the start and the parameters.

const { addStyle, make, icon, withUnit, Stage, CAMERAS } = kanegenViewer;

const SPEEDS = [0.1, 0.25, 0.5, 1, 2];
const STEPS = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2];
const BUDGET = 14; // time for steps between two pictures (ms)
const CHUNK = 4; // steps between two looks at the clock
const MEASURED = 4; // time of a measurement of evaluations (ms)
const PAUSE = 700; // time between two such measurements (ms)
const KEPT = 4; // measurements of which the fastest is shown: others are disturbed by what else runs
const AHEAD = [2, 5e-3, 40]; // length of the motion that pictures make room for (s), its steps (s), states of it
const COLORS = ["#2f6fde", "#e8590c", "#2b9348", "#b5179e", "#8d6e00"];

/** Makes the page of `data` in an element, and resolves once its modules are compiled. */
async function page(root, data) {
  const evaluators = await Promise.all(data.modules.map((one) => Evaluator.of(one)));
  return new Page(root, data, evaluators);
}

class Page {
  constructor(root, data, evaluators) {
    addStyle();
    root.classList.add("kg", "kw");
    Object.assign(this, { root, data, isPlaying: false, speed: 1, length: data.step, time: 0 });
    this.mechanisms = data.formulations.map((one) => new Mechanism(evaluators[one.module], one));
    this.competitors = data.competitors.map((one, i) => ({
      ...one, color: COLORS[i % COLORS.length], evaluator: evaluators[one.module], runner: new Runner(evaluators[one.module], one.step), mechanism: this.mechanisms[one.formulation],
    }));
    this.reference = { ...data.reference, evaluator: evaluators[data.reference.module], runner: new Reference(evaluators[data.reference.module]), mechanism: this.mechanisms[data.reference.formulation] };
    this.parameters = data.parameters.map((one) => one.value);
    this.states = data.starts[0].states.map((one) => structuredClone(one));
    this.shown = 0;
    this.chart = new Chart(this.competitors.map((one) => one.color));
    this.#build();
    this.#setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
    this.#makeRoom();
    this.reset();
    this.#measure();
    root.ownerDocument.addEventListener("keydown", (event) => this.#press(event));
    if (data.play && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.play(true);
  }

  /** Starts or stops the motion. */
  play(isPlaying) {
    this.isPlaying = isPlaying;
    this.last = undefined;
    this.owed = 0;
    this.playButton.replaceChildren(icon(isPlaying ? "pause" : "play"));
    this.playButton.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
    if (isPlaying) requestAnimationFrame((now) => this.#tick(now));
  }

  /** Puts all motions at the start. */
  reset() {
    this.time = 0;
    this.steps = 0;
    this.pace = undefined;
    for (const one of [...this.competitors, this.reference]) {
      const { x, y } = this.states[one.formulation];
      one.runner.start(this.parameters, x, y);
    }
    this.mechanisms.forEach((one, i) => one.prepare(this.parameters, this.states[i].x));
    this.stages.forEach((stage) => stage.reshape());
    const { mechanism, runner } = this.reference;
    this.energy = mechanism.energy(runner.x, runner.y);
    this.chart.clear();
    this.show();
  }

  /** Makes a number of steps of all motions. */
  advance(count) {
    for (const { runner } of [...this.competitors, this.reference]) runner.advance(count, this.length);
    this.steps += count;
    this.time = this.steps * this.length;
  }

  // Cameras and grounds suit all that the motion of the reference's formulation reaches soon.
  #makeRoom() {
    const { formulation } = this.reference;
    const { runner } = this.competitors.find((one) => one.formulation === formulation);
    const { x, y } = this.states[formulation];
    const [length, step, count] = this.data.follows ? [0, 0, 0] : AHEAD;
    runner.start(this.parameters, x, y);
    const reached = [[x, []]];
    for (let i = 0; i < count && !runner.stopped; i++) {
      runner.advance(Math.round(length / step / count), step);
      if (!runner.stopped) reached.push([runner.x, []]);
    }
    const place = this.pictures.find((one) => (one.competitor === null ? 0 : this.competitors[one.competitor].formulation) === formulation);
    place.stage.include(reached);
    for (const stage of this.stages.filter((one) => one !== place.stage)) {
      stage.bounds = place.stage.bounds.clone();
      stage.setTheme(this.root.dataset.theme);
    }
    place.stage.look("corner");
    this.#align(place.stage);
  }

  #tick(now) {
    if (!this.isPlaying) return;
    const passed = this.last === undefined ? 0 : Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    this.owed += (passed * this.speed) / this.length;
    const asked = Math.floor(this.owed);
    const begin = performance.now();
    let made = 0;
    while (made < asked && performance.now() - begin < BUDGET) {
      const count = Math.min(CHUNK, asked - made);
      this.advance(count);
      made += count;
    }
    this.owed = made < asked ? 0 : this.owed - made;
    if (asked) this.pace = 0.95 * (this.pace ?? 1) + (0.05 * made) / asked;
    this.show();
    if (this.reference.runner.stopped || this.competitors.every((one) => one.runner.stopped)) this.play(false);
    else requestAnimationFrame((later) => this.#tick(later));
  }

  /** Draws the present states, and their errors. */
  show() {
    const all = this.reference.mechanism.poses(this.reference.runner.x).slice();
    const errors = this.competitors.map((one) => {
      one.poses = one.mechanism.poses(one.runner.x);
      one.error = one.runner.stopped || this.reference.runner.stopped ? NaN : distance(one.poses, all);
      return one.error;
    });
    this.chart.add(this.time, errors);
    this.pictures.forEach(({ stage, competitor }) => stage.setPoses(this.#followed(this.competitors[competitor ?? this.shown].poses)));
    const late = this.pace < 0.9 && this.isPlaying ? ` at ${(this.pace * this.speed).toFixed(2)}×` : "";
    this.clock.textContent = `${this.time.toFixed(2)} s${late}`;
    this.rows.forEach((row, i) => this.#fillRow(row, this.competitors[i]));
    this.#fillRow(this.referenceRow, this.reference);
  }

  // A tree that falls or flies freely stays in the picture: what is drawn moves along with its first body.
  #followed(poses) {
    if (!this.data.follows) return poses;
    const found = poses.slice();
    for (let k = 12; k < found.length; k += 12) {
      for (let i = 9; i < 12; i++) found[k + i] -= poses[12 + i] - (this.home?.[i - 9] ?? 0);
    }
    return found;
  }

  #fillRow(row, one) {
    const { stopped } = one.runner;
    const isReference = one === this.reference;
    const short = stopped ? (stopped.status ? `lost at ${(stopped.steps * this.length).toPrecision(3)} s` : "no such model") : isReference ? "reference" : scientific(one.error);
    row.error.textContent = short;
    row.error.title = stopped ? this.#reason(one) : "";
    row.error.classList.toggle("kw-stopped", Boolean(stopped));
    const change = one.mechanism.energy(one.runner.x, one.runner.y) - this.energy;
    row.energy.textContent = stopped || !Number.isFinite(change) ? "" : scientific(change);
    if (row.caption) {
      row.caption.textContent = stopped ? `${short}: ${this.#reason(one)}` : `error ${short}`;
      row.caption.closest("figure").classList.toggle("kw-lost", Boolean(stopped));
    }
  }

  #reason({ formulation, not_converged: notConverged, runner: { stopped } }) {
    const { freedoms } = this.data.formulations[formulation];
    if (!stopped.status) return "what depends on these parameters is not finite";
    if (stopped.status === notConverged) return "the step is too long, its iteration does not converge";
    return stopped.status <= freedoms.length ? `[A] is singular at ${freedoms[stopped.status - 1]}` : "the result is not finite";
  }

  #build() {
    const { data } = this;
    this.pictures = data.pictures.map((competitor) => ({ competitor, element: make("div", { class: "kg-stage", role: "img", tabindex: 0, "aria-label": `Picture of ${data.title}` }) }));
    const figures = this.pictures.map((one) => make("figure", {}, one.element, ...this.#caption(one)));
    const aside = make("aside", { class: "kg-panel" }, this.#header(), this.#table(), this.#starts(), this.#parameters(), this.#settings(), this.#about());
    const grid = make("div", { class: "kw-stages", style: `--count: ${figures.length}` }, ...figures);
    this.root.replaceChildren(make("main", { class: "kg-main" }, grid, this.#cameras(), this.#controls()), aside);
    for (const picture of this.pictures) {
      const { formulation } = data.competitors[picture.competitor ?? 0];
      picture.stage = new Stage(picture.element, data.formulations[formulation].scene);
    }
    this.stages = this.pictures.map((one) => one.stage);
    this.stages.forEach((stage) => stage.controls.addEventListener("change", () => this.#align(stage)));
    const { x } = this.states[0];
    this.home = this.mechanisms[0].poses(x).slice(21, 24);
  }

  #caption({ competitor }) {
    if (competitor === null) return [];
    const note = make("span", { class: "kw-note" });
    (this.captions ??= new Map()).set(competitor, note);
    return [make("figcaption", {}, make("b", { style: `color: ${this.competitors[competitor].color}` }, this.data.competitors[competitor].name), note)];
  }

  // All pictures are seen from one place.
  #align(stage) {
    for (const other of this.stages.filter((one) => one !== stage)) {
      other.camera.position.copy(stage.camera.position);
      other.controls.target.copy(stage.controls.target);
      other.camera.lookAt(stage.controls.target);
      other.draw();
    }
  }

  #header() {
    const theme = make("button", { type: "button", class: "kg-icon", title: "Light or dark (T)", "aria-label": "Light or dark", onclick: () => this.#setTheme(!this.isDark) }, icon("theme"));
    return make("header", {}, make("div", {}, make("h1", {}, this.data.title), make("p", {}, this.data.subtitle)), theme);
  }

  #cameras() {
    const look = (name) => this.stages[0].look(name);
    return make("div", { class: "kg-cameras", role: "group", "aria-label": "Camera" }, ...Object.keys(CAMERAS).map((name, i) => make("button", { type: "button", title: `Look from ${name} (${i + 1})`, onclick: () => look(name) }, name)));
  }

  #controls() {
    this.playButton = make("button", { type: "button", class: "kg-play", title: "Play or pause (space)", "aria-label": "Play", onclick: () => this.play(!this.isPlaying) }, icon("play"));
    const reset = make("button", { type: "button", class: "kg-icon", title: "Back to the start (R)", "aria-label": "Back to the start", onclick: () => this.reset() }, icon("start"));
    const step = make("button", { type: "button", class: "kg-quiet", title: "One step (right arrow)", onclick: () => this.#one() }, "one step");
    this.clock = make("output", { class: "kg-time" });
    const speed = make("select", { "aria-label": "Speed", title: "Speed", onchange: () => (this.speed = Number(speed.value)) }, ...SPEEDS.map((one) => make("option", { value: one, selected: one === 1 }, `${one}×`)));
    return make("div", { class: "kg-clock" }, this.playButton, reset, step, make("span", { class: "kw-space" }), this.clock, speed);
  }

  #one() {
    this.play(false);
    this.advance(1);
    this.show();
  }

  #table() {
    const head = make("tr", {}, ...["", "error", "evaluations/s", "ΔE, J"].map((text) => make("th", { scope: "col" }, text)));
    this.rows = this.competitors.map((one, i) => this.#row(one, i));
    this.referenceRow = this.#row({ ...this.reference, color: "transparent" });
    const body = make("tbody", {}, ...[...this.rows, this.referenceRow].map((row) => row.element));
    const title = "Error: the largest angle (rad) or distance (m) between a body and where the reference has it";
    return make("section", { "aria-label": "Errors" }, make("h2", { title }, "Error beside double-double"), make("table", { class: "kw-table", title }, make("thead", {}, head), body), this.chart.canvas);
  }

  #row({ name, text, color }, place) {
    const [error, rate, energy] = ["kw-number", "kw-number", "kw-number"].map((name) => make("td", { class: name }));
    const dot = make("span", { class: "kw-dot", style: `background: ${color}` });
    const canChoose = place !== undefined && this.data.pictures.includes(null) && this.competitors.length > 1;
    const choose = () => {
      this.shown = place;
      this.rows.forEach((row, i) => row.element.classList.toggle("kw-chosen", i === place));
      this.show();
    };
    const label = canChoose ? make("button", { type: "button", title: `${text} Show this motion in the picture.`, onclick: choose }, dot, name) : make("span", { title: text }, dot, name);
    const element = make("tr", { class: canChoose && place === 0 ? "kw-chosen" : "" }, make("th", { scope: "row" }, label), error, rate, energy);
    return { element, error, rate, energy, rates: [], caption: this.captions?.get(place) };
  }

  #starts() {
    const { starts, formulations } = this.data;
    if (starts.length > 1) {
      const select = make("select", { "aria-label": "Start", onchange: () => this.#begin(starts[select.selectedIndex].states) }, ...starts.map((one) => make("option", {}, one.name)));
      return make("section", { "aria-label": "Start" }, make("div", { class: "kg-heading" }, make("h2", {}, this.data.start_title), select));
    }
    const { scene, speeds } = formulations[0];
    const state = this.states[0];
    const rows = [
      ...scene.coordinates.map((one, i) => this.#slider(one, state.x, i)),
      ...speeds.map((one, i) => this.#slider(one, state.y, i)),
    ];
    return make("details", { open: rows.length <= 8 }, make("summary", {}, "Start"), ...rows);
  }

  #begin(states) {
    this.states = states.map((one) => structuredClone(one));
    this.reset();
  }

  #parameters() {
    const rows = this.data.parameters.map((one, i) => this.#slider(one, this.parameters, i));
    if (!rows.length) return make("span", { hidden: true });
    return make("details", { open: rows.length <= 8 }, make("summary", {}, "Parameters"), ...rows);
  }

  // A slider changes one number of an array and takes all motions back to the start.
  #slider({ name, unit, lower, upper }, values, place) {
    const [least, most] = [Math.min(lower, values[place]), Math.max(upper, values[place])];
    const input = make("input", { type: "range", min: least, max: most, step: "any", "aria-label": unit ? `${name}, ${unit}` : name });
    input.value = values[place];
    const shown = (value) => withUnit(value, unit || "1");
    const output = make("output", {}, shown(values[place]));
    input.addEventListener("input", () => {
      values[place] = Number(input.value);
      output.textContent = shown(values[place]);
      this.reset();
    });
    return make("label", { class: "kg-slider" }, make("span", { class: "kg-name", title: name }, name), output, input);
  }

  #settings() {
    const choices = [...new Set([...STEPS, this.length])].sort((a, b) => a - b);
    const step = make("select", { onchange: () => this.#set(() => (this.length = Number(step.value))) }, ...choices.map((one) => make("option", { value: one, selected: one === this.length }, `${Number((1000 * one).toPrecision(4))} ms`)));
    const texts = [[1, "equal steps: rounding"], [4, "quarter steps: method too"]];
    const runner = this.reference.runner;
    runner.substeps = this.data.reference.substeps;
    const reference = make("select", { onchange: () => this.#set(() => (runner.substeps = Number(reference.value))) }, ...texts.map(([value, text]) => make("option", { value, selected: value === runner.substeps }, text)));
    return make("section", { "aria-label": "Steps" }, make("h2", {}, "Steps"), make("label", { class: "kw-setting" }, "Runge-Kutta step", step), make("label", { class: "kw-setting" }, "Reference in", reference));
  }

  #set(change) {
    change();
    this.reset();
  }

  #about() {
    const keys = "Space plays, R goes back to the start, the right arrow makes one step, 1 to 4 set the camera, T the colours. Drag turns, wheel zooms, right button shifts.";
    return make("details", {}, make("summary", {}, "About this page"), ...[...this.data.notes, keys].map((note) => make("p", {}, note)));
  }

  #setTheme(isDark) {
    this.isDark = isDark;
    this.root.dataset.theme = isDark ? "dark" : "light";
    this.stages.forEach((stage) => stage.setTheme(this.root.dataset.theme));
    this.chart.draw();
  }

  // Counts evaluations of the rates in turn, in the state of the start, for a few milliseconds.
  #measure(turn = 0) {
    const all = [...this.competitors.map((one, i) => [one, this.rows[i]]), [this.reference, this.referenceRow]];
    const [{ evaluator, formulation }, row] = all[turn % all.length];
    const { forward_dynamics: evaluate } = evaluator.calls;
    const kept = ["x", "y"].map((name) => evaluator.arrays[name].slice());
    ["x", "y"].forEach((name) => evaluator.set(name, this.states[formulation][name]));
    let [count, passed] = [16, 0];
    while (passed < MEASURED && count < 1e7) {
      count *= 2;
      const begin = performance.now();
      for (let i = 0; i < count; i++) evaluate();
      passed = performance.now() - begin;
    }
    ["x", "y"].forEach((name, i) => evaluator.arrays[name].set(kept[i]));
    row.rates = [...row.rates, (1000 * count) / passed].slice(-KEPT);
    row.rate.textContent = readable(Math.max(...row.rates));
    setTimeout(() => this.#measure(turn + 1), turn < all.length ? 0 : PAUSE);
  }

  #press(event) {
    const isTyping = ["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName);
    if (event.ctrlKey || event.metaKey || event.altKey || (isTyping && event.target.type !== "range")) return;
    const key = event.key.toLowerCase();
    const camera = Object.keys(CAMERAS)[Number(key) - 1];
    if (key === " ") this.play(!this.isPlaying);
    else if (key === "r") this.reset();
    else if (key === "t") this.#setTheme(!this.isDark);
    else if (camera) this.stages[0].look(camera);
    else if (key === "arrowright" && !isTyping) this.#one();
    else return;
    event.preventDefault();
  }
}

/** Returns a number with two digits and a power of ten. */
function scientific(value) {
  return value === 0 ? "0" : value.toExponential(1);
}

/** Returns a number with three digits and k or M for its thousands. */
function readable(value) {
  if (value >= 1e6) return `${(value / 1e6).toPrecision(3)} M`;
  return value >= 1e3 ? `${(value / 1e3).toPrecision(3)} k` : value.toPrecision(3);
}
