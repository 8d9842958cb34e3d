// Depth cameras as models, through the program: recorded folders, and raw frames on standard input.
#include <array>
#include <cmath>
#include <set>

#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/rgbd_writer.hpp"

namespace palpate::stream_test {

namespace {

/// Towards the sphere of radius 0.5 around (0.1, 0, 2) from the camera's side, a tenth of a metre in, and there to the
/// end: the averaged surface of few points on such a small sphere is well behind it.
std::string pathInto(const std::filesystem::path& folder) {
  std::ofstream(folder / "path.csv") << "t_s,x,y,z\n0,0.1,0,1.2\n0.05,0.1,0,1.6\n0.15,0.1,0,1.6\n";
  return (folder / "path.csv").string();
}

bool isRefused(const std::string& arguments, int code, const std::string& saying) {
  const Outcome outcome = palpate(arguments);
  CHECK_MESSAGE(outcome.code == code, outcome.text);
  CHECK_MESSAGE(outcome.text.find(saying) != std::string::npos, outcome.text);
  return outcome.code == code;
}

}  // namespace

TEST_CASE("a recorded folder is played under a hand, and both back ends feel the same") {
  for (const auto& write : {&writeTum, &writeRedwood}) {
    const ScratchFolder folder;
    write(folder / "recorded", {.frames = 5, .rate_Hz = 30});
    const std::string model = (folder / "recorded").string(), trace = (folder / "t.csv").string();
    std::vector<double> forces_N;
    for (const std::string backend : {"cpu", "vulkan"}) {
      CAPTURE(backend);
      works("--threads 1 touch " + model + " --path " + pathInto(folder.path()) +
            " --mm-per-unit 1000 --stiffness 0.1 --max-force 20 --backend " + backend + " --trace " + trace +
            " --log " + (folder / "log").string() + " --json " + (folder / "r.json").string());
      const auto rows = readTrace(trace);
      REQUIRE(rows.size() > 140);
      CHECK_FALSE(rows[20].contact);
      CHECK(rows.back().contact);
      CHECK(rows.back().normal.z < -0.9);
      forces_N.push_back(glm::length(rows.back().force));
      const auto report = jsonOf(folder / "r.json");
      CHECK(report["frames"]["played"] == 5);
      CHECK(report["frames"]["lost"] == 0);
      works("--threads 1 replay " + (folder / "log").string());
    }
    CHECK(forces_N[0] > 2);
    CHECK(forces_N[1] == near(forces_N[0], 0.01));
  }
}

TEST_CASE("info describes a recording, and mesh refuses it") {
  const ScratchFolder folder;
  writeTum(folder / "recorded", {.frames = 5, .rate_Hz = 30});
  const std::string model = (folder / "recorded").string();
  works("info " + model + " --json " + (folder / "i.json").string());
  const auto info = jsonOf(folder / "i.json");
  CHECK(info["frames"] == 5);
  CHECK(info["kind"] == "TUM");
  CHECK(info["poses"] == 5);
  CHECK(info["colors"] == 5);
  CHECK(info["depth_scale"] == 5000);
  CHECK(info["up"] == "-y");
  CHECK(info["camera"]["width"] == 24);
  isRefused("mesh " + model + " -o " + (folder / "o.ply").string(), 1, "is a recorded depth camera, and not one cloud");
}

TEST_CASE("the frames of a recorded folder are fused under a hand, and both back ends feel the same map") {
  const ScratchFolder folder;
  writeRedwood(folder / "recorded", {.frames = 3, .rate_Hz = 30});
  const std::string trace = (folder / "t.csv").string();
  std::vector<double> forces_N;
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    works("--threads 1 touch " + (folder / "recorded").string() + " --fuse on --path " + pathInto(folder.path()) +
          " --rate 500 --mm-per-unit 1000 --stiffness 0.1 --max-force 20 --backend " + backend + " --trace " + trace +
          " --json " + (folder / "r.json").string() + " --save " + (folder / (backend + ".ply")).string());
    works("info " + (folder / (backend + ".ply")).string() + " --json " + (folder / "i.json").string());
    CHECK(jsonOf(folder / "i.json")["up"] == "-y");
    CHECK(jsonOf(folder / "i.json")["points"] > 40);
    const auto rows = readTrace(trace);
    REQUIRE(rows.size() > 70);
    CHECK(rows.back().contact);
    forces_N.push_back(glm::length(rows.back().force));
    const auto report = jsonOf(folder / "r.json");
    CHECK(report["frames"]["played"] == 3);
  }
  CHECK(forces_N[0] > 1);
  CHECK(forces_N[1] == near(forces_N[0], 0.01));
}

