// Singular values of a small matrix by one-sided Jacobi rotations (Hestenes 1958): small ones come out to the last
// digits, too.

const SWEEPS = 30;
const ORTHOGONAL = 1e-15;

/** The singular values, largest first, of the matrix with these columns; as many as there are columns, zeros last. */
export function singularValues(columns) {
  if (!columns.length || !columns[0].length) return columns.map(() => 0);
  const rows = columns.length > columns[0].length ? transposed(columns) : columns.map((column) => [...column]);
  for (let sweep = 0; sweep < SWEEPS; sweep += 1) {
    if (!orthogonalised(rows)) break;
  }
  const values = rows.map((row) => Math.sqrt(dot(row, row))).sort((a, b) => b - a);
  while (values.length < columns.length) values.push(0);
  return values;
}

/** Whether a sweep of rotations over all pairs of vectors changed any. */
function orthogonalised(vectors) {
  let rotated = false;
  for (let i = 0; i < vectors.length; i += 1) {
    for (let j = i + 1; j < vectors.length; j += 1) {
      rotated = rotatePair(vectors[i], vectors[j]) || rotated;
    }
  }
  return rotated;
}

function rotatePair(a, b) {
  const aa = dot(a, a);
  const bb = dot(b, b);
  const ab = dot(a, b);
  if (Math.abs(ab) <= ORTHOGONAL * Math.sqrt(aa * bb)) return false;
  const zeta = (bb - aa) / (2 * ab);
  const t = (zeta < 0 ? -1 : 1) / (Math.abs(zeta) + Math.sqrt(1 + zeta * zeta));
  const c = 1 / Math.sqrt(1 + t * t);
  const s = c * t;
  for (let k = 0; k < a.length; k += 1) {
    const x = a[k];
    a[k] = c * x - s * b[k];
    b[k] = s * x + c * b[k];
  }
  return true;
}

function transposed(columns) {
  return columns[0].map((_, k) => columns.map((column) => column[k]));
}

function dot(a, b) {
  let sum = 0;
  for (let k = 0; k < a.length; k += 1) sum += a[k] * b[k];
  return sum;
}
