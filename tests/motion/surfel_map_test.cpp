// A map of surfels against the observed shapes: accuracy, evenness, and which points are removed or kept.
#include "engine/motion/surfel_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "engine/cloud/point_tree.hpp"
#include "engine/core/error.hpp"
#include "engine/motion/fusion.hpp"
#include "tests/motion/depth_scene.hpp"
#include "tests/near.hpp"

namespace palpate::surfel_map_test {

namespace {

const DVec3 kTable(0, 0, 0.02);

// A map of the table, from a number of frames on an arc.
FrameFusion fusedTable(std::uint64_t frames, double noise, const FusionOptions& options = smallMap(),
                       const DVec3& at = DVec3(0)) {
  const DepthScene scene = tableScene(at);
  FrameFusion fusion(options);
  for (std::uint64_t i = 0; i < frames; ++i) {
    const double share = frames > 1 ? static_cast<double>(i) / static_cast<double>(frames - 1) : 0.5;
    const auto& outcome =
        fusion.fuse(smallCamera(), scene.frame(smallCamera(), onArc(at + kTable, 1.0, share), noise, i));
    REQUIRE(outcome.fate == FrameFate::fused);
    CHECK(outcome.counts.points == fusion.map().count());
  }
  return fusion;
}

double footprint(double depth_m) { return depth_m / smallCamera().fx; }

// Of 24 frames with noise, shared by several tests.
const SurfelMap& tableInNoise() {
  static const FrameFusion fusion = fusedTable(24, 1);
  return fusion.map();
}

// Distance to the k-th nearest of the points, counted from 0.
double distanceTo(const PointTree& tree, const Vec3& place, std::size_t k) {
  std::array<std::uint32_t, 2> indices{};
  std::array<double, 2> squares{};
  tree.nearest(place, indices, squares);
  return std::sqrt(squares[k]);
}

struct Truth {
  double rms_mm = 0, angle_deg = 0;  // from the surface; median of the normals
  std::size_t points = 0;
};

// For the points with at least this number of measurements.
Truth against(const DepthScene& scene, const SurfelMap& map, shared::uint measurements) {
  Truth truth;
  std::vector<double> angles;
  for (std::size_t id = 0; id < map.ids(); ++id) {
    const shared::Surfel& surfel = map.surfel(id);
    if (!map.holds(id) || shared::measurementsOf(surfel.record) < measurements) continue;
    const DVec3 place = map.origin() + DVec3(surfel.place);
    const SurfacePoint on = scene.closest(place);
    truth.rms_mm += 1e6 * glm::dot(place - on.position, place - on.position);
    angles.push_back(angleBetween_deg(DVec3(surfel.normal), on.normal));
    ++truth.points;
  }
  truth.rms_mm = std::sqrt(truth.rms_mm / static_cast<double>(truth.points));
  std::ranges::nth_element(angles, angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2));
  truth.angle_deg = angles[angles.size() / 2];
  return truth;
}

}  // namespace

