// The device panel of the window: the choice of a device, its state, the guided test, and what is remembered.
#include "tests/apps/window_play.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_device_test {

namespace {

void makeSmallSphere(const std::filesystem::path& folder) {
  works("--quiet make sphere -n 8000 --size 60 -o " + (folder / "sphere.ply").string());
}

/// A window with a small sphere that plays a script to its end.
std::unique_ptr<Played> played(const std::string& arguments, const std::string& script) {
  auto window = play(arguments, script, "", makeSmallSphere);
  REQUIRE_MESSAGE(window->outcome.code == 0, window->outcome.text);
  return window;
}

/// Above the sphere, and on it from a time on.
std::vector<PathKey> resting(double from_s) {
  return {{0, {0, 40, 0}}, {from_s, {0, 40, 0}}, {from_s + 0.3, {0, 26, 0}}};
}

/// Runs the window without a script, until Ctrl+C after some seconds. Returns what it printed.
std::string started(const ScratchFolder& folder, const std::string& arguments) {
  const std::string path = folder.path().string();
  return run("XDG_STATE_HOME=" + path + " XDG_CONFIG_HOME=" + path + " xvfb-run -a timeout -s INT 8 " + program() +
             " view " + path + "/sphere.ply --backend cpu --size 480x360 " + arguments)
      .text;
}

/// A window that plays a script, with settings of its own.
struct Settings {
  ScratchFolder folder;
  Variable home{"XDG_CONFIG_HOME", folder.path().string()};
  std::string devices() const { return contentOf(folder / "palpate" / "devices.json"); }
};

void remember(const ScratchFolder& folder, const std::string& device) {
  std::filesystem::create_directories(folder / "palpate");
  std::ofstream(folder / "palpate" / "devices.json") << R"({"version": 1, "window": ")" << device << "\"}";
}

}  // namespace

TEST_CASE("the window lists the devices, holds one, shows its state, and goes back to the mouse" * kClock) {
  if (!hasDisplay()) return;
  const Settings settings;
  const FakeHaply service({.handedness = "left", .pressed = true});
  const auto window = played("%/sphere.ply --mm-per-unit 1 --backend cpu --realtime", R"(
0.1 click Device
0.2 state %/before.json
0.3 click Look for devices
3.0 state %/found.json
3.1 click haply:049D
6.0 state %/held.json
6.1 screenshot %/held.png
6.2 click Use the mouse
7.0 state %/mouse.json
7.1 quit
)");
  const Result before = window->state("before.json")["device"];
  CHECK(before["stage"] == "mouse");
  CHECK(before["offers"].empty());
  const Result found = window->state("found.json")["device"]["offers"];
  REQUIRE(!found.empty());
  CHECK(found[0]["device"] == "haply:049D");
  CHECK(says(found[0]["state"].get<std::string>(), "is ready"));
  const Result held = window->state("held.json");
  CHECK(held["device"]["stage"] == "held");
  CHECK(held["device"]["name"] == "haply:049D");
  CHECK(held["device"]["serial"] == "049D");
  CHECK(held["device"]["buttons"] == 2);
  CHECK(held["device"]["renders_force"] == true);
  CHECK(held["device"]["position_mm"][1].get<double>() == near(150, 0.01));
  CHECK(held["stylus"] == true);
  CHECK(held["errors"].empty());
  const Result mouse = window->state("mouse.json");
  CHECK(mouse["device"]["stage"] == "mouse");
  CHECK(mouse["stylus"] == false);
  CHECK(mouse["ticks"].get<int>() > held["ticks"].get<int>());
  CHECK(service.commands().back().force_N == DVec3(0));
  CHECK(says(settings.devices(), R"("window": "mouse")"));
}

