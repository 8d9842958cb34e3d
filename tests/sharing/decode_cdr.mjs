// Decodes CDR of ROS messages with the packages @foxglove/rosmsg2-serialization and @foxglove/cdr and the definitions
// of @foxglove/rosmsg-msgs-common: reads lines {"type": …, "bytes": HEX} and writes each message as a line.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";

const load = createRequire(process.argv[2] + "/");
const { parse } = load("@foxglove/rosmsg");
const { MessageReader } = load("@foxglove/rosmsg2-serialization");
const { ros2jazzy, ros2iron, ros2humble } = load("@foxglove/rosmsg-msgs-common");
const definitions = ros2jazzy ?? ros2iron ?? ros2humble;

// The message's own definition first, then those that it refers to.
function definitionsOf(type) {
  const found = [];
  const add = (name) => {
    const definition = definitions[name.replace("/msg/", "/")];
    if (definition == undefined) throw new Error(`there is no definition of ${name}`);
    if (found.some((other) => other.name === name)) return;
    found.push({ ...definition, name: found.length === 0 ? undefined : name });
    for (const field of definition.definitions) if (field.isComplex === true) add(field.type);
  };
  add(type.replace("/msg/", "/"));
  return found;
}

const readers = new Map();
for (const line of readFileSync(0, "utf8").split("\n").filter(Boolean)) {
  const { type, bytes } = JSON.parse(line);
  if (!readers.has(type)) readers.set(type, new MessageReader(definitionsOf(type)));
  const message = readers.get(type).readMessage(Buffer.from(bytes, "hex"));
  if (message.data != undefined) message.data = Buffer.from(message.data).toString("hex");
  console.log(JSON.stringify(message));
}
