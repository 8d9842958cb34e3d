#include "engine/edit/edit_log.hpp"

#include "tests/gpu_fixture.hpp"

namespace palpate {

TEST_CASE_FIXTURE(GpuFixture, "without a reader nothing is kept and there is always room") {
  EditLog log(device, 1000);
  CHECK(log.capacity() == 1 << 19);
  log.publish(1'000'000);
  CHECK(log.room() == log.capacity());
}

TEST_CASE_FIXTURE(GpuFixture, "what is published is unread until it is consumed") {
  EditLog log(device, 1000);
  log.publish(10);
  log.attachReader();
  CHECK(log.unread().size() == 0);
  log.publish(510);
  CHECK(log.unread().begin == 10);
  CHECK(log.unread().end == 510);
  CHECK(log.room() == log.capacity() - 500);
  log.consume(300);
  CHECK(log.unread().begin == 300);
  CHECK(log.room() == log.capacity() - 210);
}

TEST_CASE_FIXTURE(GpuFixture, "the head wraps at 32 bits and positions go on") {
  EditLog log(device, 1000);
  log.publish(0xFFFFFF00u);
  log.attachReader();
  log.publish(0x00000100u);
  CHECK(log.unread().size() == 0x200);
  CHECK(log.unread().end == 0x1'0000'0100ull);
  log.publish(0x00000100u);
  CHECK(log.unread().size() == 0x200);
}

}  // namespace palpate