TEST_CASE("a small window says why each kind of device cannot be used, and its tooltip is beside the panel" * kClock) {
  if (!hasDisplay()) return;
  const Settings settings;
  const Variable noTouch("PALPATE_HD_LIBRARY", "/no/libHD.so"), noOmega("PALPATE_DHD_LIBRARY", "/no/libdhd.so");
  const Variable none("PALPATE_HAPLY_CONFIG", (settings.folder / "none.json").string());
  std::ofstream(settings.folder / "none.json") << R"({"communication/websocket/port": 1})";
  const auto window = played("%/sphere.ply --backend cpu --realtime --size 480x360", R"(
0.1 click Device
0.3 click Look for devices
3.0 state %/found.json
3.1 screenshot %/pointed.png
3.2 mouse 159 200
3.5 screenshot %/beside.png
3.6 quit
)");
  const Result device = window->state("found.json")["device"], missing = device["missing"];
  CHECK(device["offers"].empty());
  REQUIRE(missing.size() == 3);
  const std::array<std::array<const char*, 2>, 3> expected{
      {{"openhaptics", "/no/libHD.so"}, {"dhd", "/no/libdhd.so"}, {"haply", "does not answer"}}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(missing[i]["device"] == expected[i][0]);
    CHECK(says(missing[i]["reason"].get<std::string>(), expected[i][1]));
  }
  // In the panel only the button itself looks different when it is pointed at.
  const Picture pointed(window->folder / "pointed.png"), beside(window->folder / "beside.png");
  constexpr int kPanel = 240, kButton_px = 115 * 22;
  int inPanel = 0, tooltip = 0;
  for (int y = 0; y < pointed.height; ++y)
    for (int x = 0; x < pointed.width; ++x) (x >= kPanel ? inPanel : tooltip) += pointed.at(x, y) != beside.at(x, y);
  CHECK(inPanel > 1000);
  CHECK(inPanel < kButton_px);
  CHECK(tooltip > 1000);
}

TEST_CASE("a stiffness that is remembered for a device applies while it is held and not forgotten" * kClock) {
  if (!hasDisplay()) return;
  const Settings settings;
  std::filesystem::create_directories(settings.folder / "palpate");
  std::ofstream(settings.folder / "palpate" / "devices.json")
      << R"({"version": 1, "devices": {"haply:049D": {"stiffness_N_per_mm": 0.35}}})";
  const FakeHaply service({});
  const auto window = played("%/sphere.ply --mm-per-unit 1 --backend cpu --device haply", R"(
0.1 click Device
0.5 state %/held.json
0.6 click Use the mouse
1.5 state %/mouse.json
1.6 click Look for devices
3.5 click haply:049D
5.5 state %/again.json
5.6 click Forget
7.5 state %/forgotten.json
7.6 quit
)");
  const auto stiffness = [&](const char* state) { return window->state(state)["stiffness_N_per_mm"].get<double>(); };
  CHECK(stiffness("held.json") == near(0.35, 1e-9));
  CHECK(stiffness("mouse.json") == near(0.8, 1e-9));
  CHECK(stiffness("again.json") == near(0.35, 1e-9));
  const Result forgotten = window->state("forgotten.json");
  CHECK(forgotten["device"]["stage"] == "held");
  CHECK(forgotten["device"]["remembered"] == "");
  CHECK(stiffness("forgotten.json") == near(0.8, 1e-9));
}

TEST_CASE("a device that is lost while a model is felt leaves the stylus to the mouse, and says why" * kClock) {
  if (!hasDisplay()) return;
  const Settings settings;
  const FakeHaply service({.hand = resting(1), .begins = "begun.json", .fault = "closed"});
  const auto file = [&](const char* name) { return (service.folder() / name).string(); };
  const auto window = played("%/sphere.ply --mm-per-unit 1 --backend cpu --device haply",
                             fmt::format(R"(
0.1 click Device
0.5 state {}
0.6 await {}
2.5 state %/lost.json
2.6 screenshot %/lost.png
2.7 mouse 200 150
2.8 key space down
3.4 state %/later.json
3.5 quit
)",
                                         file("begun.json"), file("fault")));
  const Result lost = window->state("lost.json");
  CHECK(lost["device"]["stage"] == "mouse");
  CHECK(lost["peak_force_N"].get<double>() > FakeHaply::kFelt_N);
  REQUIRE(lost["errors"].size() == 1);
  CHECK(says(lost["errors"][0].get<std::string>(), "the Haply service closed the connection"));
  CHECK(says(lost["errors"][0].get<std::string>(), "the mouse moves the stylus now"));
  CHECK(window->state("later.json")["ticks"].get<int>() > lost["ticks"].get<int>());
  CHECK(service.forcesAfterFault() <= 2);
}

