// Two devices at once, through the program.
#include <algorithm>

#include "tests/apps/program.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/says.hpp"

namespace palpate::two_hands_test {

namespace {

struct Scene {
  Scene() {
    works("make sphere -n 20000 --size 60 -o " + model);
    // Down onto the pole, 2 mm deep, and along there; and from the side, in and out, for longer.
    std::ofstream(file("a.csv")) << "t_s,x,y,z\n0,0,0,33.013\n0.2,0,0,28\n0.3,3,0,27.8\n";
    std::ofstream(file("b.csv")) << "t_s,x,y,z\n0,33.013,0,0\n0.25,28.5,0,0\n0.35,28,3,0\n0.4,34,3,0\n";
  }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  std::string touch(const std::string& options, const std::string& backend = "cpu") const {
    return "touch " + model + " --backend " + backend + " --mm-per-unit 1 --friction 0.3 " + options;
  }
  ScratchFolder folder;
  std::string model = (folder / "model.ply").string();
};

}  // namespace

TEST_CASE("two scripted hands leave the same traces as each hand alone, byte for byte, on both back ends") {
  const Scene scene;
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const auto alone = [&](const std::string& path, const std::string& trace) {
      works(scene.touch("--path " + scene.file(path) + " --duration 0.4 --trace " + scene.file(trace), backend));
      return contentOf(scene.folder / trace);
    };
    const std::string a = alone("a.csv", "a-trace.csv"), b = alone("b.csv", "b-trace.csv");
    works(scene.touch("--path " + scene.file("a.csv") + " --trace " + scene.file("first.csv") +
                          " --hand path=" + scene.file("b.csv") + ",trace=" + scene.file("second.csv") + " --json " +
                          scene.file("both.json"),
                      backend));
    CHECK(contentOf(scene.folder / "first.csv") == a);  // as long as the longer of the two
    CHECK(contentOf(scene.folder / "second.csv") == b);
    double peak_N = 0;
    int touched = 0;
    for (const Row& row : readTrace(scene.folder / "second.csv")) {
      peak_N = std::max(peak_N, glm::length(row.force));
      touched += row.contact;
    }
    CHECK(peak_N > 0.8);
    const auto report = jsonOf(scene.folder / "both.json")["hands"][0];
    CHECK(report["device"] == "path");
    CHECK(report["ticks"] == 401);
    CHECK(report["contact_ticks"] == touched);
    CHECK(report["peak_force_N"] == peak_N);
    CHECK(report["fresh_fraction"] == 1);
    CHECK(report["safety"]["errors"] == 0);
    CHECK(report["passivity_energy_mJ"].is_null());
  }
}

TEST_CASE("the second hand may be simulated or replayed, and does not change the first hand's edits") {
  const Scene scene;
  const std::string edit = "--edit push --penetration 4 ";
  works(scene.touch(edit + "--save " + scene.file("alone.ply") + " --trace " + scene.file("alone.csv")));
  const Outcome sim = palpate(scene.touch(edit + "--save " + scene.file("sim.ply") +
                                          " --hand device=sim,path=builtin:slide,trace=" + scene.file("sim.csv")));
  CHECK(sim.code == 0);
  CHECK(says(sim.text, "hand 2                sim: "));
  CHECK(contentOf(scene.file("sim.ply")) == contentOf(scene.file("alone.ply")));
  CHECK(readTrace(scene.folder / "sim.csv").size() > 500);
  // The same path as the first hand: it feels the dent that the first one makes, and nothing else.
  works(scene.touch(edit + "--trace " + scene.file("first.csv") + " --hand device=replay:" + scene.file("alone.csv") +
                    ",trace=" + scene.file("second.csv")));
  CHECK(contentOf(scene.file("first.csv")) == contentOf(scene.file("alone.csv")));
  CHECK(contentOf(scene.file("second.csv")) == contentOf(scene.file("alone.csv")));
}

