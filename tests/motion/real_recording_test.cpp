// A recorded room (25 frames of 640 x 480), fused with its own poses and with found ones.
#include <doctest/doctest.h>

#include <filesystem>

#include "engine/cloud/point_tree.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "tests/labels.hpp"
#include "tests/source_folder.hpp"

namespace palpate::real_recording_test {

namespace {

enum class Poses { own, found };

std::uint64_t frames() { return byTier<std::uint64_t>(4, 8); }

struct Room {
  FrameFusion fusion{FusionOptions{}};
  double furthest_mm = 0;  // of the found poses from the recorded ones
};

Room fused(const std::filesystem::path& folder, Poses poses) {
  RgbdFolder stream(folder);
  Room room;
  DepthFrame frame;
  for (std::uint64_t i = 0; i < frames() && stream.next(frame); ++i) {
    REQUIRE(frame.pose);
    const CameraPose recorded = *frame.pose;
    if (poses == Poses::found && i > 0) frame.pose.reset();
    const FrameOutcome& outcome = room.fusion.fuse(stream.camera(), frame);
    CHECK_MESSAGE(outcome.fate == FrameFate::fused, outcome.why);
    room.furthest_mm = std::max(room.furthest_mm, 1000 * glm::distance(outcome.pose.centre, recorded.centre));
  }
  return room;
}

}  // namespace

TEST_CASE("a recorded room is fused into one map, with its poses and without them" * kMoreInFull) {
  const std::filesystem::path folder = modelsFolder() / "rgbd_livingroom_a";
  if (!isRgbdFolder(folder)) {
    MESSAGE("skipped: no ", folder.string());
    return;
  }
  const Room own = fused(folder, Poses::own), found = fused(folder, Poses::found);
  CHECK(own.furthest_mm == 0);
  MESSAGE("found poses differ by up to ", found.furthest_mm, " mm from the recorded ones");
  CHECK(found.furthest_mm < 15);
  for (const Room* room : {&own, &found}) {
    const SurfelMap& map = room->fusion.map();
    MESSAGE(map.count(), " points, ", map.totals().removed, " removed");
    // The camera rotates and hardly moves: most of what a frame sees is already in the map.
    CHECK(map.isColored());
    CHECK(map.count() > 300'000);
    CHECK(map.count() < 450'000);
    CHECK(7 * map.totals().matched > 3 * (frames() - 1) * map.totals().appended);
    CHECK(map.totals().removed < map.count() / 1000);
  }
  // Both maps agree.
  const PointCloud here = own.fusion.map().cloud(), there = found.fusion.map().cloud();
  const PointTree tree(there.positions);
  std::size_t near = 0, asked = 0;
  for (std::size_t i = 0; i < here.size(); i += 50, ++asked) {
    std::array<std::uint32_t, 1> index{};
    std::array<double, 1> square{};
    tree.nearest(here.positions[i], index, square);
    near += square[0] < 0.01 * 0.01 ? 1 : 0;
  }
  CHECK(static_cast<double>(near) > 0.95 * static_cast<double>(asked));
}

}  // namespace palpate::real_recording_test
