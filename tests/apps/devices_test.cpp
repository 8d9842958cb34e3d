// Haptic devices through a driver library that is found at run time, and through recordings.
#include <algorithm>

#include "tests/apps/running_program.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"

namespace palpate::devices_test {

namespace {

/// Outside, down onto the sphere, along it, and out again.
const char* const kHand = "0,0,40,0\n0.4,0,28.5,0\n0.9,4,28.2,0\n1.2,4,40,0\n";
constexpr double kDuration_s = 1.7;  // including half a second before the hand moves

struct Scene {
  Scene() { works("make sphere -n 20000 --size 60 -o " + model); }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  /// On the CPU, where equal poses give bitwise equal forces.
  std::string touch(const std::string& options) const {
    return "touch " + model + " --backend cpu --mm-per-unit 1 --stiffness 0.4 " + options;
  }
  std::string held(const std::string& options, const std::string& device = "openhaptics") const {
    return touch("--device " + device + " --realtime --map identity --duration " + std::to_string(kDuration_s) + " " +
                 options);
  }
  ScratchFolder folder;
  std::string model = (folder / "model.ply").string();
};

/// Largest difference of forces between two traces, up to the first tick missing in one of them.
struct Compared {
  double worst_N = 0, most_N = 0;
  std::size_t ticks = 0;
};
Compared compare(const std::vector<Row>& a, const std::vector<Row>& b) {
  Compared compared;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()) && a[i].t_s == b[i].t_s; ++i) {
    compared.worst_N = std::max(compared.worst_N, glm::distance(a[i].force, b[i].force));
    compared.most_N = std::max(compared.most_N, glm::length(a[i].force));
    ++compared.ticks;
  }
  return compared;
}

}  // namespace

TEST_CASE("the loop through a driver feels what the simulated Touch feels, and its log can be replayed" * kClock) {
  const Scene scene;
  const FakeDriver driver("fake_hd", "hurry\nskip 1\nlead 0.5", kHand);
  const std::string hand = (driver.folder() / "hand.csv").string();
  works(scene.touch("--device sim --map identity --path " + hand + " --trace " + scene.file("sim.csv")));
  works(scene.held("--trace " + scene.file("held.csv") + " --log " + scene.file("log") + " --json " +
                   scene.file("held.json")));
  const auto held = readTrace(scene.folder / "held.csv");
  const Compared compared = compare(held, readTrace(scene.folder / "sim.csv"));
  const auto missed = jsonOf(scene.folder / "held.json")["missed_ticks"].get<int>();
  CAPTURE(missed);
  CHECK(compared.worst_N <= 1e-6);
  CHECK((missed > 0 || compared.ticks == held.size()));
  if (missed == 0) CHECK(compared.most_N > 0.3);
  const FakeNote note = driver.note();
  CHECK(note.threadFaults + note.frameFaults == 0);
  CHECK(note.mostForce_N > 0.3);
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(note.closed == 1);

  works("replay " + scene.file("log"));
  works(scene.touch("--device replay:" + scene.file("log") + " --trace " + scene.file("again.csv")));
  if (missed == 0) CHECK(compare(held, readTrace(scene.folder / "again.csv")).worst_N <= 1e-9);
}

TEST_CASE("button 1 of a stylus sculpts" * kClock) {
  const Scene scene;
  std::string script = "hurry\nlead 0.5";
  bool pressed = false;
  SUBCASE("released") {}
  SUBCASE("pressed") {
    script += "\nbutton 1 0.9 0.3";
    pressed = true;
  }
  const FakeDriver driver("fake_hd", script, kHand);
  works(scene.held("--edit push --yield-depth 0.2 --json " + scene.file("out.json") + " --log " + scene.file("log")));
  CHECK((jsonOf(scene.folder / "out.json")["moved_points"].get<int>() > 0) == pressed);
  CHECK(driver.note().mostForce_N > 0.1);  // felt in either case
  works("replay " + scene.file("log"));
}

TEST_CASE("a device that fails during contact leaves the trace, zero force, and the driver's reason") {
  const Scene scene;
  const FakeDriver driver("fake_hd", "hurry\nlead 0.5\nfault error 770 1.35", kHand);
  const Outcome outcome = palpate(scene.held("--trace " + scene.file("t.csv")));
  CHECK(outcome.code == 1);
  CHECK(says(outcome.text, "palpate: Touch: no communication with the device (0x0302); check cable and power"));
  const auto rows = readTrace(scene.folder / "t.csv");
  REQUIRE(rows.size() > 50);
  CHECK(rows.back().force == DVec3(0));
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(driver.note().mostForce_N > 0.1);
  CHECK(driver.note().closed == 1);
}

