// Reads a session file with the libraries with which Foxglove opens MCAP files.
//
// Run by `cargo xtask test --only session-readers`, with the counts that the writer has:
// foxglove_reader.mjs PACKAGES FILE MESSAGES ENTRIES

import assert from "node:assert/strict";
import { open } from "node:fs/promises";
import { createRequire } from "node:module";
import { join, sep } from "node:path";

const [packages, path, messagesExpected, entriesExpected] = process.argv.slice(2);
const load = createRequire(join(packages, "node_modules") + sep);
const { McapIndexedReader, McapStreamReader } = load("@mcap/core");
const { loadDecompressHandlers } = load("@mcap/support");

const file = await open(path);
const size = (await file.stat()).size;
async function read(offset, length) {
  const { bytesRead, buffer } = await file.read(
    new Uint8Array(Number(length)), 0, Number(length), Number(offset),
  );
  assert.equal(bytesRead, Number(length), "the index points past the end of the file");
  return buffer;
}

const decompressHandlers = await loadDecompressHandlers();
const reader = await McapIndexedReader.Initialize({
  readable: { size: async () => BigInt(size), read },
  decompressHandlers,
});
const text = new TextDecoder("utf-8", { fatal: true });
for (const schema of reader.schemasById.values()) {
  assert.equal(schema.encoding, "jsonschema", schema.name);
  // Foxglove asks for an object at the top.
  assert.equal(JSON.parse(text.decode(schema.data)).type, "object", schema.name);
}

const topics = {};
let entries = 0;
let last = 0n;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  assert.equal(channel.messageEncoding, "json", channel.topic);
  assert.ok(reader.schemasById.has(channel.schemaId), channel.topic);
  entries += JSON.parse(text.decode(message.data)).frames?.length ?? 0;
  topics[channel.topic] = (topics[channel.topic] ?? 0) + 1;
  assert.ok(message.logTime >= last, "messages by time");
  last = message.logTime;
}
const total = Object.values(topics).reduce((sum, count) => sum + count, 0);
assert.deepEqual([total, entries], [Number(messagesExpected), Number(entriesExpected)]);
for (const topic of ["/wire", "/events", "/link"]) {
  assert.ok(topics[topic] > 0, `nothing on ${topic}`);
}

// Without the index, as a file that is still being written.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(await read(0, size));
let streamed = 0;
for (let record; (record = stream.nextRecord()); ) {
  streamed += record.type === "Message";
}
assert.ok(stream.done(), "the stream ends with the file");
assert.equal(streamed, total);
await file.close();
console.log(`${total} messages with ${entries} entries: ${JSON.stringify(topics)}`);