TEST_CASE("the guided test in the window finds a stiffness, and the device is held again" * kClock) {
  if (!hasDisplay()) return;
  const Settings settings;
  // Still, to the right, up, towards the user, and from 11 s on onto the wall, lifted now and then.
  std::vector<PathKey> hand{{0, {0, 0, 0}},   {6, {0, 0, 0}},      {6.5, {30, 0, 0}},
                            {7, {30, 30, 0}}, {7.5, {30, 30, 30}}, {10.5, {30, 30, 30}}};
  for (double t_s = 11; t_s < 50; t_s += 4)
    for (const auto& [after_s, y_mm] : {std::pair{0.0, 19.0}, {3.0, 19.0}, {3.2, 35.0}, {3.6, 35.0}})
      hand.push_back({t_s + after_s, {30, y_mm, 30}});
  const FakeHaply service({.hand = hand, .begins = "begun.json"});
  const auto file = [&](const char* name) { return (service.folder() / name).string(); };
  const auto window = played("--device haply --size 800x600 --backend cpu %/sphere.ply --mm-per-unit 1",
                             fmt::format(R"(
0.2 click Device
1.0 click Test...
1.4 state {}
1.5 screenshot %/begun.png
10.3 state %/leans.json
10.3 screenshot %/leans.png
10.4 minimise
10.5 await {}
10.6 restore
11 state %/done.json
11 screenshot %/done.png
11.1 quit
)",
                                         file("begun.json"), file("path_end")));
  CHECK(says(jsonOf(service.folder() / "begun.json")["device"]["instruction"].get<std::string>(),
             "Hold the stylus still"));
  CHECK(says(window->state("leans.json")["device"]["instruction"].get<std::string>(), "Lean on it gently"));
  const Result done = window->state("done.json")["device"];
  CHECK(done["stage"] == "held");
  const double stiffness = done["found_stiffness_N_per_mm"].get<double>();
  CHECK(stiffness > 0.1);
  CHECK(service.commands().back().force_N == DVec3(0));
}

TEST_CASE("the window holds the device that it used last, and the mouse where there was none or it is gone" * kClock) {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  makeSmallSphere(folder.path());
  {
    const FakeHaply service({});
    started(folder, "");
    CHECK(service.commands().empty());
    remember(folder, "haply");
    const std::string said = started(folder, "");
    CHECK_MESSAGE(!service.commands().empty(), said);
    CHECK(service.commands().back().force_N == DVec3(0));
    const std::size_t before = service.commands().size();
    started(folder, "--device mouse");
    CHECK(service.commands().size() == before);
    CHECK(says(contentOf(folder / "palpate" / "devices.json"), R"("window": "mouse")"));
  }
  remember(folder, "haply");
  const Variable none("PALPATE_HAPLY_CONFIG", (folder / "none.json").string());
  std::ofstream(folder / "none.json") << R"({"communication/websocket/port": 1})";
  CHECK(says(started(folder, ""), "haply, used last, cannot be used; the mouse moves the stylus"));
}

TEST_CASE("a script with a clock of its own holds no device, and says what it requires") {
  if (!hasDisplay()) return;
  const Settings settings;
  const FakeHaply service({});
  const auto window = played("%/sphere.ply --size 480x360", R"(
0.2 click Device
0.3 click Look for devices
30 click haply:049D
31 state %/refused.json
32 quit
)");
  const Result refused = window->state("refused.json");
  CHECK(refused["device"]["stage"] == "mouse");
  REQUIRE(refused["errors"].size() == 1);
  CHECK(says(refused["errors"][0].get<std::string>(), "play the script with --realtime"));
  CHECK(service.commands().empty());
}

}  // namespace palpate::view_device_test
