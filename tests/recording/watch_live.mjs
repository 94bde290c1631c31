// SPDX-License-Identifier: MIT
// Watches a program's --live port with the client of the protocol's makers (npm: @foxglove/ws-protocol, ws), and decodes
// every message by the advertised schema. Prints the count of messages by topic; ends with 1 at the first error, or if
// the program does not offer a topic.
//   node watch_live.mjs PORT SECONDS TOPIC...
import { createRequire } from 'module';

const require = createRequire(process.cwd() + '/');
const { FoxgloveClient } = require('@foxglove/ws-protocol');
const { protobufFromBinaryDescriptor } = require('@mcap/support');
const WebSocket = require('ws');

const [port, seconds, ...topics] = process.argv.slice(2);
const types = new Map();
const counts = Object.fromEntries(topics.map((topic) => [topic, 0]));

function fail(error) {
  console.error(error);
  process.exit(1);
}

const client = new FoxgloveClient({
  ws: new WebSocket(`ws://127.0.0.1:${port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]),
});
client.on('error', fail);
client.on('status', (status) => fail(status));
client.on('advertise', (channels) => {
  for (const topic of topics)
    if (!channels.some((channel) => channel.topic === topic)) fail(`no topic ${topic}`);
  for (const channel of channels) {
    const root = protobufFromBinaryDescriptor(Buffer.from(channel.schema, 'base64'));
    types.set(client.subscribe(channel.id), [channel.topic, root.lookupType(channel.schemaName)]);
  }
});
client.on('message', ({ subscriptionId, data }) => {
  const [topic, type] = types.get(subscriptionId);
  const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
  const again = Buffer.from(type.encode(type.decode(bytes)).finish());
  if (Buffer.compare(again, bytes) !== 0) fail(`${topic}: the schema does not have every field`);
  counts[topic] = (counts[topic] ?? 0) + 1;
});
setTimeout(() => {
  console.log(JSON.stringify(counts));
  for (const topic of topics) if (counts[topic] === 0) fail(`${topic} has no message`);
  process.exit(0);
}, 1000 * Number(seconds));