TEST_CASE("a session that is interrupted or crashes leaves zero force") {
  const Scene scene;
  const FakeDriver driver("fake_hd", "lead 0.5", "0,0,40,0\n0.4,0,28.5,0\n");
  int signal = SIGTERM;
  SUBCASE("interrupted") {}
  SUBCASE("crashed") { signal = SIGSEGV; }
  RunningProgram session(scene.touch("--device openhaptics --realtime --map identity --duration 60"),
                         scene.folder / "said");
  REQUIRE_MESSAGE(session.waitFor([&] { return glm::length(driver.lastForce_N()) >= 0.15; }),
                  contentOf(scene.folder / "said"));
  session.wait(signal);
  CHECK(driver.lastForce_N() == DVec3(0));
}

TEST_CASE("a session that was suspended gives no force while the hand is still inside, and says so") {
  const Scene scene;
  const FakeDriver driver("fake_hd", "lead 0.5", "0,0,40,0\n0.4,0,28.5,0\n");
  RunningProgram session(
      scene.touch("--device openhaptics --realtime --map identity --duration 60 --json " + scene.file("out.json")),
      scene.folder / "said");
  // At the end of the path, where it leans on the sphere. The damping of the first contact is a force, too, but such a
  // small demand that it ends the wait.
  constexpr std::uint64_t kAtRest = 1000;
  REQUIRE_MESSAGE(
      session.waitFor([&] { return driver.note().frames > kAtRest && glm::length(driver.lastForce_N()) >= 0.15; }),
      contentOf(scene.folder / "said"));
  session.send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  const std::uint64_t before = driver.note().frames;
  session.send(SIGCONT);
  // The frame that was under way at the stop may still have its force; the next one finds the pause.
  REQUIRE(session.waitFor([&] { return driver.note().frames > before + 3; }));
  double most_N = 0;
  REQUIRE(session.waitFor([&] {
    most_N = std::max(most_N, glm::length(driver.lastForce_N()));
    return driver.note().frames > before + 1000;
  }));
  CHECK(most_N == 0);
  session.wait(SIGINT);
  CHECK(jsonOf(scene.folder / "out.json")["safety"]["errors"].get<int>() >= 1);
}

TEST_CASE("a Force Dimension device is felt through its own library" * kClock) {
  const Scene scene;
  const FakeDriver driver("fake_dhd", "hurry\nlead 0.5", kHand);
  works(scene.held("--json " + scene.file("out.json"), "dhd"));
  CHECK(driver.note().mostForce_N > 0.3);
  CHECK(jsonOf(scene.folder / "out.json")["contact_ticks"].get<int>() > 10);
}

TEST_CASE("without a driver library, or with a broken or old one, an error says what to do") {
  const Scene scene;
  const auto complaint = [&](const std::string& device) {
    const Outcome outcome = palpate(scene.held("--trace " + scene.file("t.csv"), device));
    CHECK(outcome.code == 1);
    CHECK_FALSE(std::filesystem::exists(scene.folder / "t.csv"));
    return outcome.text;
  };
  {
    const Variable variable("PALPATE_HD_LIBRARY", "/nowhere/libHD.so");
    CHECK(says(complaint("openhaptics"), "is not on this machine (looked for /nowhere/libHD.so)"));
  }
  {
    const Variable variable("PALPATE_HD_LIBRARY", fakeDriverFile("fake_hd_old").string());
    CHECK(says(complaint("openhaptics"), "has no hdGetErrorString; it is too old"));
  }
  {
    const Variable variable("PALPATE_DHD_LIBRARY", scene.model);
    CHECK(says(complaint("dhd"), "invalid ELF header"));
  }
  const FakeDriver driver("fake_hd", "fault init 769");
  CHECK(says(complaint("openhaptics:Nobody"), "the device 'Nobody' cannot be opened: another program uses the device"));
}

