// Reads a file of points with npm's laz-perf, copc and @loaders.gl/las, for test_las_oracles.py.
//   node foreign_las.mjs FOLDER-OF-PACKAGES laz|copc|loaders FILE OUTPUT
// OUTPUT receives a line of JSON that describes the data, followed by the bytes: the points' LAS records for laz and
// copc, the arrays for loaders.
import { closeSync, openSync, readFileSync, writeSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const [packages, kind, file, output] = process.argv.slice(2);
const require = createRequire(join(packages, "node_modules", "_"));
const bytes = readFileSync(file);

function write(said, parts) {
  const to = openSync(output, "w");
  writeSync(to, JSON.stringify(said) + "\n");
  for (const part of parts) writeSync(to, part);
  closeSync(to);
}

async function laz() {
  const { createLazPerf } = require("laz-perf");
  const module = await createLazPerf();
  const reader = new module.LASZip();
  const whole = module._malloc(bytes.length);
  module.HEAPU8.set(bytes, whole);
  reader.open(whole, bytes.length);
  const length = reader.getPointLength(), count = reader.getCount();
  const record = module._malloc(length);
  const records = Buffer.alloc(length * count);
  for (let i = 0; i < count; ++i) {
    reader.getPoint(record);
    records.set(module.HEAPU8.subarray(record, record + length), i * length);
  }
  write({ format: reader.getPointFormat(), length, count }, [records]);
}

async function copc() {
  const { Copc } = require("copc");
  const get = async (begin, end) => bytes.subarray(begin, end);
  const opened = await Copc.create(get);
  const { nodes } = await Copc.loadHierarchyPage(get, opened.info.rootHierarchyPage);
  const parts = [];
  for (const node of Object.values(nodes)) parts.push(Buffer.from(await Copc.loadCompressedPointDataBuffer(get, node)));
  const { Las } = require("copc");
  const { pointDataRecordFormat: format, pointDataRecordLength: length } = opened.header;
  const records = [];
  let count = 0;
  for (const [i, node] of Object.values(nodes).entries()) {
    const layout = { pointCount: node.pointCount, pointDataRecordFormat: format, pointDataRecordLength: length };
    const chunk = await Las.PointData.decompressChunk(parts[i], layout);
    records.push(Buffer.from(chunk));
    count += node.pointCount;
  }
  write({ format, length, count }, records);
}

async function loaders() {
  const { parse } = require("@loaders.gl/core");
  const { LASLoader } = require("@loaders.gl/las");
  const whole = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const read = await parse(whole, LASLoader, { worker: false, las: { fp64: true, skip: 1, colorDepth: "auto" } });
  const arrays = Object.entries(read.attributes).map(([name, array]) => [name, array.value]);
  const said = arrays.map(([name, value]) => ({ name, kind: value.constructor.name, length: value.length }));
  write(said, arrays.map(([, value]) => new Uint8Array(value.buffer, value.byteOffset, value.byteLength)));
}

await { laz, copc, loaders }[kind]();
