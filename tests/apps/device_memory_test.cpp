// What is remembered for a device: agreed to after the guided test, used by sessions, named and forgotten by doctor.
#include "tests/apps/running_program.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::device_memory_test {

namespace {

/// A folder of settings of its own, and a model.
struct User {
  User() { works("--quiet make sphere -n 20000 --size 60 -o " + model); }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  std::string touch(const std::string& options) const {
    return "touch " + model + " --backend cpu --mm-per-unit 1 --realtime --duration 0.5 --json " + file("touch.json") +
           " " + options;
  }
  Result touched() const { return jsonOf(folder / "touch.json"); }
  void remember(const std::string& text) const {
    std::filesystem::create_directories(folder / "palpate");
    std::ofstream(folder / "palpate" / "devices.json") << text;
  }
  bool hasFile() const { return std::filesystem::exists(folder / "palpate" / "devices.json"); }

  ScratchFolder folder;
  Variable home{"XDG_CONFIG_HOME", folder.path().string()};
  std::string model = (folder / "model.ply").string();
};

constexpr const char* kInverse =
    R"({"version": 1, "devices": {"haply:049D": {"model": "Inverse3 049D", "stiffness_N_per_mm": 0.3,
        "axes": "x,-z,y"}}})";

/// Of a person before a device that lies on its back, so that its -z is up: still, then right, up and towards the
/// person, then leaning on the wall below, and lifted now and then, for the step after the hum.
std::vector<PathKey> leaning() {
  std::vector<PathKey> hand{{0, {0, 0, 0}},      {4.5, {0, 0, 0}},   {5, {30, 0, 0}},
                            {5.5, {30, 0, -30}}, {6, {30, 30, -30}}, {6.5, {30, 30, -30}}};
  for (double t_s = 7; t_s < 70; t_s += 4)
    for (const auto& [after_s, down_mm] : {std::pair{0.0, 8.0}, {3.0, 8.0}, {3.2, -5.0}, {3.6, -5.0}})
      hand.push_back({t_s + after_s, {30, 30, -30 + down_mm}});
  return hand;
}

/// The same before a Touch, without a lift.
const char* const kLeaning = "0,0,0,0\n3.5,0,0,0\n4,30,0,0\n4.5,30,30,0\n5,30,30,30\n5.5,30,16,30\n60,30,16,30\n";

}  // namespace

TEST_CASE("the guided test finds stiffness and axes, and sessions use them once the person agrees" * kClock) {
  const User user;
  // A loose grip: it hums below the stiffest wall, unless other programs hold up the answers (device_check_test.cpp has
  // what decides it, by a clock that nothing holds up).
  const FakeHaply service({.hand = leaning(), .arm = {.handDamping_N_s_per_mm = 3e-4}});
  const std::string test = "doctor --device haply --test --json " + user.file("test.json");
  const Outcome outcome = run("printf 'y\\ny\\n' | " + program() + " " + test);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const Result found = jsonOf(user.folder / "test.json")["device_test"];
  CHECK(found["recommended_axes"] == "x,-z,y");
  CHECK(found["free_force_N"] == 0);
  CHECK(says(outcome.text, found["oscillated"] == true ? "stopped after" : "at least"));
  const double stiffness = found["recommended_stiffness_N_per_mm"].get<double>();
  CHECK(stiffness > 0.1);
  CHECK(says(outcome.text, "recommended       --stiffness"));
  CHECK(says(outcome.text, "N/mm with haply:049D from now on, and never a larger one? [y/N]"));
  CHECK(says(outcome.text, "Use the axes x,-z,y with haply:049D from now on? [y/N]"));
  CHECK(service.commands().back().force_N == DVec3(0));

  const Outcome touched = palpate(user.touch("--device haply"));
  REQUIRE_MESSAGE(touched.code == 0, touched.text);
  CHECK(says(touched.text, "axes x,-z,y, as remembered; palpate doctor --device haply:049D --forget removes that"));
  CHECK(user.touched()["stiffness_N_per_mm"].get<double>() == near(stiffness, 1e-9));
  CHECK(says(user.touched()["remembered"].get<std::string>(), "axes x,-z,y"));
  CHECK(says(palpate("doctor").text, "Remembered for haply:049D (Inverse3 049D): stiffness at most"));
}

