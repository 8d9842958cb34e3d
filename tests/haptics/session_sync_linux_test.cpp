// When a session log flushes its file to the disk: this program's own fdatasync() counts.
#include <dlfcn.h>
#include <doctest/doctest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "engine/core/clock.hpp"
#include "tests/haptics/logged_session.hpp"
#include "tests/labels.hpp"

namespace palpate::session_sync_test {
namespace {

std::atomic<int> flushes = 0;
std::atomic<std::thread::id> flusher;

}  // namespace
}  // namespace palpate::session_sync_test

extern "C" int fdatasync(int file) {
  static const auto next = reinterpret_cast<int (*)(int)>(dlsym(RTLD_NEXT, "fdatasync"));
  palpate::session_sync_test::flusher = std::this_thread::get_id();
  ++palpate::session_sync_test::flushes;
  return next(file);
}

namespace palpate::session_sync_test {

TEST_CASE("the end of a stroke is flushed to the disk at once, by the log's own thread") {
  const ScratchFolder folder;
  SessionWriter writer(folder / "log", "a text");
  const auto write = [&](EditBatch edits) {
    writer.add(edits);
    writer.flush();
    writer.flush();  // once the thread is done with the block
  };
  const int before = flushes;
  EditBatch stroke = editsAt(0);
  write(stroke);
  CHECK(flushes == before);
  stroke.marks.push_back({stroke.points.size(), EditMark::Kind::stroke});
  write(stroke);
  CHECK(flushes == before + 1);
  CHECK(flusher.load() != std::this_thread::get_id());
}

TEST_CASE("a long stroke is flushed to the disk twice a second" * kClock) {
  const ScratchFolder folder;
  SessionWriter writer(folder / "log", "a text");
  const int before = flushes;
  const Stopwatch since;
  for (std::uint32_t i = 0; flushes < before + 5 && since.elapsed_s() < 30; ++i) {
    EditBatch edits = editsAt(i);
    edits.marks.clear();
    writer.add(edits);
    writer.flush();
    std::this_thread::yield();
  }
  CHECK(since.elapsed_s() < 3.7);  // five times half a second, and the pauses between blocks
}

}  // namespace palpate::session_sync_test