TEST_CASE("two styluses of one driver, one for each hand") {
  const Scene scene;
  std::string script, fault;
  SUBCASE("to the end") {}
  SUBCASE("until one fails") {
    script = "\nfault error 770 1.1";
    fault = "palpate: Right Device: no communication with the device (0x0302); check cable and power";
  }
  const FakeDriver left("fake_hd", "hurry\nlead 0.5", "0,0,40,0\n0.4,0,28.5,0\n");
  const SecondFakeStylus right("hurry\nlead 0.5" + script, "0,40,0,0\n0.4,28.5,0,0\n");
  const Outcome outcome = palpate(scene.touch(
      "--device openhaptics:Left\\ Device --realtime --map identity --duration 1.6 --trace " + scene.file("first.csv") +
      " --hand device=openhaptics:Right\\ Device,trace=" + scene.file("second.csv")));
  CHECK(outcome.code == (fault.empty() ? 0 : 1));
  CHECK(says(outcome.text, fault));
  for (const FakeStylus* stylus : {static_cast<const FakeStylus*>(&left), static_cast<const FakeStylus*>(&right)}) {
    const FakeNote note = stylus->note();
    CHECK(note.threadFaults + note.frameFaults == 0);
    CHECK(note.mostForce_N > 0.1);
    CHECK(note.closed == 1);
    CHECK(stylus->lastForce_N() == DVec3(0));
  }
  const auto first = readTrace(scene.folder / "first.csv"), second = readTrace(scene.folder / "second.csv");
  REQUIRE(first.size() == second.size());
  REQUIRE(first.size() > 50);
  const std::size_t at = first.size() - 2;
  CHECK(first[at].t_s == second[at].t_s);
  const auto strongest_N = [](const std::vector<Row>& rows) {
    return std::ranges::max_element(rows, {}, [](const Row& row) { return glm::length(row.force); })->force;
  };
  CHECK(strongest_N(first).y > 0.1);
  CHECK(strongest_N(second).x > 0.1);
  if (fault.empty()) return;
  CHECK(first.back().force == DVec3(0));
  CHECK(second.back().force == DVec3(0));
}

TEST_CASE("eight hands of one session leave the same traces as each hand alone, byte for byte") {
  const Scene scene;
  const auto path = [&](const char* name, const std::string& trace) {
    works(scene.touch("--path " + scene.file(name) + " --duration 0.3 --trace " + scene.file(trace)));
    return contentOf(scene.folder / trace);
  };
  const std::string a = path("a.csv", "a-trace.csv"), b = path("b.csv", "b-trace.csv");
  const auto traceOf = [&](int hand) { return "t" + std::to_string(hand) + ", of a hand.csv"; };
  std::string hands;
  for (int hand = 2; hand <= 8; ++hand)
    hands += " --hand 'path=" + scene.file(hand % 2 ? "a.csv" : "b.csv") + ",trace=" + scene.file(traceOf(hand)) + "'";
  const std::string all = "--duration 0.3 --path " + scene.file("a.csv") + hands;
  works(scene.touch(all + " --trace '" + scene.file(traceOf(1)) + "' --json " + scene.file("all.json")));
  for (int hand = 1; hand <= 8; ++hand) CHECK(contentOf(scene.folder / traceOf(hand)) == (hand % 2 ? a : b));
  CHECK(jsonOf(scene.folder / "all.json")["hands"].size() == 7);
  checkEnds(2, scene.touch(all + " --hand path=builtin:press"),
            {"--hand: 8 hands after the first are given; a session has 8 hands at most"});
}

TEST_CASE("options that are incompatible with another hand are refused with a reason") {
  const Scene scene;
  const auto wrong = [&](const std::string& options, const std::string& part, const std::string& backend = "cpu") {
    if (isLeftOut(options)) return;
    checkEnds(2, scene.touch(options, backend), {part});
  };
  const std::string path = "--hand path=builtin:press ";
  wrong("--hand device=path", "--hand device=path: device=path requires path=FILE.csv or path=builtin:NAME");
  wrong("--hand trace=t.csv", "device=path requires path=");
  wrong("--hand device=stick", "'stick' is not a device");
  wrong("--hand builtin:press", "--hand builtin:press: 'builtin:press' is not device=..., path=... or trace=...");
  wrong("--hand path=builtin:press,path=a.csv", "path is given twice");
  wrong("--hand path=", "path has no value");
  wrong("--hand device=replay:x.csv,path=builtin:press", "device=replay:x.csv does not follow a path");
  wrong("--hand device=openhaptics", "--hand device=openhaptics requires --realtime");
  wrong("--hand device=dhd --realtime", "--hand device=dhd requires --duration");
  wrong("--device hid --hand device=hid --realtime --duration 1", "hid is already used by another hand; name another");
  wrong(path + "--log " + scene.file("log"), "--log: a session log has one hand");
  wrong(path + "--method brute", "--hand: --method brute supports one hand; use fused", "vulkan");
  wrong(path + "--ahead on", "--ahead: queries of several hands cannot be submitted ahead", "vulkan");
  wrong("--second-device path", "unknown option '--second-device'");
  checkEnds(2, "touch " + scene.model + " --backend cuda " + path,
            {"--hand: --backend cuda supports one hand; use vulkan or cpu"});
}

}  // namespace palpate::two_hands_test
