// Sessions whose depth frames are fused into a map that is held, sculpted and handed over, on the CPU.
#include <thread>

#include "engine/motion/fused_source.hpp"
#include "tests/says.hpp"
#include "tests/session/wall_stream.hpp"

namespace palpate::fused_session_test {

namespace {

/// Poses are required, since a featureless wall does not determine them.
void writePoses(const std::filesystem::path& folder) {
  std::string log;
  for (int i = 0; i < kFrames; ++i) log += fmt::format("{0} {0} {1}\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", i, i + 1);
  writeBytes(folder / "trajectory.log", log);
}

const DVec3 kBeforeWall(0, 0, kRest_m - 0.01), kInWall(0, 0, kRest_m + 0.0005);

/// Into the wall, then at rest there until the end.
Path intoWall(double duration_s) {
  return Path({{0, kBeforeWall}, {0.3 * duration_s, kInWall}, {duration_s, kInWall}});
}

/// Nine points on a plane outside every view, one metre beside the wall.
constexpr std::size_t kBeside = 9;
void addBeside(PointCloud& cloud) {
  for (std::size_t i = 0; i < kBeside; ++i) {
    cloud.positions.emplace_back(1 + 0.002 * static_cast<double>(i % 3), 0.002 * static_cast<double>(i / 3), 0.25);
    cloud.normals.emplace_back(0, 0, -1);
    if (!cloud.colors.empty()) cloud.colors.push_back({1, 2, 3, 255});
  }
}

bool hasBeside(const PointCloud& cloud) {
  PointCloud truth;
  addBeside(truth);
  return std::ranges::all_of(truth.positions,
                             [&](const Vec3& place) { return std::ranges::count(cloud.positions, place) == 1; });
}

}  // namespace

TEST_CASE("a held stream passes from one session to the next together with the edited points") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.model.stream->fuse = true;
  config.duration_s = 0.075;  // frames 0 to 7
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  runAlone(session, intoWall(0.075));
  session.finish();
  CHECK(session.playCounts()->played == 8);
  Model next = session.model();
  next.source = CameraPoints{session.releaseStream(0.08)};
  REQUIRE(next.stream() != nullptr);
  CHECK(session.player() == nullptr);
  CHECK_FALSE(session.playCounts().has_value());
  CHECK(session.releaseStream(0.08) == nullptr);
  const PointCloud held = session.sculpted().cloud;
  next.cloud = held;
  addBeside(next.cloud);

  config.duration_s = 0.05;
  Session other(config, next, {.backend = *cpu, .threads = 1});
  CHECK_THROWS_WITH_AS(Session(config, next, {.backend = *cpu, .threads = 1}),
                       doctest::Contains("is played by another session"), Error);
  REQUIRE(other.player() != nullptr);
  CHECK(other.player()->isPaused());
  // Held: the map is the initial one.
  runAlone(other, intoWall(0.05));
  other.finish();
  CHECK(other.playCounts()->played == 8);
  CHECK(other.sculpted().cloud.positions == next.cloud.positions);
  // It continues after the eighth frame, and points outside every view stay.
  other.player()->play(0.06);
  runAlone(other, intoWall(0.05), {.begin_s = 0.06});
  other.finish();
  CHECK(other.playCounts()->played == 13);
  CHECK(other.playCounts()->lost == 0);
  const PointCloud end = other.sculpted().cloud;
  CHECK(end.positions != next.cloud.positions);
  CHECK(hasBeside(end));
  CHECK(session.sculpted().cloud.positions == held.positions);  // it has no more frames
  // The same in real time.
  Model live = other.model();
  live.cloud = end;
  live.source = CameraPoints{other.releaseStream(0.12)};
  config.duration_s = 0;
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession window(config, live, {.backend = *cpu, .threads = 1}, {.clock = clock});
  double until_s = 0.1;
  window.tickUntil(until_s);
  CHECK(window.session().playCounts()->played == 13);
  window.stepFrame();
  for (int guard = 0; guard < 20 && window.session().playCounts()->played < 14; ++guard)
    window.tickUntil(until_s += 0.05);
  CHECK(window.session().playCounts()->played == 14);
  CHECK(window.holdFrames() == false);
  for (int guard = 0; guard < 100 && window.session().playCounts()->played < 16; ++guard)
    window.tickUntil(until_s += 0.05);
  CHECK(window.session().playCounts()->played == 16);
  CHECK(window.releaseStream() != nullptr);
  CHECK_FALSE(window.holdFrames().has_value());
  window.tickUntil(until_s + 0.1);
  CHECK(window.isTouching());
}

