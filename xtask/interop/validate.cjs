// The Khronos validator on a GLB file: `node validate.cjs FILE VERTICES TRIANGLES`, in the folder of node_modules.
"use strict";
const fs = require("node:fs");
const { validateBytes } = require(`${process.cwd()}/node_modules/gltf-validator`);

const [file, vertices, triangles] = process.argv.slice(2);
const expect = (what, found, wanted) => {
  if (String(found) !== String(wanted)) throw new Error(`${file}: ${what} is ${found}, not ${wanted}`);
};

validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 })
  .then(({ issues, info, mimeType }) => {
    issues.messages.forEach((m) => console.log(`${m.code} at ${m.pointer}: ${m.message}`));
    expect("the number of errors", issues.numErrors, 0);
    expect("the number of warnings", issues.numWarnings, 0);
    expect("the kind of file", mimeType, "model/gltf-binary");
    expect("the number of vertices", info.totalVertexCount, vertices);
    expect("the number of triangles", info.totalTriangleCount, triangles);
    console.log(`${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos`);
  })
  .catch((error) => {
    console.error(error.message);
    process.exitCode = 1;
  });
