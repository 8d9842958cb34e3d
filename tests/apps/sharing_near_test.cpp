// Hands with only the points around them, and moving models that one program serves and others join, through the
// program.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <future>
#include <sstream>
#include <utility>
#include <vector>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/apps/serving.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"

namespace palpate::sharing_near_test {

namespace {

/// The path of builtin:slide on a model, as a file: the same for every subset of the points.
void writeSlide(const std::string& model, const std::string& path) {
  works("touch " + model + " --backend cpu --path builtin:slide --duration 0.6 --trajectory " + path + ".csv");
  std::ifstream in(path + ".csv");
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);) {
    std::size_t end = 0;
    for (int field = 0; field < 4; ++field) end = line.find(',', end + 1);
    out << line.substr(0, end) << '\n';
  }
}

/// The rows of a trace, without the wall-clock columns.
std::vector<std::string> rowsOf(const std::filesystem::path& trace) {
  std::ifstream in(trace);
  std::vector<std::string> rows;
  for (std::string line; std::getline(in, line);) rows.push_back(line.substr(0, line.rfind(',', line.rfind(',') - 1)));
  return rows;
}

}  // namespace

TEST_CASE("a client with only nearby points feels the file, byte for byte, in virtual time") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sculpture -n 150000 --center 450000,-300000,1000 -o " + in("m.ply"));
  writeSlide(in("m.ply"), in("slide.csv"));
  works("touch " + in("m.ply") + " --backend cpu --path " + in("slide.csv") + " --trace " + in("own.csv"));
  Serving serving(in("m.ply") + " --name large --json " + in("s.json"), folder / "said");
  const std::string near = "touch --join large --partial" + domain() + " --backend cpu --path " + in("slide.csv");
  works(near + " --trace " + in("near.csv") + " --json " + in("n.json"));
  CHECK(contentOf(in("near.csv")) == contentOf(in("own.csv")));
  const Result report = jsonOf(in("n.json"));
  CHECK(report["points"] == 150000);
  CHECK(report["contact_ticks"] > 100);
  CHECK(report["partial"]["ticks"] == 601);
  CHECK(report["partial"]["ticks_without_points"] == 0);
  CHECK(report["partial"]["steps"] > 0);
  const Outcome refused = palpate(near + " --log " + in("log"));
  CHECK(refused.code == 2);
  CHECK(says(refused.text, "--log: only the points around the hand are in this program"));
  CHECK(serving.program.wait(SIGINT) == 0);
  const Result served = jsonOf(in("s.json"));
  CHECK(served["partial"] == 1);  // the others were refused before they felt anything
  CHECK(served["partial_points"] > 1000);
  CHECK(served["frames"] == 0);
}

TEST_CASE("a client with only nearby points feels the file in real time" * kClock) {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sculpture -n 150000 --center 450000,-300000,1000 -o " + in("m.ply"));
  writeSlide(in("m.ply"), in("slide.csv"));
  works("touch " + in("m.ply") + " --backend cpu --path " + in("slide.csv") + " --trace " + in("own.csv"));
  Serving serving(in("m.ply") + " --name large", folder / "said");
  const std::string near = "touch --join large --partial" + domain() + " --backend cpu --path " + in("slide.csv");
  works(near + " --realtime --trace " + in("clock.csv") + " --json " + in("c.json"));
  // Missed ticks have no row; the others have the file's force, except for those reported to lack points.
  const auto own = rowsOf(in("own.csv")), clock = rowsOf(in("clock.csv"));
  std::size_t same = 0;
  for (const std::string& row : clock) same += std::ranges::count(own, row) > 0;
  const Result timed = jsonOf(in("c.json"));
  CHECK(clock.size() > 300);
  // A missed tick affects some later ones: by the damping, and by the proxy's path.
  constexpr std::size_t kAfter = 10;
  CHECK(clock.size() - same <= kAfter * (timed["partial"]["ticks_without_points"].get<std::size_t>() +
                                         timed["missed_ticks"].get<std::size_t>()));
  CHECK(timed["partial"]["ticks_without_points"] < 60);
  // Only the points near the hand were sent.
  CHECK(timed["partial"]["max_known"] < 140000);
  CHECK(serving.program.wait(SIGINT) == 0);
}

