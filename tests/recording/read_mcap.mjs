// SPDX-License-Identifier: MIT
// Reads recordings with the libraries of MCAP's makers (@mcap/core, @mcap/support), which check every checksum, and
// decodes every message by the schema in the file. Prints a line for each file; ends with 1 at the first error.
//   node read_mcap.mjs [--cut] FILE.mcap...     --cut: the file has no summary, and may end anywhere
import fs from 'fs';
import { createRequire } from 'module';

const require = createRequire(process.cwd() + '/');
const { McapIndexedReader, McapStreamReader } = require('@mcap/core');
const { protobufFromBinaryDescriptor } = require('@mcap/support');

class Decoder {
  types = new Map();
  counts = {};

  addChannel(channel, schema) {
    const root = protobufFromBinaryDescriptor(schema.data);
    this.types.set(channel.id, [channel.topic, root.lookupType(schema.name)]);
  }

  add(message) {
    const [topic, type] = this.types.get(message.channelId);
    const decoded = type.decode(message.data);
    // A message that is decoded and encoded again has the same bytes, so the schema names every field.
    if (Buffer.compare(Buffer.from(type.encode(decoded).finish()), Buffer.from(message.data)) !== 0)
      throw new Error(`${topic}: the schema does not have every field`);
    this.counts[topic] = (this.counts[topic] ?? 0) + 1;
  }
}

async function readIndexed(file, decoder) {
  const handle = await fs.promises.open(file);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      await handle.read(bytes, 0, Number(size), Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  for (const channel of reader.channelsById.values())
    decoder.addChannel(channel, reader.schemasById.get(channel.schemaId));
  for await (const message of reader.readMessages({ validateCrcs: true })) decoder.add(message);
  await handle.close();
  const stated = Number(reader.statistics.messageCount);
  const found = Object.values(decoder.counts).reduce((sum, each) => sum + each, 0);
  if (stated !== found) throw new Error(`the summary states ${stated} messages, ${found} are there`);
}

function readStream(file, decoder, isCut) {
  const reader = new McapStreamReader({ validateCrcs: true });
  const schemas = new Map();
  reader.append(fs.readFileSync(file));
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === 'Schema') schemas.set(record.id, record);
    if (record.type === 'Channel') decoder.addChannel(record, schemas.get(record.schemaId));
    if (record.type === 'Message') decoder.add(record);
  }
  if (!isCut && !reader.done()) throw new Error('the file is cut off');
}

const isCut = process.argv[2] === '--cut';
for (const file of process.argv.slice(isCut ? 3 : 2)) {
  const streamed = new Decoder();
  readStream(file, streamed, isCut);
  if (!isCut) {
    const indexed = new Decoder();
    await readIndexed(file, indexed);
    if (JSON.stringify(Object.entries(indexed.counts).sort()) !== JSON.stringify(Object.entries(streamed.counts).sort()))
      throw new Error(`${file}: the index has other messages than the chunks`);
  }
  console.log(`${file}: ${JSON.stringify(streamed.counts)}`);
}