TEST_CASE("the first frame of a recording is drawn in its colours") {
  const ScratchFolder folder;
  writeRedwood(folder / "recorded");
  const std::string picture = (folder / "p.png").string();
  works("render " + (folder / "recorded").string() + " --size 160x120 -o " + picture);
  const Picture drawn(picture);
  std::set<std::array<int, 3>> colors;
  for (std::size_t i = 0; i < drawn.rgb.size(); i += 3)
    colors.insert({drawn.rgb[i] / 16, drawn.rgb[i + 1] / 16, drawn.rgb[i + 2] / 16});
  CHECK(colors.size() > 4);
}

TEST_CASE("frames on standard input are felt in real time until they end, and truncated ones are reported") {
  const ScratchFolder folder;
  const DepthCamera camera = recordedCamera();
  std::string frames = intrinsicsJson(camera, R"(, "depth_scale": 5000, "format": "z16")") + "\n";
  for (int i = 0; i < 5; ++i) {
    std::string bytes;
    for (const float depth : depthSeen(camera, {})) {
      const auto value = static_cast<std::uint16_t>(std::lround(5000 * depth));
      bytes += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
    }
    frames += fmt::format("frame {}\n", 0.03 * i) + (i == 2 ? bytes.substr(0, 100) : bytes);
  }
  writeBytes(folder / "frames", frames);
  const Outcome outcome =
      run("cat " + (folder / "frames").string() + " | " + program() + " touch --live - --realtime --path " +
          pathInto(folder.path()) + " --mm-per-unit 1000 --backend cpu --json " + (folder / "r.json").string());
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto report = jsonOf(folder / "r.json");
  CHECK(report["frames"]["lost"] == 1);
  CHECK(report["frames"]["last_loss"] == "standard input: frame 2 has 100 of its 864 bytes; the next one follows");
  CHECK(report["contact_ticks"] > 10);
}

TEST_CASE("frames on standard input are fused in real time until they end, on both back ends") {
  const ScratchFolder folder;
  const DepthCamera camera = recordedCamera();
  std::string frames =
      intrinsicsJson(camera,
                     R"(, "depth_scale": 5000, "format": "z16", "pose": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])") +
      "\n";
  for (int i = 0; i < 3; ++i) {
    frames += fmt::format("frame {}\n", 0.03 * i);
    for (const float depth : depthSeen(camera, {})) {
      const auto value = static_cast<std::uint16_t>(std::lround(5000 * depth));
      frames += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
    }
  }
  writeBytes(folder / "frames", frames);
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const Outcome outcome =
        run("cat " + (folder / "frames").string() + " | " + program() + " --threads 1 touch --live - --fuse on " +
            "--realtime --path " + pathInto(folder.path()) + " --mm-per-unit 1000 --backend " + backend + " --json " +
            (folder / "r.json").string() + " --save " + (folder / "map.ply").string());
    REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
    const auto report = jsonOf(folder / "r.json");
    CHECK(report["frames"]["lost"] == 0);
    CHECK(report["frames"]["played"] >= 1);
    CHECK(report["frames"]["played"].get<int>() + report["frames"]["dropped"].get<int>() <= 3);
    works("info " + (folder / "map.ply").string());
  }
}

