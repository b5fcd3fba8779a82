// Equations as a list of operations, with exact derivatives, as in bifurc/core/tape.hpp.

// What an operation makes of its operands {value, by}, `by` being the derivatives by the unknowns, and of a constant c:
// its value, and the derivatives of that by its operands.
const OPERATIONS = {
  add: (a, b) => [a + b, 1, 1],
  subtract: (a, b) => [a - b, 1, -1],
  multiply: (a, b) => [a * b, b, a],
  divide: (a, b) => [a / b, 1 / b, -a / (b * b)],
  shift: (a, _, c) => [a + c, 1, 0],
  scale: (a, _, c) => [a * c, c, 0],
  over: (a, _, c) => [a / c, 1 / c, 0],
  sin: (a) => [Math.sin(a), Math.cos(a), 0],
  cos: (a) => [Math.cos(a), -Math.sin(a), 0],
};

/** The columns of F', each of m numbers, of a tape of linkages/links/motion_document.py at unknowns `u`. */
export function jacobianColumns({ operations, left, right, constants, outputs }, u) {
  const n = u.length;
  const values = [];
  const rates = [];
  operations.forEach((operation, slot) => {
    const rate = new Float64Array(n);
    rates.push(rate);
    if (operation === "unknown") {
      values.push(u[left[slot]]);
      rate[left[slot]] = 1;
    } else if (operation === "constant") {
      values.push(constants[slot]);
    } else {
      const [a, b] = [left[slot], right[slot]];
      const [value, byLeft, byRight] = OPERATIONS[operation](values[a], values[b], constants[slot]);
      values.push(value);
      for (let k = 0; k < n; k += 1) rate[k] = byLeft * rates[a][k] + (byRight ? byRight * rates[b][k] : 0);
    }
  });
  return Array.from({ length: n }, (_, k) => outputs.map((slot) => rates[slot][k]));
}
