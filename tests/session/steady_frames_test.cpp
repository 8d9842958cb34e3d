// A hand held in a moving plane in front of a depth camera, in sessions on the CPU: no frame causes a step of force.
#include "engine/motion/depth_points.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "tests/labels.hpp"
#include "tests/motion/plane_stream.hpp"
#include "tests/near.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::steady_frames_test {

namespace {

constexpr double kDepth_m = 0.003, kStiffness_N_per_mm = 0.8;
constexpr double kForce_N = kStiffness_N_per_mm * 1000 * kDepth_m;

Model planeModel(const SeenPlane& seen, bool fused) {
  PlaneStream stream(seen);
  DepthFrame frame;
  stream.next(frame);
  Model model{.scale = {1000}, .spacing = PlaneStream::kSpacing_m, .wideSpacing = PlaneStream::kSpacing_m};
  if (fused) {
    FrameFusion fusion({});
    fusion.fuse(stream.camera(), frame);
    model.cloud = fusion.map().cloud();
  } else {
    CloudFrame points;
    DepthPoints().make(stream.camera(), frame, DVec3(0), points);
    placeAt(points, model.cloud);
  }
  model.source = CameraPoints{playedStream(std::make_shared<PlaneStream>(seen))};
  if (fused) model.stream()->player->nextDue(0);
  return model;
}

struct Felt {
  double knock_N = 0;     ///< largest change of the force between ticks
  double stretch_mm = 0;  ///< largest change of the vector from hand to proxy between ticks
  double mean_N = 0;
  std::size_t free = 0;  ///< ticks without contact
};

/// Evaluates the ticks after the hand has arrived.
Felt feel(const SeenPlane& seen, bool fused, double duration_s) {
  const auto cpu = cpuBackend();
  const SessionConfig config{.model = {.file = "plane", .mm_per_unit = 1000, .stream = StreamConfig{.fuse = fused}},
                             .backend = {.name = "cpu"},
                             .force = {.stiffness_N_per_mm = kStiffness_N_per_mm},
                             .duration_s = duration_s};
  std::vector<PathKey> keys;
  for (int tick = 0; 1e-3 * tick <= duration_s; ++tick)
    keys.push_back({1e-3 * tick, PlaneStream::heldAt(1e-3 * tick, kDepth_m, seen.normal())});
  Session session(config, planeModel(seen, fused), {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, Path(std::move(keys)));
  session.finish();
  Felt felt;
  const auto& rows = result.trace().rows;
  constexpr std::size_t kThere = 150;
  for (std::size_t i = kThere; i < rows.size(); ++i) {
    const TraceRow &now = rows[i], &before = rows[i - 1];
    const double stretch = glm::distance(now.proxy - now.hip, before.proxy - before.hip);
    felt.knock_N = std::max(felt.knock_N, glm::distance(now.force_N, before.force_N));
    felt.stretch_mm = std::max(felt.stretch_mm, 1000 * stretch);
    felt.mean_N += glm::length(now.force_N) / static_cast<double>(rows.size() - kThere);
    felt.free += !now.contact;
  }
  return felt;
}

struct Depths {
  double noise_m, rounded_m, mostKnock_N;
};
constexpr Depths kExact{0, 0, 0.01}, kFine{0, 0.0002, 0.06}, kCoarse{0, 0.001, 0.1}, kNoisy{0.001, 0, 0.2};

void check(const Depths& depths, double tilt_rad, bool fused, double duration_s) {
  CAPTURE(depths.noise_m);
  CAPTURE(depths.rounded_m);
  CAPTURE(tilt_rad);
  CAPTURE(fused);
  const Felt felt =
      feel({.tilt_rad = tilt_rad, .noise_m = depths.noise_m, .rounded_m = depths.rounded_m}, fused, duration_s);
  if (inFullTier())
    MESSAGE("noise ", 1e3 * depths.noise_m, " mm, rounded to ", 1e3 * depths.rounded_m, " mm, tilt ", tilt_rad,
            fused ? " rad, fused: " : " rad: ", felt.knock_N, " N and ", felt.stretch_mm, " mm in a tick, mean ",
            felt.mean_N, " N, ", felt.free, " ticks free");
  CHECK(felt.knock_N < (fused ? 0.06 : depths.mostKnock_N));
  // A map follows a moving plane with some delay.
  if (!fused) CHECK(felt.free == 0);
  if (!fused) CHECK(felt.mean_N == near(kForce_N, 0.03));
}

}  // namespace

TEST_CASE("a plane that moves before a depth camera causes no force steps, even if tilted, rounded or noisy") {
  for (const Depths& depths : {kFine, kNoisy})
    for (const double tilt_rad : {0.0, 0.3}) check(depths, tilt_rad, false, 0.5);
}

TEST_CASE("a fused map of a moving plane causes no force steps") {
  check(kExact, 0.3, true, 0.5);
  check(kNoisy, 0.3, true, 0.5);
}

TEST_CASE("frames of a plane cause no force steps, for four tilts and through a whole swing" * kFull) {
  for (const bool fused : {false, true})
    for (const Depths& depths : {kExact, kFine, kCoarse, kNoisy})
      for (const double tilt_rad : {0.0, 0.15, 0.3, 0.6}) check(depths, tilt_rad, fused, 2);
}

}  // namespace palpate::steady_frames_test
