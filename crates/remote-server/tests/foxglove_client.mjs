// Watches a server by the client of Foxglove, as Foxglove and Lichtblick do, and validates each JSON message by its schema.
// Foxglove's reader of ROS 2 messages reads those for PlotJuggler.
//
// Run by `cargo xtask test --only foxglove-client`: foxglove_client.mjs PACKAGES URL ORIGIN

import assert from "node:assert/strict";
import { createRequire } from "node:module";

const [, , packages, url, origin] = process.argv;
const require = createRequire(`${packages}/`);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");
const Ajv = require("ajv/dist/2020").default;
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const TOPICS = ["/wire", "/link", "/motors/1/telemetry", "/motors/1/plot"];

// As Lichtblick: both names of the protocol.
const ws = new WebSocket(url, ["foxglove.websocket.v1", "foxglove.sdk.v1"], { origin });
const client = new FoxgloveClient({ ws });
const ajv = new Ajv({ strict: true, allErrors: true });
const channels = new Map(); // by subscription
const told = new Map(); // telemetry by time
const counts = new Map(); // by topic
const timeout = setTimeout(() => assert.fail(`nothing more after ${JSON.stringify([...counts])}`), 20_000);

client.on("error", (error) => assert.fail(error));
client.on("status", (status) => assert.fail(JSON.stringify(status)));
client.on("close", () => assert.fail("closed"));
client.on("serverInfo", (info) => {
  assert.deepEqual(info.capabilities, []);
  assert.equal(ws.protocol, "foxglove.sdk.v1");
});

// The decoder of a channel.
function decoder({ encoding, schemaEncoding, schema }) {
  if (encoding === "cdr") {
    assert.equal(schemaEncoding, "ros2msg");
    const reader = new MessageReader(parse(schema, { ros2: true }));
    return (data) => reader.readMessage(data);
  }
  assert.deepEqual([encoding, schemaEncoding], ["json", "jsonschema"]);
  const validate = ajv.compile(JSON.parse(schema));
  return (data) => {
    const value = JSON.parse(new TextDecoder().decode(data));
    assert.ok(validate(value), JSON.stringify(validate.errors));
    return value;
  };
}

client.on("advertise", (advertised) => {
  for (const channel of advertised) {
    channels.set(client.subscribe(channel.id), { ...channel, decode: decoder(channel), last: 0n });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const channel = channels.get(subscriptionId);
  const value = channel.decode(data);
  if (channel.topic === "/motors/1/telemetry") told.set(timestamp, value);
  if (channel.topic === "/motors/1/plot") {
    for (const [name, number] of Object.entries(value)) {
      assert.ok(Object.is(number, told.get(timestamp)[name] ?? NaN), `${name}: ${number}`);
    }
  }
  assert.ok(timestamp >= channel.last, "messages of a channel by time");
  channel.last = timestamp;
  assert.ok(Math.abs(Number(timestamp / 1_000_000n) - Date.now()) < 3_000, `${timestamp}`);
  counts.set(channel.topic, (counts.get(channel.topic) ?? 0) + 1);
  if (TOPICS.every((topic) => (counts.get(topic) ?? 0) >= (topic === "/link" ? 1 : 20))) {
    console.log(`valid, from ${origin}: ${JSON.stringify(Object.fromEntries(counts))}`);
    clearTimeout(timeout);
    process.exit(0);
  }
});
