// Bundles the viewer into one ES module, with the licence of three.js at its head.
//
//     node build.js [FILE]
//
// FILE is linkages/viewing/static/viewer.js where it is left out. The same sources give the same bytes.

import { build } from "esbuild";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const target = process.argv[2] ?? join(here, "../linkages/viewing/static/viewer.js");
const licence = readFileSync(join(here, "node_modules/three/LICENSE"), "utf8").trim();
const { version } = JSON.parse(readFileSync(join(here, "node_modules/three/package.json"), "utf8"));

await build({
  entryPoints: [join(here, "main.js")],
  outfile: target,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
  define: { "window.__THREE__": "undefined" }, // two widgets on a page are two three.js, which would warn of each other
  loader: { ".css": "text" },
  banner: { js: `/*! built from viewer/ by make viewer; holds parts of three.js ${version}:\n\n${licence}\n*/` },
});