TEST_CASE("devices that conflict with other options are wrong usage") {
  const Scene scene;
  const auto wrong = [&](const std::string& options, const std::string& part) {
    const Outcome outcome = palpate(scene.touch(options));
    CHECK(outcome.code == 2);
    CHECK(says(outcome.text, part));
  };
  wrong("--device openhaptics", "--device openhaptics requires --realtime");
  wrong("--device openhaptics --realtime", "--device openhaptics requires --duration");
  wrong("--device stick", "'stick' is not a device; devices are path, sim, replay:FILE");
  wrong("--device dhd:two --realtime --duration 1", "is not the number of a device, 0 to 63");
  wrong("--device replay:x.csv --map identity", "--map");
}

TEST_CASE("a trajectory with forces is replayed, and the forces are compared") {
  const Scene scene;
  works(scene.touch("--path builtin:slide --trajectory " + scene.file("hand.csv") + " --trace " + scene.file("a.csv")));
  works(scene.touch("--path builtin:slide --trajectory " + scene.file("hand.txt")));
  for (const char* name : {"hand.csv", "hand.txt", "a.csv"}) {
    works(scene.touch("--device replay:" + scene.file(name) + " --json " + scene.file("out.json")));
    const auto recorded = jsonOf(scene.folder / "out.json")["recorded_forces"];
    CHECK(recorded["ticks"].get<int>() > 300);
    CHECK(recorded["worst_N"].get<double>() < 1e-9);
  }
  works(scene.touch("--max-force 0.1 --device replay:" + scene.file("hand.csv") + " --json " + scene.file("out.json")));
  CHECK(jsonOf(scene.folder / "out.json")["recorded_forces"]["rms_N"].get<double>() > 0.01);

  std::ofstream(scene.folder / "bad.csv") << "0 1 2 3\n1 2 3\n";
  const Outcome bad = palpate(scene.touch("--device replay:" + scene.file("bad.csv")));
  CHECK(bad.code == 1);
  CHECK(says(bad.text, "bad.csv:2: 3 columns"));
  std::ofstream(scene.folder / "far.csv") << "0 1e9 2 3\n1 1e9 2 4\n";
  CHECK(says(palpate(scene.touch("--device replay:" + scene.file("far.csv"))).text, "is never near the model"));
}

TEST_CASE("doctor reports which libraries it looked for, which it found, and which are missing") {
  const ScratchFolder folder;
  const std::string file = (folder / "doctor.json").string();
  const auto drivers = [&] { return jsonOf(folder / "doctor.json")["haptics"]["drivers"]; };
  {
    const Variable hd("PALPATE_HD_LIBRARY", "/nowhere/libHD.so"), dhd("PALPATE_DHD_LIBRARY", "/nowhere/libdhd.so");
    const Outcome outcome = palpate("doctor --json " + file);
    CHECK(outcome.code == 0);
    CHECK(says(outcome.text, "/nowhere/libHD.so: cannot open shared object file"));
    CHECK(drivers()[0]["usable"] == false);
    CHECK(drivers()[1]["usable"] == false);
    CHECK(jsonOf(folder / "doctor.json").contains("gpus"));
  }
  {
    const FakeDriver driver;
    const Outcome outcome = palpate("doctor --json " + file);
    CHECK(outcome.code == 0);
    CHECK(says(outcome.text, "Touch, serial number FAKE-0001"));
    CHECK(drivers()[0]["device"]["model"] == "Touch");
    CHECK(drivers()[0]["device"]["peak_force_N"] == 3.3);
    CHECK(driver.note().closed == 1);
  }
  {
    const FakeDriver driver("fake_hd", "fault calibration 100000");
    CHECK(says(palpate("doctor").text, "put the stylus into the inkwell"));
  }
  {
    const FakeDriver driver("fake_dhd_old");
    CHECK(palpate("doctor --json " + file).code == 0);
    CHECK(drivers()[1]["missing"][0] == "dhdSetWatchdog");
  }
}

TEST_CASE("doctor reports how many ticks an idle servo loop misses on this machine") {
  const ScratchFolder folder;
  const std::string file = (folder / "doctor.json").string();
  const Outcome outcome = palpate("doctor --servo 0.5 --rate 2000 --json " + file);
  CHECK(outcome.code == 0);
  CHECK(says(outcome.text, "of 1000 ticks missed"));
  const auto servo = jsonOf(file)["servo"];
  CHECK(servo["ticks"].get<int>() + servo["missed_ticks"].get<int>() == 1000);
  CHECK(servo["ticks"].get<int>() > 0);
  CHECK(palpate("doctor --rate 2000").code == 2);
  CHECK(says(palpate("doctor --servo -1").text, "--servo"));
}