TEST_CASE("a fused map is more accurate than any of its depth frames") {
  const DepthScene scene = tableScene();
  const Truth one = against(scene, fusedTable(1, 1).map(), 1);
  const Truth many = against(scene, tableInNoise(), 12);
  MESSAGE("RMS " << one.rms_mm << " mm after one frame, " << many.rms_mm << " mm after 24; normals " << one.angle_deg
                 << " and " << many.angle_deg << " degrees; " << many.points << " points");
  CHECK(many.points > 10'000);
  CHECK(many.rms_mm < one.rms_mm / 3);
  CHECK(many.angle_deg < one.angle_deg / 2);
}

TEST_CASE("without noise points lie on the shapes, with their normals") {
  const DepthScene scene = tableScene();
  const Truth truth = against(scene, fusedTable(6, 0).map(), 4);
  MESSAGE("RMS " << truth.rms_mm << " mm, normals " << truth.angle_deg << " degrees");
  CHECK(truth.rms_mm < 0.15);
  CHECK(truth.angle_deg < 0.5);
}

TEST_CASE("points cover the observed surface evenly, without duplicates") {
  const PointCloud cloud = tableInNoise().cloud();
  const PointTree tree(cloud.positions);
  std::vector<double> gaps;
  for (const Vec3& place : cloud.positions) gaps.push_back(distanceTo(tree, place, 1));
  std::ranges::sort(gaps);
  const double pixel = footprint(1.0);
  MESSAGE("neighbours: " << gaps[gaps.size() / 100] / pixel << " pixels at 1 %, " << gaps[gaps.size() / 2] / pixel
                         << " at 50 %");
  CHECK(gaps[gaps.size() / 100] > 0.5 * pixel);
  // Near each surface of the last frame there is a point.
  const DepthScene scene = tableScene();
  FrameImages images;
  std::vector<shared::PixelSurface> surfaces;
  const CameraPose pose = onArc(kTable, 1.0, 1);
  readFrame(smallCamera(), scene.frame(smallCamera(), pose), smallMap(), images);
  findPixelSurfaces(images, smallMap(), surfaces);
  std::size_t seen = 0, near = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (!(surfaces[i].depth > 0)) continue;
    const DVec3 place = pose.toWorld(smallCamera().placeAt(static_cast<double>(i % 160), static_cast<double>(i / 160),
                                                           static_cast<double>(images.depths[i])));
    ++seen;
    const double slant = -glm::dot(DVec3(surfaces[i].normal), glm::normalize(pose.toCamera(place)));
    near += distanceTo(tree, Vec3(place), 0) < 1.5 * pixel / slant + 0.003;
  }
  CHECK(seen > 15'000);
  MESSAGE(near << " of " << seen << " pixels have a point near");
  CHECK(static_cast<double>(near) > 0.99 * static_cast<double>(seen));
}

TEST_CASE("a removed object leaves no ghost once the camera sees through it, and a new object is mapped") {
  DepthScene before, after;
  before.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, DVec3(-0.05, 0, 0.06));
  after.add("plane", 0.8, DVec3(0)).add("sphere", 0.08, DVec3(0.05, 0, 0.06));
  FrameFusion fusion(smallMap());
  const CameraPose pose = onArc(kTable, 1.0, 0.5);
  std::uint64_t number = 0;
  for (; number < 8; ++number) fusion.fuse(smallCamera(), before.frame(smallCamera(), pose, 1, number));
  const auto standing = [&](const DVec3& center) {
    std::size_t points = 0;
    for (std::size_t id = 0; id < fusion.map().ids(); ++id)
      points += fusion.map().holds(id) && glm::distance(DVec3(fusion.map().surfel(id).place), center) < 0.045 &&
                fusion.map().surfel(id).place.z > 0.03f;
    return points;
  };
  CHECK(standing({-0.05, 0, 0.06}) > 500);
  for (; number < 16; ++number) fusion.fuse(smallCamera(), after.frame(smallCamera(), pose, 1, number));
  CHECK(fusion.map().totals().removed > 500);
  CHECK(standing({-0.05, 0, 0.06}) == 0);
  CHECK(standing({0.05, 0, 0.06}) > 500);
}

TEST_CASE("a slightly wrong pose does not erode the rim of an object before a wall") {
  DepthScene scene;
  scene.add("cube", 0.1, {0, 0, 0.05}).add("plane", 2, {0, 0, -0.5});
  FrameFusion fusion(smallMap());
  const CameraPose pose = lookingAt({0, 0, 1}, {0, 0, 0});
  const DepthFrame frame = scene.frame(smallCamera(), pose);
  for (int i = 0; i < 6; ++i) fusion.fuse(smallCamera(), frame);
  const std::size_t ids = fusion.map().ids();
  DepthFrame aside = frame;
  aside.pose->centre.x += 0.9 * footprint(0.9);
  for (int i = 0; i < 12; ++i) fusion.fuse(smallCamera(), aside);
  std::size_t kept = 0;
  for (std::size_t id = 0; id < ids; ++id) kept += fusion.map().holds(id) ? 1 : 0;
  CHECK(kept == ids);
  // At three pixels the other position is a real change.
  aside.pose->centre.x += 2.1 * footprint(0.9);
  for (int i = 0; i < 12; ++i) fusion.fuse(smallCamera(), aside);
  CHECK(fusion.map().totals().removed > 20);
}

