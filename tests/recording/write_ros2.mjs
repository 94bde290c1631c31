// SPDX-License-Identifier: MIT
// Writes a recording as ROS 2 writes it, with libraries of other makers (@mcap/core,
// @foxglove/rosmsg2-serialization): a textured ball moves in front of a wall, 30 frames/s. A message of another type
// and a second camera_info stand between the images.
//   node write_ros2.mjs FILE FRAMES raw|compressed
// raw: sensor_msgs/msg/Image (rgb8, 16UC1) in chunks without compression. compressed:
// sensor_msgs/msg/CompressedImage (PNG, compressedDepth) in chunks of zstd.
import fs from 'fs';
import zlib from 'zlib';
import { createRequire } from 'module';

const require = createRequire(process.cwd() + '/');
const { McapWriter } = require('@mcap/core');
const { crc32 } = require('@foxglove/crc');
const { parse } = require('@foxglove/rosmsg');
const { MessageWriter } = require('@foxglove/rosmsg2-serialization');
const zstd = require('@foxglove/wasm-zstd');

const width = 320;
const height = 240;
const focal = 300;
const start = 1700000000n * 1000000000n;

const bar = '='.repeat(80);
const header = `${bar}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n`;
const definitions = {
  Image: `std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step
uint8[] data\n${header}`,
  CompressedImage: `std_msgs/Header header\nstring format\nuint8[] data\n${header}`,
  CameraInfo: `std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d
float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi
${header}${bar}\nMSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width
bool do_rectify\n`,
  Temperature: `std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n${header}`,
};

// The ball has a radius of 80 mm and turns in a circle in front of a wall at 1200 mm.
function draw(frame) {
  const color = new Uint8Array(width * height * 3);
  const depth = new Uint16Array(width * height);
  const angle = (2 * Math.PI * frame) / 60;
  const centre = [60 * Math.cos(angle), 40 * Math.sin(angle), 700 + 30 * Math.sin(angle)];
  for (let v = 0; v < height; v++) {
    for (let u = 0; u < width; u++) {
      const ray = [(u - 159.5) / focal, (v - 119.5) / focal, 1];
      const a = ray[0] ** 2 + ray[1] ** 2 + 1;
      const b = ray[0] * centre[0] + ray[1] * centre[1] + centre[2];
      const c = centre[0] ** 2 + centre[1] ** 2 + centre[2] ** 2 - 80 ** 2;
      const inside = b * b - a * c;
      const z = inside > 0 ? (b - Math.sqrt(inside)) / a : 1200;
      depth[v * width + u] = Math.round(z);
      const x = inside > 0 ? ray[0] * z - centre[0] : u;
      const y = inside > 0 ? ray[1] * z - centre[1] : v;
      const dark = (Math.floor(x / 12) + Math.floor(y / 12)) % 2 === 0;
      color.set(inside > 0 ? [dark ? 200 : 240, 60, 40] : [70, dark ? 90 : 100, 110], 3 * (v * width + u));
    }
  }
  return { color, depth };
}

function pngChunk(type, data) {
  const body = Buffer.concat([Buffer.from(type), data]);
  const ends = Buffer.alloc(8);
  ends.writeUInt32BE(data.length, 0);
  ends.writeUInt32BE(crc32(body) >>> 0, 4);
  return Buffer.concat([ends.subarray(0, 4), body, ends.subarray(4)]);
}

// Pixels with big-endian values; a row of a PNG has its filter in front (0: none).
function encodePng(pixels, bits, colorType) {
  const rowBytes = pixels.length / height;
  const rows = [];
  for (let v = 0; v < height; v++) rows.push(Buffer.from([0]), pixels.subarray(v * rowBytes, (v + 1) * rowBytes));
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([bits, colorType, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10]),
    pngChunk('IHDR', head),
    pngChunk('IDAT', zlib.deflateSync(Buffer.concat(rows))),
    pngChunk('IEND', Buffer.alloc(0)),
  ]);
}

