// Moving models, through the program.
#include <cmath>

#include "tests/apps/window_play.hpp"

namespace palpate::moving_test {

TEST_CASE("both back ends feel an oscillating model at its true depth under a hand at rest") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), trace = (folder / "t.csv").string();
  works("make plane -n 3000 -o " + model);
  std::ofstream(folder / "rest.csv") << "t_s,x,y,z\n0,0,0,0.3\n0.15,0,0,0.3\n";
  const std::string path = " --path " + (folder / "rest.csv").string();
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const std::string session = "--threads 1 touch " + model + path + " --backend " + backend +
                                " --damping 0 --trace " + trace +
                                " --motion oscillate --motion-amplitude 2 --motion-frequency 5";
    works(session + " --log " + (folder / "log").string() + " --json " + (folder / "r.json").string());
    double squares = 0, forces = 0;
    int pushed = 0;
    for (const Row& row : readTrace(trace)) {
      const double depth = 2 * std::sin(2 * 3.14159265358979 * 5 * row.t_s) - 0.3;
      const double exact_N = 0.8 * std::max(0.0, depth), felt_N = glm::length(row.force);
      squares += (felt_N - exact_N) * (felt_N - exact_N);
      forces += exact_N * exact_N;
      pushed += row.contact;
    }
    CHECK(pushed > 60);
    CHECK(std::sqrt(squares / forces) < 0.03);
    const auto report = jsonOf(folder / "r.json");
    CHECK(report["index"] == "rebuild");
    CHECK(report["moved_points"] == 3'000);
    CHECK(report["contact_error_mm"] < 0.05);
    works("--threads 1 replay " + (folder / "log").string());
  }
}

TEST_CASE("a motion without extent leaves the trace of no motion, byte for byte") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 2000 -o " + model);
  std::ofstream(folder / "press.csv") << "t_s,x,y,z\n0,0,0,52\n0.04,1,2,48.5\n0.06,3,2,48.5\n";
  for (const std::string backend : {"cpu", "vulkan"}) {
    std::vector<std::string> traces;
    for (const std::string motion : {"", "--motion none", "--motion oscillate --motion-amplitude 0",
                                     "--motion turn --motion-frequency 0 --motion-axis 1,2,3"}) {
      const std::string trace = (folder / "t.csv").string();
      works("--threads 1 touch " + model + " --path " + (folder / "press.csv").string() + " --backend " + backend +
            " " + motion + " --trace " + trace);
      traces.push_back(contentOf(trace));
    }
    for (const std::string& trace : traces) CHECK(trace == traces[0]);
  }
}

TEST_CASE("a picture of a moving model shows its final position, for either back end") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 3000 -o " + model);
  std::ofstream(folder / "far.csv") << "t_s,x,y,z\n0,0,0,200\n0.05,0,0,200\n";
  const auto picture = [&](const std::string& options) {
    const std::string file = (folder / "p.png").string();
    works("touch " + model + " --path " + (folder / "far.csv").string() + " " + options + " --size 160x120 --picture " +
          file);
    return contentOf(file);
  };
  const std::string still = picture("--backend vulkan"),
                    moved = picture("--backend vulkan --motion drift --motion-speed 200 --motion-axis 1,0,0");
  CHECK(still != moved);
  CHECK(picture("--backend cpu --motion drift --motion-speed 200 --motion-axis 1,0,0") == moved);
}

TEST_CASE("options that are incompatible with a moving model are refused by name") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 1000 -o " + model);
  const auto refused = [&](const std::string& options, const std::string& option) {
    checkEnds(2, "touch " + model + " --motion oscillate " + options, {option});
  };
  refused("--edit push", "--edit: a moving model cannot be sculpted");
  refused("--backend cuda", "--motion: --backend cuda");
  refused("--motion-axis 0,0,0", "--motion-axis");
  refused("--motion-amplitude -1", "--motion-amplitude");
}

TEST_CASE("the window shows a moving model at its position, and refuses a tool") {
  if (!hasDisplay()) return;
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const auto played = playWell(
        "%/sphere.ply --size 480x360 --rate 200 --motion drift --motion-axis 1,0,0 --motion-speed 150 --backend " +
            backend,
        sphereOf(1500), R"(
0.2 screenshot %/begin.png
0.6 screenshot %/later.png
0.65 key 2
0.9 state %/tool.json
0.95 quit
)");
    const Picture begin(played->folder / "begin.png"), later(played->folder / "later.png");
    REQUIRE(begin.rgb.size() == later.rgb.size());
    std::size_t others = 0;
    for (std::size_t i = 0; i < begin.rgb.size(); i += 3) others += std::abs(begin.rgb[i] - later.rgb[i]) > 20;
    CHECK(others > begin.rgb.size() / 3 / 20);
    const std::string message = played->state("tool.json")["last_message"];
    CHECK_MESSAGE(message.find("a moving model cannot be sculpted") != std::string::npos, message);
  }
}

}  // namespace palpate::moving_test
