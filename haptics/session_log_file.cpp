#include "haptics/session_log_file.hpp"

#include <array>
#include <cerrno>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/atomic_file.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

using session_file::Before;
using session_file::Block;
using session_file::Header;

std::vector<session_file::State> statesOf(std::span<const PointState> points) {
  std::vector<session_file::State> states;
  states.reserve(points.size());
  for (const PointState& point : points)
    states.push_back({.number = point.number,
                      .parent = point.parent,
                      .gone = point.gone,
                      .position = point.position,
                      .normal = point.normal,
                      .color = point.color});
  return states;
}

std::string bytesOf(std::span<const LoggedCommand> commands) {
  std::string bytes;
  for (const LoggedCommand& command : commands) {
    const session_file::Command head{.tick = command.tick,
                                     .kind = static_cast<std::uint32_t>(command.kind),
                                     .bytes = static_cast<std::uint32_t>(command.content.size())};
    bytes.append(reinterpret_cast<const char*>(&head), sizeof head);
    bytes += command.content;
    bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
  }
  return bytes;
}

}  // namespace

SessionLogFile::SessionLogFile(std::filesystem::path file, std::string text,
                               std::function<void(const std::string&)> onFailure)
    : file_(std::move(file)), onFailure_(std::move(onFailure)) {
  if (file_.empty()) throw Error("a session log has an empty name; give it one");
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file_, ignored) && std::filesystem::file_size(file_, ignored) > 0 &&
      !isSessionLog(file_))
    throw FileError(file_, "exists, and is not a session log; name another file");
  text.resize((text.size() + 7) / 8 * 8, ' ');
  Header header{.textBytes = static_cast<std::uint32_t>(text.size())};
  Checksum sum;
  sum.add(std::as_bytes(std::span(&header, 1)));
  sum.add(std::as_bytes(std::span(text)));
  header.checksum = sum.value();
  const std::string copy = std::string(reinterpret_cast<const char*>(&header), sizeof header) + text,
                    head = copy + copy;
  if (!isDeviceOrPipe(file_)) {  // a full disk is noticed before an older log is replaced
    AtomicFile probe(file_);
    probe.write(head);
    probe.flush();
  }
  keepOlder();
  int error = output_.open(file_);
  if (error == 0) error = output_.write(std::as_bytes(std::span(head)));
  if (error != 0) throw FileError(file_, whyNotWritten(error));
  bytes_ = head.size();
}

void SessionLogFile::keepOlder() {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file_, failed) || std::filesystem::file_size(file_, failed) == 0) return;
  FileLock lock;  // a log that is being written stays in its place
  if (!lock.take(file_)) throw FileError(file_, whyNotWritten(EAGAIN));
  lock.release();
  keptAs_ = AtomicFile::nameToKeep(file_);
  std::filesystem::rename(std::filesystem::canonical(file_, failed), keptAs_, failed);
  if (failed) throw FileError(file_, fmt::format("cannot be kept as {}: {}", keptAs_.string(), failed.message()));
}

void SessionLogFile::append(const Content& content) {
  const std::vector<session_file::State> states = statesOf(content.states);
  const std::string commands = bytesOf(content.commands);
  Block block{.number = blocks_++,
              .ticks = static_cast<std::uint32_t>(content.ticks.size()),
              .states = static_cast<std::uint32_t>(content.states.size()),
              .marks = static_cast<std::uint32_t>(content.marks.size()),
              .last = content.end != nullptr,
              .commands = content.commands.size(),
              .commandBytes = commands.size(),
              .merged = content.merged};
  if (content.end) block.end = *content.end;
  const Before before = before_;
  const std::uint64_t commanded = block.commands + !content.attribute.empty();
  before_ = {before.ticks + block.ticks, before.states + block.states, before.commands + commanded};
  const std::array body{std::as_bytes(content.ticks), std::as_bytes(std::span(states)), std::as_bytes(content.marks),
                        content.attribute, std::as_bytes(std::span(commands))};
  Checksum sum;
  sum.addValue(block);
  sum.addValue(before);
  for (const auto bytes : body) sum.add(bytes);
  block.checksum = sum.value();
  const auto write = [&] {
    std::size_t size = sizeof block + sizeof before;
    int error = isTorn_ ? EIO : output_.write(std::as_bytes(std::span(&block, 1)));
    if (error == 0) error = output_.write(std::as_bytes(std::span(&before, 1)));
    for (const auto bytes : body) {
      if (error == 0) error = output_.write(bytes);
      size += bytes.size();
    }
    if (error == 0) {
      bytes_ += size;
      last_ = {.bytes = size, .ticks = block.ticks, .states = block.states, .commands = commanded};
      return true;
    }
    takeBackTorn();
    fail(error);
    return false;
  };
  if (write()) return;
  if (content.end && takeBackLast() && write()) return;
  unwrittenTicks_ += block.ticks;
  unwrittenEdits_ += block.states;
  unwrittenCommands_ += commanded;
}

bool SessionLogFile::takeBackLast() {
  if (last_.bytes == 0 || isTorn_ || output_.cutTo(bytes_ - last_.bytes) != 0) return false;
  bytes_ -= last_.bytes;
  unwrittenTicks_ += last_.ticks;
  unwrittenEdits_ += last_.states;
  unwrittenCommands_ += last_.commands;
  last_ = {};
  return true;
}

void SessionLogFile::sync() {
  if (const int error = output_.sync(); error != 0) fail(error);
}

void SessionLogFile::close() {
  sync();
  if (const int error = output_.close(); error != 0) fail(error);
  if (failure_.empty()) return;
  const std::string missing =
      unwrittenTicks_ + unwrittenEdits_ + unwrittenCommands_ > 0
          ? fmt::format("{}{} and {} of points are missing in it", counted(unwrittenTicks_, "tick"),
                        unwrittenCommands_ ? ", " + counted(unwrittenCommands_, "command") : "",
                        counted(unwrittenEdits_, "edit"))
          : "its content may not be on the disk";
  throw FileError(file_, fmt::format("{} ({}; the session continued)", failure_, missing));
}

void SessionLogFile::takeBackTorn() {
  if (!isTorn_) isTorn_ = output_.cutTo(bytes_) != 0;
}

void SessionLogFile::fail(int error) {
  if (!failure_.empty()) return;
  failure_ = whyNotWritten(error);
  if (onFailure_)
    onFailure_(fmt::format("{}: {}; the session continues, and data that cannot be written are missing in its log",
                           file_.string(), failure_));
}

}  // namespace palpate
