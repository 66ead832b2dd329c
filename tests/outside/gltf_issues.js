// Khronos' validator on a GLB file: prints how many errors, warnings, infos and hints it has.
const fs = require("fs");
const { validateBytes } = require("gltf-validator");

validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then(({ issues, info }) => {
  const { numErrors: errors, numWarnings: warnings, numInfos: infos, numHints: hints } = issues;
  const { totalTriangleCount: triangles, drawCallCount: draws } = info;
  console.log(JSON.stringify({ errors, warnings, infos, hints, triangles, draws }));
});
