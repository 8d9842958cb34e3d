// Sessions whose model is a depth camera, recorded or live, on the CPU.
#include <thread>

#include "engine/cloud/up.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/session/wall_stream.hpp"

namespace palpate::stream_session_test {

namespace {}  // namespace

TEST_CASE("the first frame of a recording is the model, in metres and with its up axis") {
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
  CHECK(model.spacing == near(0.005, 0.05));
  CHECK(model.stream() == nullptr);

  const ScratchFolder colored;
  writeRedwood(colored.path());
  std::filesystem::remove(colored / "depth" / "00000.png");
  SessionConfig config = playing(colored.path());
  const Model second = load(config);
  CHECK(second.cloud.hasColors());
  CHECK(second.cloud.colors[0][2] == 1);  // the first readable frame
  const CameraFrustum frustum = frustumOf(recordedCamera(), recordedPose(1.0 / 30));
  REQUIRE(second.cameras.size() == 1);
  CHECK(glm::distance(second.cameras[0].centre, frustum.centre) < 1e-6);
  for (std::size_t k = 0; k < 4; ++k) CHECK(glm::distance(second.cameras[0].corners[k], frustum.corners[k]) < 1e-6);
}

TEST_CASE("a recording far from zero keeps its detail") {
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

TEST_CASE("a hand at rest feels the depth of a wall that moves from frame to frame, and nothing once it is gone") {
  const ScratchFolder folder;
  writeWall(folder.path());
  const auto cpu = cpuBackend();
  for (const double speed : {1.0, 2.0}) {
    SessionConfig config = playing(folder.path());
    config.model.stream->speed = speed;
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
    // Points are at the start of their motion, until no new frame has arrived for a while.
    const int last = speed > 1 ? 15 : 14;
    CHECK(session.sculpted().cloud.positions[7].z == within(kRest_m - 1e-3 * nearer_mm(last), 0.51e-3 * kRounded_mm));
  }
}

TEST_CASE("a looped recording continues at its start") {
  const ScratchFolder folder;
  writeWall(folder.path());
  SessionConfig config = playing(folder.path());
  config.model.stream->loop = true;
  config.duration_s = 2.5 * kDuration_s;
  const auto cpu = cpuBackend();
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, atRest(config.duration_s));
  const auto& rows = result.trace().rows;
  REQUIRE(rows.size() > 400);
  for (std::size_t tick = 30; tick < 160; ++tick)
    CHECK(glm::length(rows[tick].force_N) == within(glm::length(rows[tick + 160].force_N), 1e-6));
}

TEST_CASE("after a lost frame the one before stays, and the session continues") {
  const ScratchFolder folder;
  writeWall(folder.path());
  std::filesystem::resize_file(folder / "depth" / "0008.png", 200);
  const SessionConfig config = playing(folder.path());
  const auto cpu = cpuBackend();
  Session session(config, load(config), {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, atRest());
  const auto& rows = result.trace().rows;
  // The next frame is due at 90 ms: until then the surface moves towards frame 7.
  for (std::size_t tick = 74; tick < 89; ++tick) {
    const double share = (static_cast<double>(tick) - 70) / 20;
    const double depth_mm = nearer_mm(6) + share * (nearer_mm(7) - nearer_mm(6)) - kHand_mm;
    CHECK(glm::length(rows[tick].force_N) == near(0.5 * depth_mm, 0.02));
  }
  CHECK(session.playCounts()->lost == 1);
  CHECK(says(session.playCounts()->lastLoss, "0008.png: byte 200: ends within the picture"));
}

TEST_CASE("a recorded session with a recorded camera is replayed from its configuration alone") {
  const ScratchFolder folder;
  writeWall(folder / "wall");
  const std::string log = (folder / "log").string();
  const auto cpu = cpuBackend();
  SessionConfig config = playing(folder / "wall");
  config.model.stream->speed = 1.7;
  Session session(config, load(config), {.backend = *cpu, .threads = 1, .keepsPoints = true});
  const ServoResult result = runRecorded(session, log, atRest());
  SessionRecord record = readSessionLog(log);
  const RecordedSession recorded = parseHeader(log, record.text);
  CHECK(recorded.config == config);
  Session again(recorded.config, load(recorded.config), {.backend = *cpu, .threads = 1, .keepsPoints = true});
  CHECK(summarize(result.trace()).contactTicks > 60);
  CHECK(sameTrace(result.trace(), runAgain(again, std::move(record), recorded).trace()));
}

TEST_CASE("a configuration's text has a stream only if there is one") {
  CHECK(configText({}).find("stream") == std::string::npos);
  SessionConfig config;
  config.model.stream = StreamConfig{.speed = 0.3, .loop = true, .depthScale = 5000, .intrinsics = "c.json"};
  CHECK(parseConfig(configText(config)) == config);
  config.model.stream = StreamConfig{.live = true};
  config.realtime = true;
  CHECK(parseConfig(configText(config)) == config);
  SessionConfig usual;
  usual.model.stream.emplace();
  CHECK(parseConfig(R"({"version": 1, "stream": {}})") == usual);
  CHECK(parseConfig(R"({"version": 1, "stream": null})") == SessionConfig{});
}

TEST_CASE("settings that are incompatible with a stream are refused by field name") {
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
  CHECK(with([](auto& c) { c.model.stream->speed = 0; }) == "stream.speed");
  CHECK(with([](auto& c) { c.model.stream->speed = std::nan(""); }) == "stream.speed");
  CHECK(with([](auto& c) { c.model.stream->depthScale = 0.001; }) == "stream.depth_scale");
  CHECK(with([](auto& c) { c.brush.emplace(); }) == "brush.kind");
  CHECK(with([](auto& c) { c.motion.emplace(); }) == "motion.kind");
  CHECK(with([](auto& c) { c.model.normals = NormalSource::estimate; }) == "model.normals");
  const auto live = [&](auto&& change) {
    return with([&](auto& c) {
      c.model.stream->live = c.realtime = true;
      change(c);
    });
  };
  CHECK(live([](auto&) {}).empty());
  CHECK(live([](auto& c) { c.model.stream->speed = 2; }) == "stream.speed");
  CHECK(live([](auto& c) { c.model.stream->loop = true; }) == "stream.loop");
  CHECK(live([](auto& c) { c.realtime = false; }) == "realtime");
}

TEST_CASE("a stream that cannot be a model is refused with its kind") {
  const ScratchFolder folder;
  writeWall(folder.path());
  const SessionConfig config = playing(folder.path());
  Log log(true);
  CHECK(says(errorOf([&] { loadModel({.file = config.model.file}, {.log = log}); }),
             "is a recorded depth camera, and not one cloud"));
  SessionConfig live = config;
  live.model.stream->live = live.realtime = true;
  live.model.file = "/dev/null";
  CHECK(says(errorOf([&] { load(live); }), "stream.intrinsics: /dev/null provides none; give a JSON file"));
  live.model.file = "-";
  live.model.stream->intrinsics = "camera.json";
  CHECK(says(errorOf([&] { load(live); }), "stream.intrinsics: raw frames contain them in their first line"));
  for (int i = 0; i < kFrames; ++i)  // isolated pixels without neighbours
    writeBytes(folder / "depth" / fmt::format("{:04}.png", i), [] {
      std::vector<float> depth_m(std::size_t{kCamera.width} * kCamera.height);
      depth_m[500] = 1;
      return depthPng(kCamera, depth_m, 50'000);
    }());
  CHECK(says(errorOf([&] { load(config); }), "ends without a frame that has points"));
}

TEST_CASE("frames of a recording are held, stepped and resumed under a hand") {
  const ScratchFolder folder;
  writeWall(folder.path());
  SessionConfig config = playing(folder.path());
  config.duration_s = 0;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession session(config, load(config), {.backend = *cpu, .threads = 1}, {.clock = clock});
  session.aim({0, 0, kRest_m - 1e-3 * kHand_mm});
  CHECK(session.holdFrames() == true);
  session.tickUntil(1);
  CHECK(session.session().playCounts()->played == 1);
  const auto isTouched = [&] { return session.recentTicks().rows().back().contact; };
  CHECK_FALSE(isTouched());
  double until_s = 1;
  for (int step = 1; step <= 6; ++step) {
    session.stepFrame();
    session.tickUntil(until_s += 0.3);
    CHECK(session.session().playCounts()->played == static_cast<std::uint64_t>(1 + step));
  }
  CHECK(isTouched());
  CHECK(session.holdFrames() == false);
  for (int guard = 0; guard < 50 && isTouched(); ++guard) session.tickUntil(until_s += 0.1);
  CHECK_FALSE(isTouched());  // in the last frame the wall is back at its old position
  InteractiveSession still({.model = {}, .backend = {.name = "cpu"}}, sphereModel(), {.backend = *cpu, .threads = 1},
                           {});
  CHECK_FALSE(still.holdFrames().has_value());
  still.stepFrame();
}

TEST_CASE("a live camera is felt at its newest frame, from the model's frame on") {
  const auto stream = std::make_shared<LiveStream>(kCamera);
  DepthFrame first{.time_s = 3, .number = 0, .depth_m = wall(kRest_m)};
  const ScratchFolder folder;
  writeWall(folder.path());
  Model model = load(playing(folder.path()));
  model.source = CameraPoints{playedStream(stream, {.exact = false}, first)};
  SessionConfig config = playing("-");
  config.model.stream->live = true;
  config.realtime = true;
  config.duration_s = 0;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession session(config, model, {.backend = *cpu, .threads = 1}, {.clock = clock});
  CHECK_THROWS_WITH_AS(session.record((folder / "log").string()),
                       doctest::Contains("live frames cannot be played again"), Error);
  CHECK_THROWS_AS(Session(config, model, {.backend = *cpu, .threads = 1}), Error);  // the stream is in use
  session.aim({0, 0, kRest_m - 1e-3 * kHand_mm});
  session.tickUntil(0.3);
  const auto touched = [&] {
    return std::ranges::count_if(session.recentTicks().rows(), [](const TraceRow& row) { return row.contact; });
  };
  CHECK(touched() == 0);
  for (int k = 1; k <= 5; ++k)
    stream->give(
        {.time_s = 3 + 0.03 * k, .number = static_cast<std::uint64_t>(k), .depth_m = wall(kRest_m - 2e-4 * k)});
  double until_s = 0.3;
  const auto taken = [&] {
    const auto counts = session.session().playCounts();
    return counts ? counts->played + counts->dropped : 0;
  };
  for (int guard = 0; guard < 200 && (touched() == 0 || taken() < 6); ++guard) session.tickUntil(until_s += 0.05);
  CHECK(touched() > 0);
  CHECK(taken() == 6);
}

}  // namespace palpate::stream_session_test
