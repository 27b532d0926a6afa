// Errors over time on a logarithmic axis, a line for each variant.

const DECADES = [-18, 1]; // powers of ten at the ends of the axis
const MOST_TIMES = 1200; // of a longer motion every second time is left out, again and again

/** A chart on a canvas that keeps what it is given. */
class Chart {
  constructor(colors) {
    this.colors = colors;
    this.canvas = kanegenViewer.make("canvas", { class: "kw-chart", role: "img", "aria-label": "Errors over time" });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.clear();
  }

  clear() {
    this.times = [];
    this.rows = this.colors.map(() => []);
    this.every = 1;
    this.skipped = 0;
    this.draw();
  }

  /** Adds the errors at a time. */
  add(time, errors) {
    if (++this.skipped < this.every) return;
    this.skipped = 0;
    this.times.push(time);
    errors.forEach((value, i) => this.rows[i].push(value));
    if (this.times.length > MOST_TIMES) {
      const isKept = (_, i) => i % 2 === 0;
      this.times = this.times.filter(isKept);
      this.rows = this.rows.map((row) => row.filter(isKept));
      this.every *= 2;
    }
    this.draw();
  }

  draw() {
    const { canvas } = this;
    const scale = window.devicePixelRatio;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    canvas.width = width * scale;
    canvas.height = height * scale;
    const context = canvas.getContext("2d");
    context.scale(scale, scale);
    const style = getComputedStyle(canvas);
    const box = { left: 42, top: 8, width: width - 50, height: height - 28 };
    const end = Math.max(1, this.times.at(-1) ?? 0);
    const y = (power) => box.top + (box.height * (DECADES[1] - power)) / (DECADES[1] - DECADES[0]);
    const x = (time) => box.left + (box.width * time) / end;
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = style.getPropertyValue("--faint");
    context.strokeStyle = style.getPropertyValue("--line");
    context.textAlign = "right";
    for (let power = DECADES[0]; power <= DECADES[1]; power += 3) {
      line(context, box.left, y(power), box.left + box.width, y(power));
      context.fillText(`1e${power}`, box.left - 5, y(power) + 4);
    }
    context.textAlign = "center";
    const step = niceStep(end / 4);
    for (let time = 0; time <= end * (1 + 1e-9); time += step) context.fillText(`${Number(time.toPrecision(6))} s`, Math.min(x(time), width - 14), height - 6);
    this.rows.forEach((row, i) => this.#curve(context, row, this.colors[i], x, y));
  }

  #curve(context, row, color, x, y) {
    context.strokeStyle = color;
    context.lineWidth = 1.6;
    context.beginPath();
    row.forEach((value, i) => {
      if (!Number.isFinite(value)) return;
      const power = Math.min(DECADES[1], Math.max(DECADES[0], value > 0 ? Math.log10(value) : DECADES[0]));
      context.lineTo(x(this.times[i]), y(power));
    });
    context.stroke();
  }
}

function line(context, x1, y1, x2, y2) {
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(x1, Math.round(y1) + 0.5);
  context.lineTo(x2, Math.round(y2) + 0.5);
  context.stroke();
}

/** Returns 1, 2 or 5 times a power of ten, at least a length. */
function niceStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * ([1, 2, 5, 10].find((one) => one * power >= length) ?? 10);
}
