// The functions of one module of WebAssembly, with their arrays in its memory.

/** Typed arrays of numbers by the precision of an array, and how many of them make a number. */
const NUMBERS = { double: [Float64Array, 1], float: [Float32Array, 1], "double-double": [Float64Array, 2] };

const ALIGNMENT = 16; // bytes
const PAGE_BYTES = 65536;

/** Returns the bytes behind base64 of a stream compressed by zlib. */
async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Functions in WebAssembly. `arrays` holds inputs and outputs by name; `calls` runs a function and returns its status. */
class Evaluator {
  /** Compiles a module: its code in base64, and its functions with names, sizes and precisions of their arrays. */
  static async of({ code, functions }) {
    const { instance } = await WebAssembly.instantiate(await inflated(code));
    return new Evaluator(instance.exports, functions);
  }

  constructor(exports, functions) {
    const { memory, __heap_base } = exports;
    const places = new Map();
    let free = __heap_base.value;
    for (const { name, size, precision } of functions.flatMap((one) => [...one.inputs, ...one.outputs])) {
      if (places.has(name)) continue;
      const [Numbers, parts] = NUMBERS[precision];
      free = Math.ceil(free / ALIGNMENT) * ALIGNMENT;
      places.set(name, { address: free, Numbers, count: size * parts, parts });
      free += size * parts * Numbers.BYTES_PER_ELEMENT;
    }
    const missing = free - memory.buffer.byteLength;
    if (missing > 0) memory.grow(Math.ceil(missing / PAGE_BYTES));
    this.arrays = {};
    this.parts = {};
    for (const [name, { address, Numbers, count, parts }] of places) {
      this.arrays[name] = new Numbers(memory.buffer, address, count);
      this.parts[name] = parts;
    }
    this.calls = {};
    for (const { name, symbol, inputs, outputs } of functions) {
      const addresses = [...inputs, ...outputs].map((array) => places.get(array.name).address);
      this.calls[name] = () => exports[symbol](...addresses);
    }
  }

  /** Sets an array to doubles; the low parts of pairs become zero. */
  set(name, values) {
    const [array, parts] = [this.arrays[name], this.parts[name]];
    for (let i = 0; i < array.length; i++) array[i] = i % parts ? 0 : values[i / parts];
  }

  /** Returns an array as doubles, without the low parts of pairs. */
  get(name) {
    const [array, parts] = [this.arrays[name], this.parts[name]];
    return Float64Array.from({ length: array.length / parts }, (_, i) => array[i * parts]);
  }

  /** Computes what depends on parameters alone, and returns the status. */
  prepare(parameters) {
    if (!this.calls.prepare) return 0;
    this.set("parameters", parameters);
    return this.calls.prepare();
  }
}