TEST_CASE("a client with only nearby points sculpts like the file, byte for byte, and later clients get the result") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 20000 -o " + in("m.ply"));
  writeSlide(in("m.ply"), in("slide.csv"));
  const std::string how = " --backend cpu --no-resample --penetration 3 --path " + in("slide.csv") + " --edit ";
  for (const std::string& brush : {std::string("push"), std::string("carve")}) {
    CAPTURE(brush);
    const std::string saved = brush + ".ply", later = "later" + saved;
    works("touch " + in("m.ply") + how + brush + " --trace " + in("own.csv") + " --save " + in(saved.c_str()) +
          " --json " + in("o.json"));
    const std::string served = in("served.ply");
    Serving serving(in("m.ply") + " --name carved --save " + served + " --json " + in("s.json"), folder / "said");
    const std::string part = "part" + saved;
    const Outcome undone =
        palpate("touch --join carved --partial" + domain() + how + brush + " --undo 9 --save " + in(part.c_str()));
    CHECK(undone.code == 0);
    const std::size_t known = readCloud(in(part.c_str())).cloud.size();
    CHECK(says(undone.text, fmt::format("{}: {} of 20000 points", in(part.c_str()), known)));
    CHECK(says(undone.text, "carved: the server has saved all 20000 points in " + served));
    CHECK(pointsOf(served) == pointsOf(in("m.ply")));
    works("touch --join carved" + domain() + " --backend cpu --duration 0.01 --save " + in("undone.ply"));
    CHECK(pointsOf(in("undone.ply")) == pointsOf(in("m.ply")));
    works("touch --join carved --partial" + domain() + how + brush + " --trace " + in("near.csv") + " --save " +
          in(part.c_str()) + " --json " + in("n.json"));
    CHECK(pointsOf(served) == pointsOf(in(saved.c_str())));
    CHECK(contentOf(in("near.csv")) == contentOf(in("own.csv")));
    const Result report = jsonOf(in("n.json"));
    const Result& near = report["partial"];
    CHECK(report["moved_points"] == jsonOf(in("o.json"))["moved_points"]);
    CHECK(near["sent"] > 100);
    CHECK(near["delivered"] == true);
    CHECK(near["ticks_without_points"] == 0);
    CHECK(report["server_save"]["written"] == true);
    CHECK(report["server_save"]["points"] == readCloud(served).cloud.size());
    CHECK(report["server_save"]["words"] == served);
    works("touch --join carved" + domain() + " --backend cpu --duration 0.01 --save " + in(later.c_str()));
    CHECK(pointsOf(in(later.c_str())) == pointsOf(in(saved.c_str())));
    CHECK(serving.program.wait(SIGINT) == 0);
    CHECK(jsonOf(in("s.json"))["states"] > near["sent"]);  // the undone stroke, too
  }
}

TEST_CASE("hands that join a thin plate, with all of its points or only nearby ones, push no side through the other") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  constexpr double kThickness = 1, kSpacing = 0.5;
  std::ostringstream points;
  std::size_t eachSide = 0;
  for (const double side : {1.0, -1.0})
    for (double y = -12; y <= 12; y += kSpacing)
      for (double x = -15; x <= 15; x += kSpacing, eachSide += side > 0)
        points << x << ' ' << y << ' ' << 0.5 * side * kThickness << " 0 0 " << side << '\n';
  std::ofstream(in("m.ply")) << "ply\nformat ascii 1.0\nelement vertex " << 2 * eachSide
                             << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                                "property float ny\nproperty float nz\nend_header\n"
                             << points.str();
  const PointCloud before = readCloud(in("m.ply")).cloud;
  REQUIRE(before.size() == 2 * eachSide);
  std::ofstream(in("deep.csv")) << "t_s,x,y,z\n0,-3,0,2\n0.1,-3,0,-4\n0.3,3,0,-4\n0.4,3,0,2\n";
  const std::string push = " --edit push --brush-radius 5 --path " + in("deep.csv");
  for (const std::string& how : {std::string(" --backend vulkan"), std::string(" --backend cpu --partial")}) {
    CAPTURE(how);
    Serving serving(in("m.ply") + " --name plate --mm-per-unit 1 --save " + in("end.ply"), folder / "said");
    works("touch --join plate" + domain() + how + push);
    CHECK(serving.program.wait(SIGINT) == 0);
    const PointCloud after = readCloud(in("end.ply")).cloud;
    REQUIRE(after.size() == before.size());
    std::size_t pressed = 0, through = 0, far = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      pressed += i < eachSide && after.positions[i].z < 0.2 * kThickness;
      through += i < eachSide && after.positions[i].z < -0.5 * kThickness + 0.5 * kSpacing;
      far += i >= eachSide && after.positions[i] != before.positions[i];
    }
    CHECK(pressed > 50);
    CHECK(through == 0);
    CHECK(far == 0);
  }
}

