// Arrays of the document: numbers of 64 bits in base64, with their shape.

/** A packed array as {shape, values}, its values one after the other. */
export function unpack(packed) {
  const text = atob(packed.float64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) bytes[i] = text.charCodeAt(i);
  const view = new DataView(bytes.buffer);
  const values = new Float64Array(bytes.length / 8);
  for (let i = 0; i < values.length; i += 1) values[i] = view.getFloat64(8 * i, true);
  return { shape: packed.shape, values };
}

/** The rows of a packed array of two dimensions. */
export function unpackRows(packed) {
  const { shape, values } = unpack(packed);
  const [count, width] = shape;
  const rows = [];
  for (let i = 0; i < count; i += 1) rows.push(values.slice(i * width, (i + 1) * width));
  return rows;
}
