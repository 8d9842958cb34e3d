// Poses found against a map: their accuracy, and that a search that cannot succeed reports it.
#include "engine/motion/icp.hpp"

#include <doctest/doctest.h>

#include <random>

#include "engine/core/error.hpp"
#include "engine/motion/fusion.hpp"
#include "tests/motion/depth_scene.hpp"
#include "tests/near.hpp"

namespace palpate::icp_test {

namespace {

const DVec3 kTable(0, 0, 0.02);

// A map of the scene, from its true poses.
FrameFusion mapped(const DepthScene& scene, double noise, std::uint64_t frames = 8) {
  FrameFusion fusion(smallMap());
  for (std::uint64_t i = 0; i < frames; ++i)
    fusion.fuse(smallCamera(),
                scene.frame(smallCamera(), onArc(kTable, 1.0, 0.45 + 0.01 * static_cast<double>(i)), noise, i));
  return fusion;
}

struct Error6 {
  double shift_mm = 0, turn_deg = 0;
};

Error6 between(const CameraPose& a, const CameraPose& b) {
  const DQuat turn = glm::conjugate(a.turn) * b.turn;
  return {1000 * glm::distance(a.centre, b.centre),
          2 * std::asin(std::min(1.0, glm::length(DVec3(turn.x, turn.y, turn.z)))) * 180 / 3.14159265358979};
}

IcpResult search(const SurfelMap& map, const DepthFrame& frame, const CameraPose& expected,
                 const IcpOptions& options = {}) {
  FrameImages images;
  std::vector<shared::PixelSurface> surfaces;
  readFrame(smallCamera(), frame, map.options(), images);
  findPixelSurfaces(images, map.options(), surfaces);
  return findPose(map, images, surfaces, expected, options);
}

CameraPose moved(const CameraPose& pose, const DVec3& shift, const DVec3& turn_deg) {
  const double angle = glm::length(turn_deg) * 3.14159265358979 / 180;
  const DQuat turn = angle > 0 ? glm::angleAxis(angle, glm::normalize(turn_deg)) : DQuat(1, 0, 0, 0);
  return {.turn = glm::normalize(turn * pose.turn), .centre = pose.centre + shift};
}

}  // namespace

TEST_CASE("known camera motions are recovered, with and without noise") {
  const DepthScene scene = tableScene();
  const CameraPose truth = onArc(kTable, 1.0, 0.5);
  const std::array<std::pair<DVec3, DVec3>, 4> motions{{{DVec3(0), DVec3(0)},
                                                        {DVec3(0.01, -0.005, 0.008), DVec3(0.5, -1, 0.7)},
                                                        {DVec3(-0.015, 0.012, -0.02), DVec3(1, 1, -1)},
                                                        {DVec3(0.02, 0.02, 0.01), DVec3(-1, 0.5, 1)}}};
  for (const double noise : {0.0, 1.0}) {
    const FrameFusion fusion = mapped(scene, noise);
    const DepthFrame frame = scene.frame(smallCamera(), truth, noise, 77);
    for (const auto& [shift, turn] : motions) {
      const IcpResult result = search(fusion.map(), frame, moved(truth, shift, turn));
      CHECK_MESSAGE(result.state == IcpState::found, result.why());
      const Error6 error = between(result.pose, truth);
      MESSAGE("noise " << noise << ": error " << error.shift_mm << " mm, " << error.turn_deg << " degrees; matched "
                       << result.matched << ", residual " << result.residual << ", weakest " << result.weakest
                       << ", feigned " << result.feigned);
      CHECK(error.shift_mm < 1);
      CHECK(error.turn_deg < 0.1);
    }
  }
}

TEST_CASE("a plane leaves the camera's position along it unknown, and the result is degenerate") {
  DepthScene plane;
  plane.add("plane", 3, DVec3(0));
  const CameraPose truth = onArc(kTable, 1.0, 0.5);
  for (const auto& [noise, frames] : {std::pair(0.0, 4), {1.0, 1}, {1.0, 2}, {1.0, 8}}) {
    const FrameFusion fusion = mapped(plane, noise, static_cast<std::uint64_t>(frames));
    const CameraPose expected = moved(truth, {0.01, 0, 0.005}, {0, 0, 0.5});
    const IcpResult result = search(fusion.map(), plane.frame(smallCamera(), truth, noise, 77), expected);
    CHECK_MESSAGE(result.state == IcpState::degenerate, result.why());
    MESSAGE(result.why());
    // The pose has moved onto the plane and has not slid along it.
    CHECK(std::abs(result.pose.centre.z - truth.centre.z) < 0.002);
    CHECK(glm::length(DVec2(result.pose.centre - expected.centre)) < 0.002);
    CHECK(result.why().find("plane") != std::string::npos);
  }
}

TEST_CASE("a pose is not found outside the map, with a large residual or beyond the maximum step") {
  const DepthScene scene = tableScene();
  const CameraPose truth = onArc(kTable, 1.0, 0.5);
  const FrameFusion fusion = mapped(scene, 1);
  DepthScene other;
  other.add("sphere", 0.3, {0.5, 0.3, 0.6});
  const IcpResult elsewhere =
      search(fusion.map(), other.frame(smallCamera(), lookingAt({0.5, -0.5, 0.9}, {0.5, 0.3, 0.6}), 1, 5),
             lookingAt({0.5, -0.5, 0.9}, {0.5, 0.3, 0.6}));
  CHECK_MESSAGE(elsewhere.state == IcpState::tooFewMatches, elsewhere.why());
  IcpOptions still;
  still.longestStep_m = 0.005;
  const DepthFrame frame = scene.frame(smallCamera(), truth, 1, 77);
  const IcpResult jumped = search(fusion.map(), frame, moved(truth, {0.02, 0, 0}, DVec3(0)), still);
  CHECK_MESSAGE(jumped.state == IcpState::jumped, jumped.why());
  CHECK(jumped.step_m > 0.018);
  IcpOptions strict;
  strict.largestResidual = 0.01;
  const IcpResult off = search(fusion.map(), frame, truth, strict);
  CHECK_MESSAGE(off.state == IcpState::tooFar, off.why());
}

TEST_CASE("pose search samples every n-th pixel, from the first row to the last") {
  const DepthScene scene = tableScene();
  const CameraPose truth = onArc(kTable, 1.0, 0.5);
  const FrameFusion fusion = mapped(scene, 0, 1);
  DepthFrame frame = scene.frame(smallCamera(), truth);
  std::fill_n(frame.depth_m.begin(), 90 * 160, 0.0f);  // valid depths begin below the middle
  FrameImages images;
  std::vector<shared::PixelSurface> surfaces;
  readFrame(smallCamera(), frame, fusion.map().options(), images);
  findPixelSurfaces(images, fusion.map().options(), surfaces);
  const MapPairs pairs(fusion.map(), images, surfaces, truth);
  for (const std::uint32_t stride : {1u, 2u, 4u, 7u}) {
    std::uint64_t seen = 0;
    for (std::size_t y = 0; y < 120; y += stride)
      for (std::size_t x = 0; x < 160; x += stride) seen += surfaces[y * 160 + x].depth > 0 ? 1 : 0;
    const IcpSums sums = pairs.sum({.level = {.stride = stride, .gate_m = 0.05}, .pose = truth});
    CHECK(seen > 50);
    CHECK(sums.seen == seen);
    CHECK(static_cast<double>(sums.pairs) > 0.9 * static_cast<double>(seen));
  }
}

TEST_CASE("a found pose is the same with any number of threads") {
  const DepthScene scene = tableScene();
  const CameraPose truth = onArc(kTable, 1.0, 0.5);
  const DepthFrame frame = scene.frame(smallCamera(), truth, 1, 77);
  std::vector<CameraPose> found;
  for (const unsigned threads : {1u, 3u}) {
    FusionOptions options = smallMap();
    options.threads = threads;
    FrameFusion fusion(options);
    fusion.fuse(smallCamera(), scene.frame(smallCamera(), truth, 1, 0));
    const IcpResult result = search(fusion.map(), frame, moved(truth, {0.01, 0, 0}, {0, 0, 1}));
    REQUIRE(result.state == IcpState::found);
    found.push_back(result.pose);
  }
  CHECK(found[0].centre == found[1].centre);
  CHECK(found[0].turn == found[1].turn);
}

TEST_CASE("frames without poses give a map as accurate as the drift of their poses") {
  const DepthScene scene = tableScene();
  FrameFusion fusion(smallMap());
  CameraPose last;
  for (std::uint64_t i = 0; i < 16; ++i) {
    const CameraPose truth = onArc(kTable, 1.0, 0.4 + 0.01 * static_cast<double>(i));
    DepthFrame frame = scene.frame(smallCamera(), truth, 1, i);
    if (i > 0) frame.pose.reset();
    const FrameOutcome& outcome = fusion.fuse(smallCamera(), frame);
    CHECK_MESSAGE(outcome.fate == FrameFate::fused, outcome.why);
    last = truth;
    if (i < 15) continue;
    const Error6 error = between(outcome.pose, truth);
    MESSAGE("after " << i << " frames: error " << error.shift_mm << " mm, " << error.turn_deg << " degrees");
    CHECK(error.shift_mm < 3);
    CHECK(error.turn_deg < 0.3);
  }
}

TEST_CASE("a frame without a found pose is reported and leaves the map unchanged, and the next one is found") {
  const DepthScene scene = tableScene();
  DepthScene other;
  other.add("plane", 3, {0, 0, -0.5});
  FrameFusion fusion = mapped(scene, 1);
  const SurfelMap before = fusion.map();
  DepthFrame lost = other.frame(smallCamera(), onArc(kTable, 1.0, 0.5), 1, 20);
  lost.pose.reset();
  const FrameOutcome outcome = fusion.fuse(smallCamera(), lost);
  CHECK(outcome.fate == FrameFate::unplaced);
  CHECK_FALSE(outcome.why.empty());
  CHECK(fusion.unplaced() == 1);
  CHECK(areSame(before, fusion.map()));
  DepthFrame next = scene.frame(smallCamera(), onArc(kTable, 1.0, 0.52), 1, 21);
  next.pose.reset();
  CHECK(fusion.fuse(smallCamera(), next).fate == FrameFate::fused);
}

TEST_CASE("a system of six equations is solved, and its eigenvalues and eigenvectors are right") {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  NormalEquations::Row truth{};
  for (double& x : truth) x = normal(random);
  NormalEquations equations;
  for (int i = 0; i < 40; ++i) {
    NormalEquations::Row row{};
    double residual = 0;
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k] = normal(random) * std::pow(10.0, -static_cast<double>(k));
      residual -= row[k] * truth[k];
    }
    equations.add(row, residual, 1 + std::abs(normal(random)));
  }
  const Eigen6 eigen = eigenSymmetric(equations.matrix);
  const NormalEquations::Row found = solve(equations);
  for (std::size_t k = 0; k < found.size(); ++k) {
    CHECK(found[k] == within(truth[k], 1e-6));
    // A v = lambda v.
    for (std::size_t i = 0; i < found.size(); ++i) {
      double product = 0;
      for (std::size_t j = 0; j < found.size(); ++j) product += equations.matrix[i][j] * eigen.vectors[k][j];
      CHECK(std::abs(product - eigen.values[k] * eigen.vectors[k][i]) < 1e-12 * eigen.values.back());
    }
    if (k > 0) CHECK(eigen.values[k] >= eigen.values[k - 1]);
  }
}

}  // namespace palpate::icp_test