TEST_CASE("options that are incompatible with a depth camera are refused by name") {
  const ScratchFolder folder;
  writeRedwood(folder / "recorded");
  const std::string model = (folder / "recorded").string(), cloud = (folder / "s.ply").string();
  works("make sphere -n 1000 -o " + cloud);
  isRefused("touch", 2, "model: is required");
  isRefused("touch " + cloud + " --speed 2", 2, "is not a recorded depth camera, which --speed");
  isRefused("render " + cloud + " --depth-scale 1000 -o p.png", 2, "is not a recorded depth camera");
  isRefused("touch " + model + " --live -", 2, "--live: the camera is the model; leave");
  isRefused("touch --live -", 2, "--realtime: live streams require realtime");
  isRefused("touch --live /dev/null --realtime", 2, "--intrinsics: /dev/null provides none");
  isRefused("touch --live /dev/null --realtime --intrinsics " + model + "/intrinsics.json", 1,
            "/dev/null: is not a video device");
  isRefused("touch --live - --realtime --loop", 2, "--loop: a live stream cannot restart");
  isRefused("touch " + model + " --edit push", 2,
            "--edit: the frames of a depth camera cannot be sculpted while they play");
  isRefused("touch " + model + " --motion turn", 2, "--motion: the frames of a depth camera move already");
  isRefused("touch " + model + " --normals estimate", 2, "--normals: the frames of a depth camera have their own");
  isRefused("touch " + model + " --speed 0", 2, "--speed");
  isRefused("touch " + model + " --intrinsics none.json", 1, "none.json: cannot be read");
  const Outcome ended = run("true | " + program() + " touch --live - --realtime");
  CHECK(ended.code == 1);
  CHECK_MESSAGE(ended.text.find("standard input: ends before the line of JSON") != std::string::npos, ended.text);
}

TEST_CASE("the window plays a recording") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/recorded --size 480x360 --rate 200 --backend cpu --speed 0.5 --loop",
      [](const std::filesystem::path& folder) { writeRedwood(folder / "recorded", {.frames = 30}); }, R"(
0.2 screenshot %/begin.png
0.9 screenshot %/later.png
0.95 key k
1.2 screenshot %/held.png
1.6 screenshot %/stillheld.png
1.65 state %/end.json
1.7 quit
)");
  const auto differing = [&](const char* one, const char* other) {
    const Picture a(played->folder / one), b(played->folder / other);
    REQUIRE(a.rgb.size() == b.rgb.size());
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3) pixels += std::abs(a.rgb[i] - b.rgb[i]) > 20;
    return pixels;
  };
  CHECK(differing("begin.png", "later.png") > 100);
  CHECK(differing("held.png", "stillheld.png") < 20);
  CHECK(jsonOf(played->folder / "end.json")["last_message"] == "frames are paused");
}

TEST_CASE("the window sculpts, undoes and saves a held frame, and playback continues") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/recorded --size 480x360 --rate 200 --backend cpu --speed 0.2 --edit carve --mm-per-unit 20",
      [](const std::filesystem::path& folder) { writeRedwood(folder / "recorded", {.frames = 30}); }, R"(
0.3 state %/begin.json
0.5 key k
0.6 impatient
0.7 patient
0.8 mouse 132 180
0.9 key space down
1.0 button left down
1.1 wheel 4
1.8 button left up
1.9 key space up
1.95 screenshot %/carved.png
2.0 state %/carved.json
2.1 key ctrl+z
2.2 state %/undone.json
2.3 key ctrl+y
2.4 save %/carved.ply
2.7 state %/saved.json
2.8 key k
3.2 state %/on.json
3.3 quit
)");
  const auto carved = played->state("carved.json");
  CHECK(played->state("begin.json")["edits"] == 0);
  CHECK(carved["edits"] > 0);
  CHECK(carved["undo_count"] == 1);
  CHECK(played->state("undone.json")["undo_count"] == 0);
  CHECK(std::filesystem::exists(played->folder / "carved.ply"));
  CHECK(played->outcome.text.find("frames continue") != std::string::npos);
  CHECK(played->state("on.json")["edits"] == 0);
}

}  // namespace palpate::stream_test
