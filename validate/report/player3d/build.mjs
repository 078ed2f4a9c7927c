// Bundle source.js and ../player.js with three.js into ../player3d.js, which carries a digest of both: a test compares them.
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { build } from "esbuild";

const digest = createHash("sha256").update(readFileSync("source.js")).update(readFileSync("../player.js")).digest("hex").slice(0, 16);
await build({ entryPoints: ["source.js"], bundle: true, minify: true, format: "iife", legalComments: "eof", outfile: "../player3d.js",
  banner: { js: `// made from player3d/source.js ${digest} by npm run build` } });