TEST_CASE("a person who declines, or has no terminal, has nothing remembered" * kClock) {
  const User user;
  const FakeDriver driver("fake_hd", "hurry", kLeaning);
  const Outcome outcome = run(program() + " doctor --device openhaptics --test < /dev/null");
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  // The driver's model bears 0.4 N/mm, and does not hum there.
  CHECK(says(outcome.text, "up to 0.40 N/mm at least"));
  CHECK(says(outcome.text, "Use a stiffness of 0.28 N/mm with openhaptics:FAKE-0001 from now on"));
  CHECK_FALSE(says(outcome.text, "Use the axes"));
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK_FALSE(user.hasFile());
}

TEST_CASE("Ctrl+C in the guided test ends it with exit code 130, no force, and nothing remembered" * kClock) {
  const User user;
  const FakeDriver driver("fake_hd", "hurry", kLeaning);
  RunningProgram test("doctor --device openhaptics --test --json " + user.file("test.json"), user.folder / "said");
  REQUIRE_MESSAGE(test.waitFor([&] { return driver.note().mostForce_N > 0.2; }), contentOf(user.folder / "said"));
  const int status = test.wait(SIGINT);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 130);
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(driver.note().closed == 1);
  CHECK(says(contentOf(user.folder / "said"), "the test was interrupted; nothing is remembered"));
  CHECK(jsonOf(user.folder / "test.json")["device_test"]["peak_force_N"].get<double>() > 0.2);
  CHECK_FALSE(user.hasFile());
}

TEST_CASE("a cable unplugged in the middle of the guided test ends it with the reason, and no force" * kClock) {
  const User user;
  const FakeDriver driver("fake_hd", "hurry\nfault error 770 7", kLeaning);
  const Outcome outcome = run("yes | " + program() + " doctor --device openhaptics --test");
  CHECK(outcome.code == 1);
  CHECK(says(outcome.text, "no communication with the device (0x0302); check cable and power"));
  CHECK(driver.note().mostForce_N > 0.2);
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK_FALSE(user.hasFile());
}

TEST_CASE("a session never exceeds the remembered stiffness, and other axes can be asked for" * kClock) {
  const User user;
  user.remember(kInverse);
  const FakeHaply service({});
  works(user.touch("--device haply"));
  CHECK(user.touched()["stiffness_N_per_mm"] == 0.3);
  const Outcome other = palpate(user.touch("--device haply --stiffness 2 --axes x,y,z --log " + user.file("log")));
  REQUIRE_MESSAGE(other.code == 0, other.text);
  // The log's device has the limit that the session had.
  CHECK(says(contentOf(user.folder / "log"), R"("max_stiffness_N_per_mm": 0.3)"));
  CHECK(says(contentOf(user.folder / "log"), R"("axes": "x,y,z")"));
  CHECK(palpate(user.touch("--device haply --axes x,y")).code == 2);
  const Outcome path = palpate(user.touch("--axes x,z,-y"));
  CHECK(path.code == 2);
  CHECK(says(path.text, "--axes requires a device in a hand"));
}

TEST_CASE("doctor names what is remembered for a device, and forgets it") {
  const User user;
  user.remember(kInverse);
  const FakeHaply service({});
  works("doctor --device haply --json " + user.file("doctor.json"));
  CHECK(says(jsonOf(user.folder / "doctor.json")["device"]["remembered"].get<std::string>(), "axes x,-z,y"));
  CHECK(service.commands().back().force_N == DVec3(0));
  works("doctor --device haply:049D --forget --json " + user.file("forgotten.json"));
  CHECK(jsonOf(user.folder / "forgotten.json")["forgotten"][0] == "haply:049D");
  works("doctor --device haply --json " + user.file("doctor.json"));
  CHECK(jsonOf(user.folder / "doctor.json")["device"]["remembered"] == "");
  CHECK(says(palpate("doctor --device haply --forget").text, "nothing was remembered for haply"));
  CHECK(palpate("doctor --device haply --test --forget").code == 2);
}

TEST_CASE("a damaged file of remembered devices is reported, and does not keep a session from its device" * kClock) {
  const User user;
  user.remember("{");
  const FakeHaply service({});
  const Outcome touched = palpate(user.touch("--device haply"));
  CHECK(touched.code == 0);
  CHECK(says(touched.text, "devices.json"));
  CHECK(says(touched.text, "correct or remove it"));
  CHECK(says(palpate("doctor").text, "correct or remove it"));
  CHECK(palpate("doctor --device haply --forget").code == 1);
}

}  // namespace palpate::device_memory_test