function makeImages({ color, depth }, form, stamp) {
  const head = { stamp, frame_id: 'camera_color_optical_frame' };
  const depthBytes = Buffer.from(depth.buffer);
  if (form === 'raw') {
    const size = { header: head, height, width, is_bigendian: 0 };
    return [
      { ...size, encoding: 'rgb8', step: 3 * width, data: color },
      { ...size, encoding: '16UC1', step: 2 * width, data: depthBytes },
    ];
  }
  const png = encodePng(Buffer.from(depthBytes).swap16(), 16, 0);
  return [
    { header: head, format: 'rgb8; png compressed rgb8', data: encodePng(Buffer.from(color), 8, 2) },
    { header: head, format: '16UC1; compressedDepth png', data: Buffer.concat([Buffer.alloc(12), png]) },
  ];
}

const [file, frames, form] = process.argv.slice(2);
await zstd.isLoaded;
const out = fs.openSync(file, 'w');
let place = 0;
const mcap = new McapWriter({
  writable: {
    write: async (bytes) => void (place += fs.writeSync(out, bytes)),
    position: () => BigInt(place),
  },
  compressChunk:
    form === 'raw' ? undefined : (bytes) => ({ compression: 'zstd', compressedData: zstd.compress(bytes) }),
});
await mcap.start({ profile: 'ros2', library: 'hapticast tests' });

const writers = {};
async function addTopic(topic, type) {
  const text = definitions[type];
  const schemaId = await mcap.registerSchema({
    name: `sensor_msgs/msg/${type}`,
    encoding: 'ros2msg',
    data: new TextEncoder().encode(text),
  });
  const id = await mcap.registerChannel({ topic, schemaId, messageEncoding: 'cdr', metadata: new Map() });
  writers[topic] = { id, writer: new MessageWriter(parse(text, { ros2: true })), count: 0 };
}

async function send(topic, message, time) {
  const each = writers[topic];
  await mcap.addMessage({
    channelId: each.id,
    sequence: each.count++,
    logTime: time,
    publishTime: time,
    data: each.writer.writeMessage(message),
  });
}

const suffix = form === 'raw' ? ['', ''] : ['/compressed', '/compressedDepth'];
const colorTopic = '/camera/color/image_raw' + suffix[0];
const depthTopic = '/camera/aligned_depth_to_color/image_raw' + suffix[1];
const imageType = form === 'raw' ? 'Image' : 'CompressedImage';
await addTopic(colorTopic, imageType);
await addTopic(depthTopic, imageType);
await addTopic('/camera/color/camera_info', 'CameraInfo');
await addTopic('/camera/infra1/camera_info', 'CameraInfo');
await addTopic('/camera/temperature', 'Temperature');
for (let frame = 0; frame < Number(frames); frame++) {
  const time = start + (BigInt(frame) * 1000000000n) / 30n;
  const stamp = { sec: Number(time / 1000000000n), nanosec: Number(time % 1000000000n) };
  const [color, depth] = makeImages(draw(frame), form, stamp);
  const camera = {
    header: color.header,
    height,
    width,
    distortion_model: 'plumb_bob',
    d: [0, 0, 0, 0, 0],
    k: [focal, 0, 159.5, 0, focal, 119.5, 0, 0, 1],
    r: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    p: [focal, 0, 159.5, 0, 0, focal, 119.5, 0, 0, 0, 1, 0],
    binning_x: 0,
    binning_y: 0,
    roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false },
  };
  await send('/camera/color/camera_info', camera, time);
  await send('/camera/infra1/camera_info', { ...camera, k: [1, 0, 1, 0, 1, 1, 0, 0, 1] }, time);
  await send(depthTopic, depth, time + 4000000n); // arrives first, as it often does
  await send(colorTopic, color, time + 9000000n);
  await send('/camera/temperature', { header: color.header, temperature: 40.5, variance: 0 }, time + 9000000n);
}
await mcap.end();
fs.closeSync(out);
