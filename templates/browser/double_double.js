// Sums and products of pairs of doubles, the exact sum of which is one number (Dekker 1971; Knuth 1998, section 4.2.2).

const SPLITTER = 134217729; // 2^27 + 1

/** Sets each number of `into` to that of `base` plus a double times that of `other`; arrays of pairs. */
function addScaled(into, base, factor, other) {
  for (let i = 0; i < into.length; i += 2) {
    const product = factor * other[i];
    const rest = error(factor, other[i], product) + factor * other[i + 1];
    const sum = base[i] + product;
    const part = sum - base[i];
    const lost = base[i] - (sum - part) + (product - part);
    setPair(into, i, sum, lost + (base[i + 1] + rest));
  }
}

/** Returns a sixth of each number of an array of pairs. */
function sixth(numbers) {
  const found = new Float64Array(numbers.length);
  for (let i = 0; i < numbers.length; i += 2) {
    const quotient = numbers[i] / 6;
    const product = 6 * quotient;
    const rest = numbers[i] - product - error(6, quotient, product) + numbers[i + 1];
    setPair(found, i, quotient, rest / 6);
  }
  return found;
}

function setPair(into, i, high, low) {
  const sum = high + low;
  into[i + 1] = low - (sum - high);
  into[i] = sum;
}

/** Returns what rounding took from the product of two doubles. */
function error(a, b, product) {
  const [a1, b1] = [a, b].map((one) => SPLITTER * one - (SPLITTER * one - one));
  const [a2, b2] = [a - a1, b - b1];
  return a2 * b2 - (product - a1 * b1 - a2 * b1 - a1 * b2);
}
