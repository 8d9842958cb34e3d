// Sessions whose model is a depth camera, recorded or live, on the CPU.
#include <doctest/doctest.h>

#include <cmath>
#include <thread>

#include "engine/cloud/up.hpp"
#include "engine/motion/fused_source.hpp"
#include "haptics/session/live_session.hpp"
#include "tests/motion/depth_stream.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate {

namespace {

constexpr DepthCamera kCamera{.width = 40, .height = 30, .fx = 100, .fy = 100, .cx = 19.5, .cy = 14.5};
constexpr double kRest_m = 0.5, kRate_Hz = 100, kDuration_s = 0.16, kHand_mm = 0.2;
constexpr double kRounded_mm = 0.02;  // depths
constexpr int kFrames = 16;

/// How far a wall has come towards the camera in a frame.
double nearer_mm(int frame) { return 1 - std::cos(2 * 3.14159265358979 * frame / kFrames); }

/// And as it is felt, that many frames after the first one: it goes from frame to frame, one behind.
double felt_mm(double place) {
  const int frame = std::min(kFrames - 1, static_cast<int>(std::floor(place + 1e-9)));
  if (frame == 0) return 0;
  return nearer_mm(frame - 1) + std::min(1.0, place - frame) * (nearer_mm(frame) - nearer_mm(frame - 1));
}

std::vector<float> wall(double depth_m) {
  return std::vector<float>(std::size_t{kCamera.width} * kCamera.height, static_cast<float>(depth_m));
}

/// A wall before a camera that stands still in the middle of the world, in fiftieths of a millimetre.
void writeWall(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "depth");
  for (int i = 0; i < kFrames; ++i)
    writeBytes(folder / "depth" / fmt::format("{:04}.png", i),
               depthPng(kCamera, wall(kRest_m - 1e-3 * nearer_mm(i)), 50'000));
  writeBytes(folder / "intrinsics.json", intrinsicsJson(kCamera, R"(, "depth_scale": 50000, "fps": 100)"));
}

SessionConfig playing(const std::filesystem::path& folder) {
  return {.model = {.file = folder.string(), .mm_per_unit = 1000},
          .backend = {.name = "cpu"},
          .force = {.stiffness_N_per_mm = 0.5, .damping_N_s_per_mm = 0},
          .stream = StreamConfig{},
          .duration_s = kDuration_s};
}

/// Just before the wall where it rests.
Path atRest(double duration_s = kDuration_s) {
  const DVec3 hip(0, 0, kRest_m - 1e-3 * kHand_mm);
  return Path({{0, hip}, {duration_s, hip}});
}

Model load(const SessionConfig& config) {
  Log log(true);
  return loadModel(config, {.log = log, .threads = 1});
}

std::string refusal(auto&& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "done";
}

}  // namespace

TEST_CASE("the first frame of a recording is the model, in metres, with what is up") {
  const ScratchFolder folder;
  writeWall(folder.path());
  const Model model = load(playing(folder.path()));
  CHECK(model.cloud.size() == 40 * 30);
  CHECK(model.cloud.positions[0].z == 0.5f);
  CHECK(model.cloud.normals[0] == Vec3(0, 0, -1));
  CHECK_FALSE(model.cloud.hasColors());
  CHECK(model.upright.up == UpAxis::minusY);
  CHECK(model.cloud.storedAs.comments ==
        std::vector<std::string>{"comment units: m", "comment up: -y", "comment mm_per_unit: 1000"});
  CHECK(model.spacing == doctest::Approx(0.005).epsilon(0.05));
  CHECK(model.stream == nullptr);

  const ScratchFolder colored;
  writeRedwood(colored.path());
  std::filesystem::remove(colored / "depth" / "00000.png");
  SessionConfig config = playing(colored.path());
  const Model second = load(config);
  CHECK(second.cloud.hasColors());
  CHECK(second.cloud.colors[0][2] == 1);  // the first frame that could be read
  const CameraFrustum frustum = frustumOf(recordedCamera(), recordedPose(1.0 / 30));
  REQUIRE(second.cameras.size() == 1);
  CHECK(glm::distance(second.cameras[0].centre, frustum.centre) < 1e-6);
  for (std::size_t k = 0; k < 4; ++k) CHECK(glm::distance(second.cameras[0].corners[k], frustum.corners[k]) < 1e-6);
}

TEST_CASE("a world far from zero keeps its detail") {
  const ScratchFolder folder;
  writeWall(folder.path());
  std::string log;
  for (int i = 0; i < kFrames; ++i)
    log += fmt::format("{0} {0} {1}\n1 0 0 500000\n0 1 0 4000000\n0 0 1 0\n0 0 0 1\n", i, i + 1);
  writeBytes(folder / "trajectory.log", log);
  const SessionConfig config = playing(folder.path());
  const Model model = load(config);
  CHECK(glm::distance(model.cloud.fileCoordinates(0),
                      DVec3(500'000 - 0.5 * 19.5 / 100, 4'000'000 - 0.5 * 14.5 / 100, 0.5)) < 1e-6);
  const auto cpu = cpuBackend();
  Session session(config, model, {.backend = *cpu, .threads = 1});
  const DVec3 hip(500'000, 4'000'000, kRest_m - 1e-3 * kHand_mm);
  const ServoResult result = runAlone(session, Path({{0, hip}, {kDuration_s, hip}}));
  CHECK(summarize(result.trace()).contactTicks > 80);
}

TEST_CASE(
    "a hand at rest feels stiffness times the depth of a wall that goes from frame to frame, and nothing once it is gone") {
  const ScratchFolder folder;
  writeWall(folder.path());
  const auto cpu = cpuBackend();
  for (const double speed : {1.0, 2.0}) {
    SessionConfig config = playing(folder.path());
    config.stream->speed = speed;
    config.duration_s = speed > 1 ? 2 * kDuration_s : kDuration_s;
    Session session(config, load(config), {.backend = *cpu, .threads = 1});
    const ServoResult result = runAlone(session, atRest(config.duration_s));
    session.finish();
    double worst_N = 0;
    std::size_t pushed = 0, free = 0, wrong = 0;
    for (const TraceRow& row : result.trace().rows) {
      CHECK(row.valid);
      const double depth_mm = felt_mm(speed * row.time_s * kRate_Hz) - kHand_mm, felt_N = glm::length(row.force_N);
      worst_N = std::max(worst_N, std::abs(felt_N - 0.5 * std::max(0.0, depth_mm)));
      pushed += felt_N > 0.1;
      free += depth_mm < 0;
      wrong += depth_mm < -kRounded_mm && felt_N != 0;
    }
    CHECK(pushed > 50);
    CHECK(free > 20);
    CHECK(wrong == 0);
    CHECK(worst_N < 0.55 * kRounded_mm);
    const auto counts = session.playCounts();
    REQUIRE(counts.has_value());
    CHECK(counts->played == kFrames);
    CHECK(counts->lost == 0);
    // Points are where they set out, until no other frame has come for a while.
    const int last = speed > 1 ? 15 : 14;
    CHECK(session.sculpted().cloud.positions[7].z == doctest::Approx(kRest_m - 1e-3 * nearer_mm(last)).epsilon(1e-5));
  }
}

TEST_CASE("a loop goes on where the recording ends") {
  const ScratchFolder folder;
  writeWall(folder.path());
  SessionConfig config = playing(folder.path());
  config.stream->loop = true;
  config.duration_s = 2.5 * kDuration_s;
  const auto cpu = cpuBackend();
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, atRest(config.duration_s));
  const auto& rows = result.trace().rows;
  REQUIRE(rows.size() > 400);
  for (std::size_t tick = 30; tick < 160; ++tick)
    CHECK(glm::length(rows[tick].force_N) == doctest::Approx(glm::length(rows[tick + 160].force_N)));
}

TEST_CASE("a lost frame leaves the one before, and the session goes on") {
  const ScratchFolder folder;
  writeWall(folder.path());
  std::filesystem::resize_file(folder / "depth" / "0008.png", 200);
  const SessionConfig config = playing(folder.path());
  const auto cpu = cpuBackend();
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, atRest());
  const auto& rows = result.trace().rows;
  // The next one is known to be due at 90 ms: until then the surface goes where frame 7 has it.
  for (std::size_t tick = 74; tick < 89; ++tick) {
    const double share = (static_cast<double>(tick) - 70) / 20;
    const double depth_mm = nearer_mm(6) + share * (nearer_mm(7) - nearer_mm(6)) - kHand_mm;
    CHECK(glm::length(rows[tick].force_N) == doctest::Approx(0.5 * depth_mm).epsilon(0.02));
  }
  CHECK(session.playCounts()->lost == 1);
  CHECK(says(session.playCounts()->lastLoss, "0008.png: byte 200: ends within the picture"));
}

TEST_CASE("a recorded session with a recorded camera is run again with its configuration alone") {
  const ScratchFolder folder;
  writeWall(folder / "wall");
  const std::string log = (folder / "log").string();
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder / "wall");
  config.stream->speed = 1.7;
  Session session(config, load(config), {.backend = *cpu, .threads = 1, .journal = true});
  const ServoResult result = runRecorded(session, log, atRest());
  SessionRecord record = readSessionLog(log);
  const RecordedSession recorded = parseHeader(log, record.text);
  CHECK(recorded.config == config);
  Session again(recorded.config, load(recorded.config), {.backend = *cpu, .threads = 1, .journal = true});
  CHECK(summarize(result.trace()).contactTicks > 60);
  CHECK(sameTrace(result.trace(), runAgain(again, std::move(record), recorded).trace()));
}

TEST_CASE("the text of a configuration has a stream only where there is one") {
  CHECK(configText({}).find("stream") == std::string::npos);
  SessionConfig config;
  config.stream = StreamConfig{.speed = 0.3, .loop = true, .depthScale = 5000, .intrinsics = "c.json"};
  CHECK(parseConfig(configText(config)) == config);
  config.stream = StreamConfig{.live = true};
  config.realtime = true;
  CHECK(parseConfig(configText(config)) == config);
  SessionConfig usual;
  usual.stream.emplace();
  CHECK(parseConfig(R"({"version": 1, "stream": {}})") == usual);
  CHECK(parseConfig(R"({"version": 1, "stream": null})") == SessionConfig{});
}

TEST_CASE("what does not go with a stream is refused by the name of the field") {
  const auto with = [](auto&& change) {
    SessionConfig config = playing("folder");
    change(config);
    try {
      validate(config);
    } catch (const ConfigError& error) {
      return error.field();
    }
    return std::string();
  };
  CHECK(with([](auto&) {}).empty());
  CHECK(with([](auto& c) { c.stream->speed = 0; }) == "stream.speed");
  CHECK(with([](auto& c) { c.stream->speed = std::nan(""); }) == "stream.speed");
  CHECK(with([](auto& c) { c.stream->depthScale = 0.001; }) == "stream.depth_scale");
  CHECK(with([](auto& c) { c.brush.emplace(); }) == "brush.kind");
  CHECK(with([](auto& c) { c.motion.emplace(); }) == "motion.kind");
  CHECK(with([](auto& c) { c.model.normals = NormalSource::estimate; }) == "model.normals");
  const auto live = [&](auto&& change) {
    return with([&](auto& c) {
      c.stream->live = c.realtime = true;
      change(c);
    });
  };
  CHECK(live([](auto&) {}).empty());
  CHECK(live([](auto& c) { c.stream->speed = 2; }) == "stream.speed");
  CHECK(live([](auto& c) { c.stream->loop = true; }) == "stream.loop");
  CHECK(live([](auto& c) { c.realtime = false; }) == "realtime");
}

TEST_CASE("what cannot be a model says what it is") {
  const ScratchFolder folder;
  writeWall(folder.path());
  const SessionConfig config = playing(folder.path());
  Log log(true);
  CHECK(says(refusal([&] { loadModel(config.model, {.log = log}); }), "is a recorded depth camera, and not one cloud"));
  SessionConfig live = config;
  live.stream->live = live.realtime = true;
  live.model.file = "/dev/null";
  CHECK(says(refusal([&] { load(live); }), "stream.intrinsics: /dev/null says none; give a JSON file"));
  live.model.file = "-";
  live.stream->intrinsics = "camera.json";
  CHECK(says(refusal([&] { load(live); }), "stream.intrinsics: raw frames say them in their first line"));
  for (int i = 0; i < kFrames; ++i)  // specks, of which none has a neighbour
    writeBytes(folder / "depth" / fmt::format("{:04}.png", i), [] {
      std::vector<float> depth_m(std::size_t{kCamera.width} * kCamera.height);
      depth_m[500] = 1;
      return depthPng(kCamera, depth_m, 50'000);
    }());
  CHECK(says(refusal([&] { load(config); }), "ends without a frame that has points"));
}

TEST_CASE("frames of a recording are held, stepped and let go on under a hand") {
  const ScratchFolder folder;
  writeWall(folder.path());
  SessionConfig config = playing(folder.path());
  config.duration_s = 0;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  LiveSession session(config, load(config), {.backend = *cpu, .threads = 1}, {.clock = clock});
  session.aim({0, 0, kRest_m - 1e-3 * kHand_mm});
  CHECK(session.holdFrames() == true);
  session.tickUntil(1);
  CHECK(session.playCounts()->played == 1);
  const auto isTouched = [&] { return session.history().rows().back().contact; };
  CHECK_FALSE(isTouched());
  double until_s = 1;
  for (int step = 1; step <= 6; ++step) {
    session.stepFrame();
    session.tickUntil(until_s += 0.3);
    CHECK(session.playCounts()->played == static_cast<std::uint64_t>(1 + step));
  }
  CHECK(isTouched());
  CHECK(session.holdFrames() == false);
  for (int guard = 0; guard < 50 && isTouched(); ++guard) session.tickUntil(until_s += 0.1);
  CHECK_FALSE(isTouched());  // the last frame has the wall back where it was
  LiveSession still({.model = {}, .backend = {.name = "cpu"}}, sphereModel(), {.backend = *cpu, .threads = 1}, {});
  CHECK_FALSE(still.holdFrames().has_value());
  still.stepFrame();
}

TEST_CASE("a live camera is felt as it sees: its newest frame, from the one that was the model on") {
  const auto stream = std::make_shared<LiveStream>(kCamera);
  DepthFrame first{.time_s = 3, .number = 0, .depth_m = wall(kRest_m)};
  const ScratchFolder folder;
  writeWall(folder.path());
  Model model = load(playing(folder.path()));
  model.stream = playedStream(stream, {.exact = false}, first);
  SessionConfig config = playing("-");
  config.stream->live = true;
  config.realtime = true;
  config.duration_s = 0;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  LiveSession session(config, model, {.backend = *cpu, .threads = 1}, {.clock = clock});
  CHECK_THROWS_WITH_AS(session.record((folder / "log").string()), doctest::Contains("a live camera cannot be recorded"),
                       Error);
  CHECK_THROWS_AS(Session(config, model, {.backend = *cpu, .threads = 1}), Error);  // it is taken
  session.aim({0, 0, kRest_m - 1e-3 * kHand_mm});
  session.tickUntil(0.3);
  const auto touched = [&] {
    return std::ranges::count_if(session.history().rows(), [](const TraceRow& row) { return row.contact; });
  };
  CHECK(touched() == 0);
  for (int k = 1; k <= 5; ++k)
    stream->give(
        {.time_s = 3 + 0.03 * k, .number = static_cast<std::uint64_t>(k), .depth_m = wall(kRest_m - 2e-4 * k)});
  double until_s = 0.3;
  for (int guard = 0; guard < 200 && touched() == 0; ++guard) session.tickUntil(until_s += 0.05);
  CHECK(touched() > 0);
  const auto counts = session.playCounts();
  REQUIRE(counts.has_value());
  CHECK(counts->played + counts->dropped == 6);
}

namespace {

/// A wall without a feature does not say where it was seen from.
void writePoses(const std::filesystem::path& folder) {
  std::string log;
  for (int i = 0; i < kFrames; ++i) log += fmt::format("{0} {0} {1}\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", i, i + 1);
  writeBytes(folder / "trajectory.log", log);
}

const DVec3 kBeforeWall(0, 0, kRest_m - 0.01), kInWall(0, 0, kRest_m + 0.0005);

/// Into the wall, and at rest there until the end.
Path intoWall(double duration_s) {
  return Path({{0, kBeforeWall}, {0.3 * duration_s, kInWall}, {duration_s, kInWall}});
}

/// Nine points on a plane that no camera looks at, one metre beside the wall.
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

TEST_CASE("a stream that is held goes from one session to the next, with the points that were changed in between") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.stream->fuse = true;
  config.duration_s = 0.075;  // frames 0 to 7
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  runAlone(session, intoWall(0.075));
  session.finish();
  CHECK(session.playCounts()->played == 8);
  Model next = session.model();
  next.stream = session.releaseStream(0.08);
  REQUIRE(next.stream != nullptr);
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
  // Held: the map is the one that it began with.
  runAlone(other, intoWall(0.05));
  other.finish();
  CHECK(other.playCounts()->played == 8);
  CHECK(other.sculpted().cloud.positions == next.cloud.positions);
  // It goes on behind the eighth frame, and what no camera sees stays.
  other.player()->play(0.06);
  runAlone(other, intoWall(0.05), {.begin_s = 0.06});
  other.finish();
  CHECK(other.playCounts()->played == 13);
  CHECK(other.playCounts()->lost == 0);
  const PointCloud end = other.sculpted().cloud;
  CHECK(end.positions != next.cloud.positions);
  CHECK(hasBeside(end));
  CHECK(session.sculpted().cloud.positions == held.positions);  // which has no more frames
  // Against the clock as well.
  Model live = other.model();
  live.cloud = end;
  live.stream = other.releaseStream(0.12);
  config.duration_s = 0;
  const auto clock = std::make_shared<SteppedClock>();
  LiveSession window(config, live, {.backend = *cpu, .threads = 1}, {.clock = clock});
  double until_s = 0.1;
  window.tickUntil(until_s);
  CHECK(window.playCounts()->played == 13);
  window.stepFrame();
  for (int guard = 0; guard < 20 && window.playCounts()->played < 14; ++guard) window.tickUntil(until_s += 0.05);
  CHECK(window.playCounts()->played == 14);
  CHECK(window.holdFrames() == false);
  for (int guard = 0; guard < 100 && window.playCounts()->played < 16; ++guard) window.tickUntil(until_s += 0.05);
  CHECK(window.playCounts()->played == 16);
  CHECK(window.releaseStream() != nullptr);
  CHECK_FALSE(window.holdFrames().has_value());
  window.tickUntil(until_s + 0.1);
  CHECK(window.isTouching());
}

TEST_CASE("what is held is handed on, sculpted, undone and handed back, and frames go on behind it") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.stream->fuse = config.realtime = true;
  config.duration_s = 0;
  const auto clock = std::make_shared<SteppedClock>();
  auto playing = std::make_unique<LiveSession>(config, load(config), SessionParts{.backend = *cpu, .threads = 1},
                                               LiveOptions{.clock = clock});
  CHECK_FALSE(playing->holdsFrames());
  CHECK_FALSE(playing->isHeldStill());
  double until_s = 0;
  for (int guard = 0; guard < 100 && playing->playCounts()->played < 4; ++guard) playing->tickUntil(until_s += 0.02);
  Model held = playing->handOn();
  playing.reset();
  REQUIRE(held.stream != nullptr);
  const std::vector<Vec3> before = held.cloud.positions;
  CHECK(before.size() > 1000);
  const std::uint64_t played = held.stream->player->counts().played;

  SessionConfig still = config;
  still.stream.reset();
  still.brush = BrushConfig{.kind = BrushKind::carve, .radius_mm = 30};
  const auto second = std::make_shared<SteppedClock>();
  auto sculpting = std::make_unique<LiveSession>(still, std::move(held), SessionParts{.backend = *cpu, .threads = 1},
                                                 LiveOptions{.clock = second});
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
  Model carved = sculpting->handOn();
  sculpting.reset();
  REQUIRE(carved.stream != nullptr);
  CHECK(carved.cloud.positions != before);

  const auto third = std::make_shared<SteppedClock>();
  LiveSession goingOn(config, carved, {.backend = *cpu, .threads = 1}, {.clock = third});
  CHECK(goingOn.holdsFrames());
  goingOn.tickUntil(0.05);
  CHECK(goingOn.playCounts()->played == played);
  CHECK(goingOn.holdFrames() == false);
  until_s = 0.05;
  for (int guard = 0; guard < 100 && goingOn.playCounts()->played < played + 2; ++guard) goingOn.tickUntil(until_s += 0.02);
  CHECK(goingOn.playCounts()->played >= played + 2);
  CHECK(goingOn.isTouching());
}

TEST_CASE("a back end that fuses frames itself is handed the stream, and no source") {
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
  config.stream->fuse = true;
  const auto cpu = cpuBackend();
  Session own(config, load(config), {.backend = *cpu, .threads = 1});
  config.backend.name = "fusing";
  Session given(config, load(config), {.backend = fusing, .threads = 1});
  CHECK(fusing.begun);
  CHECK(sameTrace(runAlone(own, intoWall(kDuration_s)).trace(), runAlone(given, intoWall(kDuration_s)).trace()));
  CHECK(given.playCounts()->played == kFrames);
  CHECK(given.player() != nullptr);
}

TEST_CASE("a recording that fuses may be played by several sessions of one model, each from its beginning") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  std::filesystem::resize_file(folder / "depth" / "0000.png", 200);
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.stream->fuse = true;
  const auto model = std::make_shared<const Model>(load(config));
  Session one(config, model, {.backend = *cpu, .threads = 1}), other(config, model, {.backend = *cpu, .threads = 1});
  const Trace first = runAlone(one, intoWall(kDuration_s)).trace(),
              second = runAlone(other, intoWall(kDuration_s)).trace();
  CHECK(sameTrace(first, second));
  CHECK(summarize(first).contactTicks > 60);
  CHECK(one.playCounts()->played == kFrames - 1);
  CHECK(one.playCounts()->lost == 1);
}

TEST_CASE("a live camera whose frames fuse goes on behind the one that was the model, until it ends") {
  const auto stream = std::make_shared<LiveStream>(kCamera);
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  SessionConfig config = playing(folder.path());
  config.stream->fuse = true;
  Model model = load(config);
  const CameraPose pose{};
  model.stream =
      playedStream(stream, {.exact = false}, DepthFrame{.number = 0, .depth_m = wall(kRest_m), .pose = pose});
  model.stream->seenFrom = pose;
  config.model.file = "-";
  config.stream->live = config.realtime = true;
  config.duration_s = 0;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  LiveSession session(config, model, {.backend = *cpu, .threads = 1}, {.clock = clock});
  double until_s = 0.2;
  session.tickUntil(until_s);
  CHECK(session.playCounts()->played == 1);
  for (std::uint64_t k = 1; k <= 3; ++k) {
    stream->give({.time_s = 0.03 * static_cast<double>(k), .number = k, .depth_m = wall(kRest_m), .pose = pose});
    for (int guard = 0; guard < 200 && session.playCounts()->played < 1 + k; ++guard)
      session.tickUntil(until_s += 0.05);
    CHECK(session.playCounts()->played == 1 + k);
  }
  stream->give(
      {.time_s = 0.2, .number = 4, .depth_m = wall(kRest_m)});  // a wall says nothing of where it was seen from
  for (int guard = 0; guard < 200 && session.playCounts()->lost == 0; ++guard) session.tickUntil(until_s += 0.05);
  CHECK(session.playCounts()->lost == 1);
  CHECK(session.playCounts()->played == 4);
  stream->end();
  session.tickUntil(until_s + 2.5);
  CHECK(session.isTouching());
  CHECK(session.playCounts()->silentSince_s.has_value());
}

TEST_CASE("frames that fuse are felt as the map that they make, and a session with them is run again from its text") {
  const ScratchFolder folder;
  writeWall(folder.path());
  writePoses(folder.path());
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder.path());
  config.stream->fuse = true;
  CHECK(parseConfig(configText(config)) == config);
  const Model model = load(config);
  CHECK(model.cloud.size() > 1'000);
  CHECK(model.upright.up == UpAxis::minusY);
  // On the wall, and half a millimetre into it, where its noise is twice as much: the map follows it by a part.
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
  config.stream->fuse = false;
  Session newest(config, load(config), {.backend = *cpu, .threads = 1});
  CHECK_FALSE(sameTrace(first, runAlone(newest, Path({{0, before}, {0.05, in}, {kDuration_s, in}})).trace()));
}

}  // namespace palpate