TEST_CASE("a served moving model is felt as it moves, and a served soft body yields to remote hands" * kClock) {
  if (!isBuilt() || !hasScenes()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make plane -n 10000 -o " + in("m.ply"));
  std::ofstream(in("rest.csv")) << "t_s,x,y,z\n0,0,0,10\n0.5,0,0,0\n2.1,0,0,0\n";
  {
    Serving serving(in("m.ply") +
                        " --name moving --motion oscillate --motion-amplitude 3 --motion-frequency 1 --json " +
                        in("s.json"),
                    folder / "said");
    const std::string join = "touch --join moving" + domain() + " --backend cpu";
    const Outcome still = palpate(join + " --duration 0.1");
    CHECK(still.code == 1);
    CHECK(still.text.find("join it with --realtime") != std::string::npos);
    works(join + " --realtime --path " + in("rest.csv") + " --trace " + in("t.csv") + " --json " + in("j.json"));
    // A hand at rest in the middle of the path is pressed half of the time, as deep as the surface passes over it.
    std::ifstream trace(in("t.csv"));
    std::string line;
    std::getline(trace, line);
    double deepest = 0, largestStep = 0, last = 0;
    std::size_t rows = 0, touching = 0;
    while (std::getline(trace, line)) {
      std::vector<double> fields;
      std::istringstream all(line);
      for (std::string field; std::getline(all, field, ',');) fields.push_back(std::stod(field));
      REQUIRE(fields.size() > 14);
      if (fields[0] < 0.6) continue;
      const double depth = fields[13];
      ++rows;
      touching += fields[14] != 0;
      deepest = std::max(deepest, depth);
      if (rows > 1 && depth > 0 && last > 0) largestStep = std::max(largestStep, std::abs(depth - last));
      last = depth;
    }
    CHECK(rows > 750);
    CHECK(touching > rows / 4);
    CHECK(touching < rows * 3 / 4);
    CHECK(deepest > 2.7);
    CHECK(deepest < 3.1);
    CHECK(largestStep < 0.5);
    CHECK(serving.program.wait(SIGINT) == 0);
    const Result served = jsonOf(in("s.json"));
    CHECK(served["frames"] > 40);
    CHECK(served["partial"] == 1);
    CHECK(served["sculptors"] == 0);
  }
  {
    Serving serving("jelly --name soft --backend cpu", folder / "soft.said");
    works("touch --join soft" + domain() +
          " --backend cpu --realtime --path builtin:press --penetration 6 --duration 1.4 --json " + in("soft.json"));
    const Result soft = jsonOf(in("soft.json"));
    CHECK(soft["contact_ticks"] > 100);
    CHECK(soft["partial"]["steps"] > 20);
    CHECK(soft["peak_force_N"] > 0.02);
    CHECK(serving.program.wait(SIGINT) == 0);
  }
  const Outcome journal =
      palpate("serve " + in("m.ply") + " --motion turn --journal " + in("x") + " --name a" + domain());
  CHECK(journal.code == 2);
  CHECK(journal.text.find("does not move") != std::string::npos);
}

TEST_CASE("served water that two hands beat until it fails restarts, and their program and a window report it") {
  if (!isBuilt() || !hasScenes()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  // So fine and weightless that its speed of sound is below the speed of the hand.
  std::ofstream(in("fine.json"))
      << R"({"matter": "water", "box_mm": [16, 16, 16], "fill_mm": [16, 16, 16], "spacing_mm": 2,
    "gravity_m_s2": [0, 0, 0]})";
  const auto beat = [&](const char* name, double x) {
    std::ofstream path(in(name));
    path << "t_s,x,y,z\n";
    for (int k = 0; k < 1500; ++k) path << 0.02 * k << "," << x << "," << (k % 2 ? 18 : -2) << ",8\n";
  };
  beat("a.csv", 5);
  beat("b.csv", 11);
  Serving serving(in("fine.json") + " --name fine --backend cpu --threads 1", folder / "said");
  // The window watches from before until after.
  std::ofstream(in("w.txt")) << "0.1 state " << in("v.json") << "\n0.2 await " << in("go") << "\n0.5 state "
                             << in("w.json") << "\n0.6 quit\n";
  std::future<int> window;
  if (hasDisplay()) {
    window = std::async(std::launch::async, [&] {
      return std::system(("XDG_STATE_HOME=" + in("home") + " timeout 200 xvfb-run -a " + program() +
                          " view --join fine" + domain() + " --backend cpu --realtime --size 320x240 --script " +
                          in("w.txt") + " > " + in("w.said") + " 2>&1")
                             .c_str());
    });
    REQUIRE_MESSAGE(serving.program.waitFor([&] { return std::filesystem::exists(in("v.json")); }),
                    contentOf(in("w.said")));
  }
  RunningProgram hands("touch --join fine" + domain() + " --backend cpu --realtime --path " + in("a.csv") +
                           " --hand path=" + in("b.csv") + " --json " + in("j.json"),
                       folder / "hands.said");
  CHECK(hands.waitFor(
      [&] { return contentOf(folder / "hands.said").find("'fine' has restarted") != std::string::npos; }));
  hands.wait(SIGINT);
  if (window.valid()) {
    std::ofstream(in("go")) << "now";
    CHECK_MESSAGE(window.get() == 0, contentOf(in("w.said")));
    const Result seen = jsonOf(in("w.json"));
    CAPTURE(seen.dump());
    CHECK(seen["partial"]["restarts"] >= 1);
    CHECK(seen["last_message"].get<std::string>().find("'fine' has restarted") != std::string::npos);
  }
  const std::string said = contentOf(folder / "said");
  CHECK(said.find(": it is restarted") != std::string::npos);
  CHECK(jsonOf(in("j.json"))["partial"]["restarts"] >= 1);
  CHECK(serving.program.wait(SIGINT) == 0);
}