TEST_CASE("points that are not observed stay unchanged: behind the camera, outside its view, or hidden") {
  const DepthScene scene = tableScene();
  FrameFusion fusion(smallMap());
  for (std::uint64_t i = 0; i < 6; ++i)
    fusion.fuse(smallCamera(), scene.frame(smallCamera(), onArc(kTable, 1.0, 0.5), 1, i));
  const SurfelMap before = fusion.map();
  // Number of unchanged points among those with at least this number of measurements before.
  const auto same = [&](const SurfelMap& map, shared::uint measurements) {
    std::size_t count = 0;
    for (std::size_t id = 0; id < before.ids(); ++id)
      count += shared::measurementsOf(before.surfel(id).record) >= measurements &&
               areSame(before.surfel(id), map.surfel(id));
    return count;
  };
  SUBCASE("behind the camera") {
    const CameraPose away = lookingAt({0, 0, 1}, {0, 0, 2});
    DepthScene ceiling;
    ceiling.add("plane", 3, {0, 0, 2});
    fusion.fuse(smallCamera(), ceiling.frame(smallCamera(), away, 1, 10));
    CHECK(fusion.map().totals().appended == before.totals().appended + fusion.map().count() - before.count());
    CHECK(same(fusion.map(), 0) == before.ids());
  }
  SUBCASE("hidden by a board close to the camera") {
    DepthScene board;
    board.add("cube", 0.3, onArc(kTable, 0.75, 0.5).centre);
    const CameraPose pose = onArc(kTable, 1.0, 0.5);
    for (std::uint64_t i = 10; i < 30; ++i) fusion.fuse(smallCamera(), board.frame(smallCamera(), pose, 1, i));
    std::size_t stable = 0;
    for (std::size_t id = 0; id < before.ids(); ++id) stable += shared::isStable(before.surfel(id).record) ? 1 : 0;
    CHECK(stable > 10'000);
    CHECK(same(fusion.map(), shared::kStableCount) == stable);
  }
  SUBCASE("no depth was measured") {
    DepthFrame nothing = scene.frame(smallCamera(), onArc(kTable, 1.0, 0.5), 0, 10);
    std::ranges::fill(nothing.depth_m, 0.0f);
    const FrameOutcome outcome = fusion.fuse(smallCamera(), nothing);
    CHECK(outcome.fate == FrameFate::fused);
    CHECK(outcome.counts == FusionCounts{.points = before.count()});
    CHECK(areSame(before, fusion.map()));
  }
}

TEST_CASE("an id stands for one point until it is removed") {
  const DepthScene scene = tableScene();
  FrameFusion fusion(smallMap());
  std::vector<shared::Surfel> before;
  std::size_t followed = 0;
  float furthest = 0;
  for (std::uint64_t i = 0; i < 8; ++i) {
    fusion.fuse(smallCamera(), scene.frame(smallCamera(), onArc(kTable, 1.0, static_cast<double>(i) / 7), 1, i));
    for (std::size_t id = 0; id < before.size(); ++id) {
      const shared::Surfel& now = fusion.map().surfel(id);
      // A new point has one measurement.
      if (before[id].record.weight == 0 || shared::measurementsOf(now.record) == 1 || !fusion.map().holds(id)) continue;
      ++followed;
      furthest = std::max(furthest, glm::distance(now.place, before[id].place));
    }
    before.clear();
    for (std::size_t id = 0; id < fusion.map().ids(); ++id) before.push_back(fusion.map().surfel(id));
  }
  CHECK(followed > 100'000);
  CHECK(furthest < 0.02f);
}

TEST_CASE("a full map adds no points, reports how many were refused, and keeps averaging") {
  const DepthScene scene = tableScene();
  FrameFusion fusion(smallMap(5000));
  const CameraPose pose = onArc(kTable, 1.0, 0.5);
  const FusionCounts first = fusion.fuse(smallCamera(), scene.frame(smallCamera(), pose, 1, 0)).counts;
  CHECK(first.points == 5000);
  CHECK(first.appended == 5000);
  CHECK(first.refused > 5000);
  const FusionCounts second = fusion.fuse(smallCamera(), scene.frame(smallCamera(), pose, 1, 1)).counts;
  CHECK(second.points <= 5000);
  CHECK(second.matched > 4900);
  CHECK(fusion.map().ids() == 5000);
}

TEST_CASE("ids of removed points are reused, the lowest first") {
  DepthScene near, far;
  near.add("cube", 0.2, {0, 0, 0.1});
  far.add("plane", 2, {0, 0, -0.5});
  FrameFusion fusion(smallMap());
  const CameraPose pose = lookingAt({0, 0, 1}, {0, 0, 0});
  std::uint64_t number = 0;
  for (; number < 5; ++number) fusion.fuse(smallCamera(), near.frame(smallCamera(), pose, 0, number));
  const std::size_t ids = fusion.map().ids();
  REQUIRE(ids > 10'000);
  for (; number < 12; ++number) fusion.fuse(smallCamera(), far.frame(smallCamera(), pose, 0, number));
  CHECK(fusion.map().totals().removed >= ids);
  // The far points were added before the near ones were removed, whose ids are free now.
  const std::size_t most = fusion.map().ids(), free = most - fusion.map().count();
  CHECK(free >= ids);
  CHECK_FALSE(fusion.map().holds(0));
  const CameraPose aside = lookingAt({0.2, 0, 1}, {0.2, 0, 0});
  const FusionCounts counts = fusion.fuse(smallCamera(), far.frame(smallCamera(), aside, 0, number)).counts;
  CHECK(counts.appended > 1000);
  REQUIRE(counts.appended < free);
  CHECK(fusion.map().ids() == most);
  std::size_t next = 0;  // the first free id: all free ids were consecutive
  while (next < most && fusion.map().holds(next)) ++next;
  CHECK(next == counts.appended);
}

TEST_CASE("a map far from the world's origin is as accurate as one near it") {
  const DVec3 far(123'456, -654'321, 98'765);
  const auto here = fusedTable(6, 1);
  const auto there = fusedTable(6, 1, smallMap(), far);
  CHECK(here.map().origin() == DVec3(0));
  CHECK(glm::distance(there.map().origin(), far) < 2);
  const Truth a = against(tableScene(), here.map(), 4), b = against(tableScene(far), there.map(), 4);
  CHECK(b.rms_mm == near(a.rms_mm, 0.02));
  CHECK(static_cast<double>(b.points) == near(static_cast<double>(a.points), 0.01));
}

TEST_CASE("the same frames give the same map bit by bit with any number of threads") {
  DepthScene before, after;
  before.add("plane", 0.8, DVec3(0)).add("cube", 0.15, {-0.05, 0, 0.08});
  after.add("plane", 0.8, DVec3(0)).add("sphere", 0.15, {0.05, 0, 0.08});
  std::vector<DepthFrame> frames;
  for (std::uint64_t i = 0; i < 10; ++i)
    frames.push_back((i < 4 ? before : after).frame(smallCamera(), onArc(kTable, 1.0, 0.5), 1, i));
  std::vector<FrameFusion> fusions;
  for (const unsigned threads : {1u, 7u}) {
    FusionOptions options = smallMap();
    options.threads = threads;
    fusions.emplace_back(options);
    for (const DepthFrame& frame : frames) fusions.back().fuse(smallCamera(), frame);
  }
  CHECK(fusions[0].map().totals().removed > 2000);
  CHECK(areSame(fusions[0].map(), fusions[1].map()));
}

TEST_CASE("images of any size are fused, and a pixel without neighbours is no surface") {
  for (const auto& [width, height, some] : {std::tuple(1u, 1u, false),
                                            {2u, 2u, false},
                                            {17u, 3u, true},
                                            {3u, 17u, true},
                                            {1u, 40u, false},
                                            {4u, 4u, true},
                                            {33u, 31u, true}}) {
    CAPTURE(width);
    CAPTURE(height);
    const DepthCamera camera{
        .width = width, .height = height, .fx = 500, .fy = 500, .cx = 0.5 * (width - 1), .cy = 0.5 * (height - 1)};
    DepthFrame frame{.depth_m = std::vector<float>(std::size_t{width} * height, 1.0f), .pose = CameraPose{}};
    FrameFusion fusion(smallMap());
    for (int i = 0; i < 3; ++i) REQUIRE(fusion.fuse(camera, frame).fate == FrameFate::fused);
    CHECK((fusion.map().count() > 0) == some);
    CHECK(fusion.map().count() <= frame.depth_m.size());
    CHECK(fusion.map().totals().removed == 0);
  }
}

TEST_CASE("colours are averaged, and absent if none was observed") {
  const DepthScene scene = tableScene();
  DepthFrame frame = scene.frame(smallCamera(), onArc(kTable, 1.0, 0.5), 0);
  FrameFusion fusion(smallMap());
  fusion.fuse(smallCamera(), frame);
  CHECK_FALSE(fusion.map().isColored());
  CHECK(fusion.map().cloud().colors.empty());
  frame.colors.assign(frame.depth_m.size(), {200, 100, 0});
  fusion.fuse(smallCamera(), frame);
  const std::array<std::uint8_t, 3> first{200, 100, 0};
  CHECK(colorOf(fusion.map().surfel(0).record) == first);
  frame.colors.assign(frame.depth_m.size(), {0, 100, 200});
  for (int i = 0; i < 60; ++i) fusion.fuse(smallCamera(), frame);
  const auto color = colorOf(fusion.map().surfel(0).record);
  CHECK(color[0] < 8);
  CHECK(color[1] == 100);
  CHECK(color[2] > 192);
}

TEST_CASE("a surface that moves less than the gate is tracked without overshoot") {
  FusionOptions options = smallMap();
  options.memory_frames = 10;
  FrameFusion fusion(options);
  DepthFrame frame{.depth_m = std::vector<float>(160 * 120, 1.0f), .pose = CameraPose{}};
  for (int i = 0; i < 30; ++i) fusion.fuse(smallCamera(), frame);
  std::ranges::fill(frame.depth_m, 1.001f);
  float before = 1.0f;
  for (int i = 0; i < 60; ++i) {
    fusion.fuse(smallCamera(), frame);
    const float now = fusion.map().surfel(80 * 60).place.z;
    CHECK(now >= before);
    CHECK(now <= 1.00101f);
    before = now;
  }
  CHECK(before > 1.00099f);
}

TEST_CASE("an invalid frame is refused with its reason, and the map stays unchanged") {
  auto fusion = fusedTable(2, 1);
  const SurfelMap before = fusion.map();
  const DepthFrame good = tableScene().frame(smallCamera(), onArc(kTable, 1.0, 0.5));
  const auto refused = [&](const DepthFrame& frame, const DepthCamera& camera, std::string_view why) {
    const FrameOutcome outcome = fusion.fuse(camera, frame);
    CHECK(outcome.fate == FrameFate::refused);
    CHECK_MESSAGE(outcome.why.find(why) != std::string::npos, outcome.why);
    CHECK(areSame(before, fusion.map()));
  };
  for (const float depth : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0f}) {
    DepthFrame bad = good;
    bad.depth_m[3 * 160 + 7] = depth;
    refused(bad, smallCamera(), "pixel (7, 3)");
  }
  DepthFrame cut = good, painted = good, turned = good, lost = good;
  cut.depth_m.pop_back();
  refused(cut, smallCamera(), "19199 depths");
  painted.colors.resize(5);
  refused(painted, smallCamera(), "5 colours");
  turned.pose->turn = DQuat(0.5, 0, 0, 0);
  refused(turned, smallCamera(), "not a rotation");
  lost.pose->centre.x = std::numeric_limits<double>::quiet_NaN();
  refused(lost, smallCamera(), "not a rotation");
  DepthCamera blind = smallCamera();
  blind.fx = 0;
  refused(good, blind, "focal lengths");
  blind = {};
  refused(good, blind, "0 x 0 pixels");
  CHECK(fusion.lost() == 9);
}

TEST_CASE("fusion options outside their bounds are refused by name") {
  const auto says = [](const FusionOptions& options, std::string_view field) {
    try {
      options.validate();
      FAIL("they were accepted");
    } catch (const Error& error) {
      CHECK_MESSAGE(std::string_view(error.what()).find(field) != std::string_view::npos, error.what());
    }
  };
  FusionOptions options;
  options.validate();
  options.capacity = 0;
  says(options, "capacity");
  options = {};
  options.farthest_m = 0.05;
  says(options, "farthest_m");
  options = {};
  options.noiseLeast_m = 0;
  says(options, "noiseLeast_m");
  options = {};
  options.memory_frames = std::numeric_limits<double>::quiet_NaN();
  says(options, "memory_frames");
}

}  // namespace palpate::surfel_map_test
