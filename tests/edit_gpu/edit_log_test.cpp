#include "engine/edit/edit_log.hpp"

#include <optional>

#include "engine/edit/edit_fetch.hpp"
#include "engine/gpu/transfer.hpp"
#include "tests/gpu_fixture.hpp"

namespace palpate::edit_log_test {

namespace {

std::vector<EditMark> marksOf(EditLog::Reader& reader) {
  const auto range = reader.unread();
  std::vector<EditMark> marks;
  reader.takeMarks(range.begin, range.end, marks);
  return marks;
}

PointState anyState(std::uint32_t i) {
  const auto f = static_cast<float>(i);
  return {.position = {f, -f, 0.5f * f}, .number = i % 997, .normal = {0, 0, 1}, .color = i * 7, .parent = i / 2};
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "without a reader the edit log keeps nothing and always has room") {
  EditLog log(device, 1000);
  CHECK(log.capacity() == 1 << 19);
  log.publish(1'000'000);
  log.endStroke();
  CHECK(log.room() == log.capacity());
}

TEST_CASE_FIXTURE(GpuFixture, "published edits are unread until they are consumed") {
  EditLog log(device, 1000);
  log.publish(10);
  EditLog::Reader reader(log);
  CHECK(reader.unread().size() == 0);
  log.publish(510);
  CHECK(reader.unread().begin == 10);
  CHECK(reader.unread().end == 510);
  CHECK(log.room() == log.capacity() - 500);
  reader.consume(300);
  CHECK(reader.unread().begin == 300);
  CHECK(log.room() == log.capacity() - 210);
}

TEST_CASE_FIXTURE(GpuFixture, "the slowest reader limits the room in the edit log, until it is destroyed") {
  EditLog log(device, 1000);
  EditLog::Reader fast(log);
  std::optional<EditLog::Reader> slow(std::in_place, log);
  log.publish(700);
  fast.consume(700);
  CHECK(log.room() == log.capacity() - 700);
  slow->consume(100);
  CHECK(log.room() == log.capacity() - 600);
  slow.reset();
  CHECK(log.room() == log.capacity());
  EditLog::Reader late(log);
  CHECK(late.unread().size() == 0);
  log.publish(800);
  CHECK(late.unread().size() == 100);
}

TEST_CASE_FIXTURE(GpuFixture, "the head of the edit log wraps at 32 bits, and positions continue") {
  EditLog log(device, 1000);
  log.publish(0xFFFFFF00u);
  EditLog::Reader reader(log);
  log.publish(0x00000100u);
  CHECK(reader.unread().size() == 0x200);
  CHECK(reader.unread().end == 0x1'0000'0100ull);
  log.publish(0x00000100u);
  CHECK(reader.unread().size() == 0x200);
}

TEST_CASE_FIXTURE(GpuFixture, "each reader receives the marks of strokes and changes once") {
  EditLog log(device, 1000);
  EditLog::Reader first(log), second(log);
  log.publish(5);
  log.endStroke();
  log.publish(8);
  log.publishChange(12);
  log.publish(20);
  const std::vector<EditMark> expected{{5, EditMark::Kind::stroke}, {12, EditMark::Kind::change}};
  CHECK(marksOf(first) == expected);
  first.consume(20);
  CHECK(marksOf(first).empty());
  log.endStroke();  // after everything that the first reader has consumed, and still unread
  CHECK(marksOf(first) == std::vector<EditMark>{{0, EditMark::Kind::stroke}});
  second.consume(20);
  log.publish(30);
  second.consume(30);
  CHECK(marksOf(second).empty());
}

TEST_CASE_FIXTURE(GpuFixture, "a reader that leaves too many marks unread leaves no room for edits") {
  EditLog log(device, 100'000);
  EditLog::Reader reader(log);
  std::uint32_t head = 0;
  while (log.room() > 0) {
    log.publish(++head);
    log.endStroke();
    REQUIRE(head < 10'000);
  }
  CHECK(head > 1000);
  CHECK(marksOf(reader).size() == head);
  CHECK(log.room() > 0);
}

TEST_CASE_FIXTURE(GpuFixture, "a fetch copies all states and marks to the host, also when the ring wraps") {
  EditLog log(device, 1000, 0);
  REQUIRE(log.capacity() == 2048);
  EditFetch fetch(device, log);
  std::vector<PackedState> ring(log.capacity());
  std::uint32_t head = 0;
  EditBatch all;
  for (const std::uint32_t step : {1u, 1000u, 2048u, 777u, 1500u, 0u, 2047u}) {
    for (std::uint32_t i = 0; i < step; ++i) ring[(head + i) % ring.size()] = packedState(anyState(head + i));
    upload(device, log.entriesBuffer(), ring);
    head += step;
    if (step == 777)
      log.publishChange(head);
    else
      log.publish(head);
    fetch.take(all);
    log.endStroke();  // seen by the next fetch
  }
  REQUIRE(all.points.size() == head);
  std::size_t wrong = 0;
  for (std::uint32_t i = 0; i < head; ++i) wrong += all.points[i] != anyState(i);
  CHECK(wrong == 0);
  CHECK(all.marks == std::vector<EditMark>{{1, EditMark::Kind::stroke},
                                           {1001, EditMark::Kind::stroke},
                                           {3049, EditMark::Kind::stroke},
                                           {3826, EditMark::Kind::change},
                                           {3826, EditMark::Kind::stroke},
                                           {5326, EditMark::Kind::stroke},
                                           {5326, EditMark::Kind::stroke}});
}

}  // namespace palpate::edit_log_test
