// Loads a session file as Foxglove does: with its reader of MCAP files, its decompression, and the rules that it has for
// JSON channels. Validates every message against its schema.
//
// Run by `cargo xtask test --only session-readers`: foxglove_reader.mjs PACKAGES FILE MESSAGES

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [, , packages, path, expected] = process.argv;
const require = createRequire(`${packages}/`);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");
const Ajv = require("ajv/dist/2020").default;

const file = readFileSync(path);
const readable = {
  size: async () => BigInt(file.length),
  read: async (offset, size) => new Uint8Array(file.subarray(Number(offset), Number(offset + size))),
};

// https://docs.foxglove.dev/docs/sdk/schemas: an object at the top, and each field with one type.
function checkAsFoxglove(schema, name) {
  assert.equal(schema.type, "object", name);
  for (const [field, definition] of Object.entries(schema.properties)) {
    const types = ["boolean", "string", "number", "integer", "object", "array"];
    assert.ok(types.includes(definition.type), `${name}.${field}: ${definition.type}`);
    const of = definition.type === "array" ? definition.items : definition;
    if (of.type === "object") checkAsFoxglove(of, `${name}.${field}`);
  }
}

const decompressHandlers = await loadDecompressHandlers();
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
assert.equal(reader.header.profile, "motorlink");
const ajv = new Ajv({ strict: true, allErrors: true });
const validators = new Map();
for (const schema of reader.schemasById.values()) {
  assert.equal(schema.encoding, "jsonschema");
  const definition = JSON.parse(new TextDecoder().decode(schema.data));
  assert.ok(ajv.validateSchema(definition), ajv.errorsText());
  checkAsFoxglove(definition, schema.name);
  validators.set(schema.id, ajv.compile(definition));
}
const counts = new Map();
let last = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  counts.set(channel.topic, (counts.get(channel.topic) ?? 0) + 1);
  if (channel.topic === "/state") {
    // For replays by MotorLink only.
    assert.equal(channel.messageEncoding, "motorlink-state");
    continue;
  }
  assert.equal(channel.messageEncoding, "json");
  const validate = validators.get(channel.schemaId);
  const value = JSON.parse(new TextDecoder().decode(message.data));
  assert.ok(validate(value), `${channel.topic}: ${ajv.errorsText(validate.errors)}`);
  assert.ok(message.logTime >= last, "messages by time");
  last = message.logTime;
}
const total = [...counts.values()].reduce((sum, count) => sum + count, 0);
assert.equal(total, Number(expected));
for (const [id, count] of reader.statistics.channelMessageCounts) {
  assert.equal(BigInt(counts.get(reader.channelsById.get(id).topic) ?? 0), count);
}
for await (const attachment of reader.readAttachments()) {
  JSON.parse(new TextDecoder().decode(attachment.data));
}

// As Foxglove reads a live stream: from the first byte on.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(file);
let streamed = 0;
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  streamed += record.type === "Message" ? 1 : 0;
}
assert.ok(stream.done());
assert.equal(streamed, total);
console.log(`Foxglove's reader: ${total} messages are valid:`, Object.fromEntries(counts));