TEST_CASE("held frames are handed on, sculpted, undone and handed back, and playback continues after them") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.model.stream->fuse = config.realtime = true;
  config.duration_s = 0;
  const auto clock = std::make_shared<SteppedClock>();
  auto playing = std::make_unique<InteractiveSession>(config, load(config), SessionParts{.backend = *cpu, .threads = 1},
                                                      InteractiveOptions{.clock = clock});
  CHECK_FALSE(playing->holdsFrames());
  CHECK_FALSE(playing->isHeldStill());
  double until_s = 0;
  for (int guard = 0; guard < 100 && playing->session().playCounts()->played < 4; ++guard)
    playing->tickUntil(until_s += 0.02);
  Model held = playing->handOn().model;
  playing.reset();
  REQUIRE(held.stream() != nullptr);
  const std::vector<Vec3> before = held.cloud.positions;
  CHECK(before.size() > 1000);
  const std::uint64_t played = held.stream()->player->counts().played;

  SessionConfig still = config;
  still.model.stream.reset();
  still.brush = BrushConfig{.kind = BrushKind::carve, .radius_mm = 30};
  const auto second = std::make_shared<SteppedClock>();
  auto sculpting = std::make_unique<InteractiveSession>(
      still, std::move(held), SessionParts{.backend = *cpu, .threads = 1}, InteractiveOptions{.clock = second});
  CHECK(sculpting->isHeldStill());
  CHECK_FALSE(sculpting->holdFrames().has_value());
  CHECK_THROWS_WITH_AS(sculpting->record((folder / "log").string()), doctest::Contains("save the points"), Error);
  sculpting->aim(DVec3(0, 0, kRest_m - 0.05));
  sculpting->tickUntil(until_s = 1);
  sculpting->aim(DVec3(0, 0, kRest_m + 0.01));
  for (int guard = 0; guard < 100 && sculpting->edits() == 0; ++guard) sculpting->tickUntil(until_s += 0.05);
  REQUIRE(sculpting->edits() > 0);
  sculpting->lift();
  sculpting->tickUntil(until_s += 0.1);
  CHECK(sculpting->isChanged());
  Model carved = sculpting->handOn().model;
  sculpting.reset();
  REQUIRE(carved.stream() != nullptr);
  CHECK(carved.cloud.positions != before);

  const auto third = std::make_shared<SteppedClock>();
  InteractiveSession goingOn(config, carved, {.backend = *cpu, .threads = 1}, {.clock = third});
  CHECK(goingOn.holdsFrames());
  goingOn.tickUntil(0.05);
  CHECK(goingOn.session().playCounts()->played == played);
  CHECK(goingOn.holdFrames() == false);
  until_s = 0.05;
  for (int guard = 0; guard < 100 && goingOn.session().playCounts()->played < played + 2; ++guard)
    goingOn.tickUntil(until_s += 0.02);
  CHECK(goingOn.session().playCounts()->played >= played + 2);
  CHECK(goingOn.isTouching());
}

TEST_CASE("a back end that fuses frames itself receives the stream and no source") {
  struct Fusing final : BackendKind {
    std::string_view name() const override { return "fusing"; }
    const std::vector<std::string>& methods() const override { return cpu->methods(); }
    TouchCapabilities capabilities() const override { return {.fusesFrames = true}; }
    std::string machine(unsigned threads) const override { return cpu->machine(threads); }
    std::unique_ptr<TouchBackend> make(const BackendRequest& request) const override {
      CHECK(request.source == nullptr);
      if (request.fusion) source = std::make_unique<FusedSource>(*request.fusion);
      begun = request.fusion && request.fusion->begin.get() == &request.model.cloud;
      BackendRequest asked = request;
      asked.source = source.get();
      return cpu->make(asked);
    }
    std::unique_ptr<BackendKind> cpu = cpuBackend();
    mutable std::unique_ptr<FusedSource> source;
    mutable bool begun = false;
  } fusing;
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  SessionConfig config = playing(folder.path());
  config.model.stream->fuse = true;
  const auto cpu = cpuBackend();
  Session own(config, load(config), {.backend = *cpu, .threads = 1});
  config.backend.name = "fusing";
  Session given(config, load(config), {.backend = fusing, .threads = 1});
  CHECK(fusing.begun);
  CHECK(sameTrace(runAlone(own, intoWall(kDuration_s)).trace(), runAlone(given, intoWall(kDuration_s)).trace()));
  CHECK(given.playCounts()->played == kFrames);
  CHECK(given.player() != nullptr);
}