TEST_CASE("a remote hand feels served water through its ball, which displaces it, and the water is shown" * kClock) {
  if (!isBuilt() || !hasScenes()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("pool.json"))
      << R"({"matter": "water", "box_mm": [90, 160, 90], "fill_mm": [90, 80, 90], "spacing_mm": 10,
    "tool": {"radius_mm": 20, "mass_kg": 0.034}})";
  Serving serving(in("pool.json") + " --name pool --backend cpu --threads 1 --json " + in("s.json"), folder / "said");
  const std::string join = " --join pool" + domain();
  const std::string touch = "touch" + join + " --backend cpu --realtime --path builtin:press";
  const Outcome still = palpate("touch" + join + " --backend cpu --duration 0.1");
  CHECK(still.code == 1);
  CHECK(still.text.find("join it with --realtime") != std::string::npos);
  works(touch + " --duration 2 --trace " + in("t.csv") + " --json " + in("j.json"));
  const Result felt = jsonOf(in("j.json"));
  MESSAGE("of " << felt["ticks"] << " ticks " << felt["contact_ticks"] << " had a force, of at most "
                << felt["peak_force_N"] << " N; " << felt["partial"]["steps"] << " steps were received");
  CHECK(felt["partial"]["steps"] > 20);
  CHECK(felt["partial"]["max_known"] > 300);
  CHECK(felt["contact_ticks"] > 100);
  CHECK(felt["peak_force_N"] > 0.05);
  CHECK(felt["peak_force_N"] < 4);
  const Outcome tool = palpate(touch + " --tool ball --duration 0.1");
  CHECK(tool.code == 2);
  CHECK(tool.text.find("a hand holds the scene's ball") != std::string::npos);
  works("render" + join + " --size 320x180 -o " + in("p.png"));
  CHECK(std::filesystem::file_size(in("p.png")) > 1000);
  CHECK(serving.program.wait(SIGINT) == 0);
  const Result served = jsonOf(in("s.json"));
  CHECK(served["frames"] > 20);
  CHECK(served["partial"] == 1);  // the others were refused before they felt anything
  CHECK(served["partial_points"] > 5000);
}

TEST_CASE("models that cannot be served, and incompatible sharing options, are refused with a reason") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto refuses = [](const std::string& arguments, const std::string& words) {
    const Outcome outcome = palpate(arguments);
    CAPTURE(outcome.text);
    CHECK(outcome.code == 2);
    CHECK(outcome.text.find(words) != std::string::npos);
  };
  refuses("touch a.ply --join city", "is the model");
  refuses("touch --join city --motion oscillate", "a joined model cannot be moved");
  refuses("touch --join city --speed 2", "is not a recorded depth camera");
  refuses("touch --join city --normals estimate", "has its own normals");
  refuses("touch a.ply --interface lo", "require --join");
  refuses("touch --join city --domain 231", "231");
  refuses("touch --join city --interface 'x y'", "neither the name of an interface");
  refuses("touch a.ply --partial", "require --join");
  refuses("doctor --domain 3", "require --network");
  refuses("render -o " + (folder / "p.png").string(), "a session with --join");
  refuses("render --join city --depth-scale 1000 -o " + (folder / "p.png").string(), "is not a recorded depth camera");
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 1000 -o " + model);
  refuses("serve " + model + " --name ''", "is not a valid session name");
  refuses("serve " + model, "--name");
  CHECK(palpate("serve " + (folder / "none.ply").string() + " --name a").code == 1);
  CHECK(palpate("doctor --network --interface nowhere0").text.find("nowhere0") != std::string::npos);
  // A killed server's name is free.
  {
    Serving killed(model + " --name short", folder / "said");
    CHECK(killed.program.wait(SIGKILL) != 0);
  }
  Serving again(model + " --name short", folder / "said2");
  works("touch --join short" + domain() + " --backend cpu --duration 0.05");
}

}  // namespace palpate::sharing_near_test
