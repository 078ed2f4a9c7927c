// Bundle source.js with three.js into ../player3d.js, which carries a digest of its source: a test compares the two.
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { build } from "esbuild";

const digest = createHash("sha256").update(readFileSync("source.js")).digest("hex").slice(0, 16);
await build({ entryPoints: ["source.js"], bundle: true, minify: true, format: "iife", legalComments: "eof", outfile: "../player3d.js",
  banner: { js: `// made from player3d/source.js ${digest} by npm run build` } });