TEST_CASE("a Haply device is felt through its service, and doctor describes it" * kClock) {
  const Scene scene;
  std::vector<PathKey> hand;  // taps, since the session starts some time after the device
  for (double t_s = 0; t_s < 12; t_s += 0.6)
    for (const PathKey& key :
         {PathKey{0, {0, 40, 0}}, PathKey{0.2, {0, 40, 0}}, PathKey{0.3, {0, 26, 0}}, PathKey{0.5, {0, 26, 0}}})
      hand.push_back({t_s + key.t_s, key.position});
  {
    const FakeHaply service({.hand = hand});
    works(scene.touch("--device haply --realtime --duration 1.6 --json " + scene.file("out.json")));
    double most_N = 0;
    const auto commands = service.commands();
    for (const FakeHaply::Command& command : commands) most_N = std::max(most_N, command.force_N.y);
    CHECK(most_N > 0.3);
    CHECK(commands.back().force_N == DVec3(0));
    CHECK(jsonOf(scene.folder / "out.json")["contact_ticks"].get<int>() > 10);
  }
  {
    const FakeHaply service({.calibrated = false});
    const Outcome outcome = palpate("doctor --json " + scene.file("doctor.json"));
    CHECK(says(outcome.text, "Inverse3, serial number 049D, firmware 7.4, right hand, axes XYZ: is not calibrated"));
    CHECK(says(outcome.text, "wireless grip 61548: connected: yes, battery 80 %"));
    const auto haply = jsonOf(scene.folder / "doctor.json")["haptics"]["haply"];
    CHECK(haply["version"] == "3.5.0");
    CHECK(haply["devices"][0]["serial"] == "049D");
    CHECK(haply["devices"][0]["calibrated"] == false);
    CHECK(service.commands().empty());
    const Outcome two = palpate("doctor --device haply:1234");
    CHECK(two.code == 1);
    CHECK(says(two.text, "no device '1234' is connected; devices are haply:049D (right hand)"));
  }
  {
    const FakeHaply service({.handedness = "left"});
    works("doctor --device haply:049D --json " + scene.file("doctor.json"));
    const auto device = jsonOf(scene.folder / "doctor.json")["device"];
    CHECK(device["serial"] == "049D");
    CHECK(device["handedness"] == "left");
    CHECK(device["renders_force"] == true);
    CHECK(device["peak_force_N"] == 3.3);
  }
  const Variable none("PALPATE_HAPLY_CONFIG", scene.file("none.json"));
  std::ofstream(scene.folder / "none.json") << R"({"communication/websocket/port": 1})";
  CHECK(says(palpate(scene.held("", "haply")).text, "the Haply service does not answer"));
}

TEST_CASE("doctor examines one device, and says which permission its kind lacks") {
  const ScratchFolder folder;
  const FakeDriver driver;
  works("doctor --device openhaptics --json " + (folder / "doctor.json").string());
  const auto device = jsonOf(folder / "doctor.json")["device"];
  CHECK(device["model"] == "Touch");
  CHECK(device["serial"] == "FAKE-0001");
  CHECK(device["workspace_max_mm"][0] == 80);
  CHECK(device["renders_force"] == true);
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(driver.note().closed == 1);
  CHECK(says(palpate("doctor --device stick").text, "'stick' is not a device; devices are openhaptics[:NAME]"));
}

TEST_CASE("doctor guides a person through the test of a device, with zero force in free space and at the end" *
          kClock) {
  const ScratchFolder folder;
  // Moves right, up and towards the user after three seconds, then leans on the wall that appears 5 mm below.
  const FakeDriver driver("fake_hd", "hurry",
                          "0,0,0,0\n3.5,0,0,0\n4.5,30,0,0\n5.5,30,30,0\n6.5,30,30,30\n7.5,30,20,30\n30,30,20,30\n");
  RunningProgram test("doctor --device openhaptics --test --json " + (folder / "out.json").string(), folder / "said");
  const auto said = [&] { return contentOf(folder / "said"); };
  REQUIRE_MESSAGE(test.waitFor([&] {
    return said().find("Lean on it gently") != std::string::npos && driver.note().mostForce_N > 0.2;
  }),
                  said());
  test.wait(SIGTERM);
  CHECK(says(said(), "Hold the stylus still"));
  CHECK(says(said(), "Move the stylus 3 cm to the right"));
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(says(palpate("doctor --test").text, "--device"));
  CHECK(says(palpate("doctor --device hid --test").text, "hid steers a simulated hand"));
}

