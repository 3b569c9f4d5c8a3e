// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a reader of MCAP that is not ours finds in a file, and what is wrong with it, as json: node mcap_reader.mjs FILE PACKAGES
import fs from "node:fs";
import { createRequire } from "node:module";

const [file, packages] = process.argv.slice(2);
const require = createRequire(packages + "/");
const { McapIndexedReader } = require("@mcap/core");
const { decompress } = require("fzstd");
const theirs = require("@foxglove/schemas/jsonschema");

const problems = new Set();

/** Says where a value is not what its schema asks for. */
function validate(value, schema, where) {
  const wrong = (what) => problems.add(`${where}: ${what}`);
  if (schema.oneOf) {
    if (!schema.oneOf.some((choice) => choice.const === value)) wrong(`no choice: ${value}`);
    return;
  }
  const is = {
    object: (v) => typeof v === "object" && v !== null && !Array.isArray(v),
    array: Array.isArray,
    string: (v) => typeof v === "string",
    boolean: (v) => typeof v === "boolean",
    number: Number.isFinite,
    integer: Number.isInteger,
  }[schema.type];
  if (!is(value)) return wrong(`no ${schema.type}: ${JSON.stringify(value)}`);
  if (value < schema.minimum || value > schema.maximum) wrong(`out of range: ${value}`);
  if (value.length < schema.minItems || value.length > schema.maxItems) wrong(`${value.length} items`);
  if (schema.contentEncoding === "base64" && Buffer.from(value, "base64").toString("base64") !== value) wrong("no base64");
  for (const name of schema.required ?? []) if (!(name in value)) wrong(`lacks ${name}`);
  for (const [name, field] of Object.entries(schema.properties ?? {}))
    if (name in value) validate(value[name], field, `${where}.${name}`);
  if (schema.type === "object" && schema.properties)
    for (const name in value) if (!(name in schema.properties)) wrong(`${name} is not in the schema`);
  if (schema.items) value.forEach((item) => validate(item, schema.items, `${where}[]`));
}

const descriptor = fs.openSync(file);
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(fs.fstatSync(descriptor).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      fs.readSync(descriptor, bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  },
  decompressHandlers: { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) },
});

const topics = {};
const schemas = {};
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  schemas[channel.topic] = JSON.parse(new TextDecoder().decode(schema.data));
  const counted = Number(reader.statistics.channelMessageCounts.get(channel.id));
  topics[channel.topic] = { schema: schema.name, encodings: [channel.messageEncoding, schema.encoding], counted, read: 0 };
}

let last = 0n;
const times = [];
const logged = [];
for await (const message of reader.readMessages()) {
  const { topic } = reader.channelsById.get(message.channelId);
  topics[topic].read += 1;
  if (message.logTime < last) problems.add(`${topic}: ${message.logTime} comes after ${last}`);
  last = message.logTime;
  times.push(message.logTime);
  const value = JSON.parse(new TextDecoder().decode(message.data));
  validate(value, schemas[topic], topic);
  // What was published under Foxglove's name must be what Foxglove takes under it.
  const [family, name] = topics[topic].schema.split(".");
  if (family === "foxglove") validate(value, theirs[name], `${topic} by Foxglove's schema`);
  if (value.timestamp && BigInt(value.timestamp.sec) * 1000000000n + BigInt(value.timestamp.nsec) !== message.logTime)
    problems.add(`${topic}: its stamp is not its time in the file`);
  if (topic === "/log") logged.push(value.message);
  topics[topic].last = value;
}

const middle = times[Math.floor(times.length / 2)];
let found = 0;
for await (const message of reader.readMessages({ startTime: middle })) {
  if (message.logTime < middle) problems.add("seeking gives messages of before");
  found += 1;
}
if (found !== times.filter((t) => t >= middle).length) problems.add(`seeking finds ${found} messages`);

const metadata = {};
for await (const record of reader.readMetadata()) metadata[record.name] = Object.fromEntries(record.metadata);
const compressions = [...new Set(reader.chunkIndexes.map((chunk) => chunk.compression))];
console.log(JSON.stringify({ topics, problems: [...problems], logged, metadata, compressions, chunks: reader.chunkIndexes.length }));