TEST_CASE("several sessions of one model each play a fused recording from its start") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  std::filesystem::resize_file(folder / "depth" / "0000.png", 200);
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.model.stream->fuse = true;
  const auto model = std::make_shared<const Model>(load(config));
  Session one(config, model, {.backend = *cpu, .threads = 1}), other(config, model, {.backend = *cpu, .threads = 1});
  const Trace first = runAlone(one, intoWall(kDuration_s)).trace(),
              second = runAlone(other, intoWall(kDuration_s)).trace();
  CHECK(sameTrace(first, second));
  CHECK(summarize(first).contactTicks > 60);
  CHECK(one.playCounts()->played == kFrames - 1);
  CHECK(one.playCounts()->lost == 1);
}

TEST_CASE("a live fused camera continues after the frame that was the model, until it ends") {
  const auto stream = std::make_shared<LiveStream>(kCamera);
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  SessionConfig config = playing(folder.path());
  config.model.stream->fuse = true;
  Model model = load(config);
  const CameraPose pose{};
  model.source = CameraPoints{
      playedStream(stream, {.exact = false}, DepthFrame{.number = 0, .depth_m = wall(kRest_m), .pose = pose})};
  model.stream()->seenFrom = pose;
  config.model.file = "-";
  config.model.stream->live = config.realtime = true;
  config.duration_s = 0;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession session(config, model, {.backend = *cpu, .threads = 1}, {.clock = clock});
  double until_s = 0.2;
  session.tickUntil(until_s);
  CHECK(session.session().playCounts()->played == 1);
  for (std::uint64_t k = 1; k <= 3; ++k) {
    stream->give({.time_s = 0.03 * static_cast<double>(k), .number = k, .depth_m = wall(kRest_m), .pose = pose});
    for (int guard = 0; guard < 200 && session.session().playCounts()->played < 1 + k; ++guard)
      session.tickUntil(until_s += 0.05);
    CHECK(session.session().playCounts()->played == 1 + k);
  }
  stream->give({.time_s = 0.2, .number = 4, .depth_m = wall(kRest_m)});  // a wall does not determine the camera's pose
  for (int guard = 0; guard < 200 && session.session().playCounts()->lost == 0; ++guard)
    session.tickUntil(until_s += 0.05);
  CHECK(session.session().playCounts()->lost == 1);
  CHECK(session.session().playCounts()->played == 4);
  stream->end();
  session.tickUntil(until_s + 2.5);
  CHECK(session.isTouching());
  CHECK(session.session().playCounts()->silentSince_s.has_value());
}

TEST_CASE("fused frames are felt as the map they form, and a session with them is replayed from its text") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.model.stream->fuse = true;
  CHECK(parseConfig(configText(config)) == config);
  const Model model = load(config);
  CHECK(model.cloud.size() > 1'000);
  CHECK(model.upright.up == UpAxis::minusY);
  // On the wall, and half a millimetre into it, twice its noise: the map follows it partially.
  const DVec3 before(0, 0, kRest_m - 0.01), in(0, 0, kRest_m + 0.0005);
  const auto play = [&](const SessionConfig& played) {
    Session session(played, load(played), {.backend = *cpu, .threads = 1});
    const Trace trace = runAlone(session, Path({{0, before}, {0.05, in}, {kDuration_s, in}})).trace();
    CHECK(session.playCounts()->played == kFrames);
    CHECK(session.playCounts()->lost == 0);
    CHECK(session.sculpted().cloud.size() >= model.cloud.size());
    return trace;
  };
  const Trace first = play(config), again = play(parseConfig(configText(config)));
  CHECK(sameTrace(first, again));
  CHECK(summarize(first).contactTicks > 60);
  for (const TraceRow& row : first.rows)
    if (row.contact) {
      CHECK(row.proxy.z < kRest_m + 0.0005);
      CHECK(row.proxy.z > kRest_m - 0.0025);
    }
  config.model.stream->fuse = false;
  Session newest(config, load(config), {.backend = *cpu, .threads = 1});
  CHECK_FALSE(sameTrace(first, runAlone(newest, Path({{0, before}, {0.05, in}, {kDuration_s, in}})).trace()));
}

}  // namespace palpate::fused_session_test
