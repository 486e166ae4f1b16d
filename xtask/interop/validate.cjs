// The Khronos validator on GLB files: `node validate.cjs VERTICES TRIANGLES STILL MOVING`, in the folder of node_modules. The second has
// one animation of morph targets.
"use strict";
const fs = require("node:fs");
const { validateBytes } = require(`${process.cwd()}/node_modules/gltf-validator`);

const [vertices, triangles, still, moving] = process.argv.slice(2);

async function validate(file, animations) {
  const expect = (what, found, wanted) => {
    if (String(found) !== String(wanted)) throw new Error(`${file}: ${what} is ${found}, not ${wanted}`);
  };
  const bytes = new Uint8Array(fs.readFileSync(file));
  const { issues, info, mimeType } = await validateBytes(bytes, { maxIssues: 20 });
  issues.messages.forEach((m) => console.log(`${m.code} at ${m.pointer}: ${m.message}`));
  expect("the number of errors", issues.numErrors, 0);
  expect("the number of warnings", issues.numWarnings, 0);
  expect("the kind of file", mimeType, "model/gltf-binary");
  expect("the number of vertices", info.totalVertexCount, vertices);
  expect("the number of triangles", info.totalTriangleCount, triangles);
  expect("the number of animations", info.animationCount, animations);
  expect("whether there are morph targets", info.hasMorphTargets, animations > 0);
  return `${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos`;
}

(async () => console.log(`still ${await validate(still, 0)}; moving ${await validate(moving, 1)}`))().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
});
