#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "engine/gpu/transfer.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate::two_sides_test {

TEST_CASE_FIXTURE(GpuFixture,
                  "while one thread sculpts another follows the log, and in the end both clouds are the same") {
  const Scene scene = makeScene("sphere", 20'000);
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius, .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 10}});
  DrawnCloud drawn(device, scene.cloud, {.spare = touch.live().slots() - touch.live().count()});
  EditLog::Reader reader(touch.editLog());

  std::atomic<bool> sculpting = true;
  std::uint64_t followed = 0;
  std::thread sight([&] {
    while (sculpting) {
      followed += drawn.catchUp(reader);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  });
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.008 * i;
    const double r = 51 - 0.2 * std::min(i, 30);
    CHECK(touch.query({.time_s = 0.001 * i, .hip = {r * std::sin(angle), 0, r * std::cos(angle)}}, 0).valid);
  }
  touch.finish();
  sculpting = false;
  sight.join();
  followed += drawn.catchUp(reader);
  CHECK(touch.report().shortfalls.editsLogFull == 0);

  const auto positions = download<Vec4>(device, drawn.positions(), drawn.count());
  const auto normals = download<Vec4>(device, drawn.normals(), drawn.count());
  std::vector<bool> there(drawn.count());
  std::size_t different = 0, moved = 0;
  for (const PointState& point : touch.live().points()) {
    there[point.number] = true;
    different += Vec3(positions[point.number]) != point.position || Vec3(normals[point.number]) != point.normal;
    moved += point.number >= scene.cloud.size() || point.position != scene.cloud.positions[point.number];
  }
  for (std::size_t id = 0; id < there.size(); ++id) different += !there[id] && !std::isnan(positions[id].x);
  CHECK(different == 0);
  CHECK(moved > 100);
  CHECK(followed > moved);
}

TEST_CASE("a log written by one thread and read by another loses no move") {
  Device device({.gpu = "", .validation = Validation::off});
  EditLog log(device, 1000);
  EditLog::Reader reader(log);
  constexpr std::uint64_t kMoves = 5'000'000;
  std::thread writer([&] {
    std::uint64_t head = 0;
    while (head < kMoves) {
      const std::uint64_t next = std::min(head + 997, kMoves);
      if (log.room() < next - head) continue;
      head = next;
      log.publish(static_cast<std::uint32_t>(head));
    }
  });
  std::uint64_t read = 0;
  bool inOrder = true;
  while (read < kMoves) {
    const auto range = reader.unread();
    inOrder = inOrder && range.begin == read && range.size() <= log.capacity();
    read = range.end;
    reader.consume(read);
  }
  writer.join();
  CHECK(inOrder);
}

}  // namespace palpate::two_sides_test
