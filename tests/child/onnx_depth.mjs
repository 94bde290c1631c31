// SPDX-License-Identifier: MIT
// A program of --depth-from on ONNX Runtime. Each picture becomes a float32 tensor 1 x 3 x H x W
// (RGB, 0 to 255), as networks of depth expect it. The output of the graph is depth in mm.
//   node onnx_depth.mjs FOLDER_OF_onnxruntime-node GRAPH.onnx
import { createRequire } from 'node:module';

const [packageFolder, graph] = process.argv.slice(2);
const ort = createRequire(import.meta.url)(packageFolder);
const session = await ort.InferenceSession.create(graph, { intraOpNumThreads: 1 });
let bytes = Buffer.alloc(0);

/** Returns the next picture of `bytes` and removes it; null if it is not complete yet. */
function takePicture() {
  const header = /^P6\n(\d+) (\d+)\n255\n/.exec(bytes.subarray(0, 30).toString('latin1'));
  if (!header) return null;
  const [width, height] = [Number(header[1]), Number(header[2])];
  const end = header[0].length + 3 * width * height;
  if (bytes.length < end) return null;
  const pixels = bytes.subarray(header[0].length, end);
  bytes = bytes.subarray(end);
  return { width, height, pixels };
}

/** Returns the colours one after the other, each as a plane. */
function splitColors({ width, height, pixels }) {
  const planes = new Float32Array(3 * width * height);
  for (let i = 0; i < planes.length; ++i)
    planes[(i % 3) * width * height + Math.floor(i / 3)] = pixels[i];
  return planes;
}

for await (const chunk of process.stdin) {
  bytes = Buffer.concat([bytes, chunk]);
  for (let picture = takePicture(); picture; picture = takePicture()) {
    const { width, height } = picture;
    const input = new ort.Tensor('float32', splitColors(picture), [1, 3, height, width]);
    const outputs = await session.run({ [session.inputNames[0]]: input });
    const depth = outputs[session.outputNames[0]].data;
    process.stdout.write(`${width} ${height} metric_mm\n`);
    process.stdout.write(Buffer.from(depth.buffer, depth.byteOffset, depth.byteLength));
  }
}