/// Programs started during its lifetime see the HID device of a script (fake_hidapi.cpp).
class FakeHid {
 public:
  explicit FakeHid(const std::string& script)
      : loader_("LD_LIBRARY_PATH", fakeDevicesFolder() / "hidapi"), script_("PALPATE_FAKE_HID", folder_ / "hid") {
    std::ofstream(folder_ / "hid") << script;
  }

 private:
  ScratchFolder folder_;
  Variable loader_, script_;
};

constexpr const char* kMouse = "device /dev/null 256f c635 1 8 SpaceMouse Compact\n";

TEST_CASE("doctor lists a 3D mouse, and says what to do if it cannot be opened") {
  const ScratchFolder folder;
  const auto mice = [&] {
    works("doctor --json " + (folder / "doctor.json").string());
    return jsonOf(folder / "doctor.json")["haptics"]["hid"];
  };
  {
    const FakeHid hid(kMouse);
    CHECK(says(palpate("doctor").text, "--device hid: SpaceMouse Compact (256f:c635) at /dev/null, ready"));
    const auto found = mice();
    REQUIRE(found.size() == 1);
    CHECK(found[0]["usable"] == true);
    CHECK(found[0]["vendor"] == 0x256f);
  }
  {
    const FakeHid hid(std::string(kMouse) + "denied\n");
    CHECK(mice()[0]["usable"] == false);
    CHECK(mice()[0]["reason"].get<std::string>().size() > 5);
  }
  {
    // A Touch without a serial port is opened by its driver, and steers nothing by itself.
    const FakeHid hid("device /dev/null 2988 0301 ff00 1 Touch\ndenied\n");
    const Outcome outcome = palpate("doctor");
    CHECK(says(outcome.text, "--device openhaptics: Touch (2988:0301) at /dev/null, "));
    CHECK(says(outcome.text, "no 3D mouse and no DualSense is plugged in"));
  }
  {
    // A keyboard of the same vendor.
    const FakeHid hid("device /dev/null 046d c31c 1 6 Keyboard\n");
    CHECK(mice().empty());
    CHECK(says(palpate("doctor").text, "no 3D mouse and no DualSense is plugged in"));
  }
}

TEST_CASE("a 3D mouse pushes the stylus into the model, also after it was unplugged and plugged in again" * kClock) {
  const Scene scene;
  // Full deflection away from the user: the thirteen bytes of translation and rotation in one report.
  const std::string push = "1 0 0 a2 fe 0 0 0 0 0 0 0 0\n";
  const FakeHid hid(std::string(kMouse) + "push 0.7 1.3 " + push + "gone 2 0.6\npush 2.6 1 " + push);
  const Outcome outcome =
      palpate(scene.touch("--device hid --realtime --map identity --duration 3.5 --trace " + scene.file("t.csv")));
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  CHECK(says(outcome.text, "the stylus is SpaceMouse Compact"));
  const auto rows = readTrace(scene.folder / "t.csv");
  REQUIRE(rows.size() > 100);
  CHECK(rows.front().hip.z > 31);  // in front of the sphere
  CHECK(glm::length(rows.front().force) == 0);
  const auto felt = std::ranges::find_if(rows, [](const Row& row) { return row.force.z > 0.1; });  // inside it
  REQUIRE(bool(felt != rows.end()));
  // Without input it rests without a force.
  const auto rests = [&](auto from) {
    const auto moves = std::find_if(from, rows.end(), [&](const Row& row) {
      return glm::length(row.force) > 0 || glm::distance(row.hip, from->hip) >= 0.2;
    });
    return (moves - 1)->t_s - from->t_s > 0.25;
  };
  bool rested = false;
  for (auto row = felt + 1; row != rows.end() && !rested; ++row) rested = glm::length(row->force) == 0 && rests(row);
  CHECK(rested);
  CHECK(outcome.text.find("SpaceMouse Compact") != outcome.text.rfind("SpaceMouse Compact"));  // again
}

}  // namespace palpate::devices_test
