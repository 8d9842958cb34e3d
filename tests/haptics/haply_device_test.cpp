// A Haply device against a service in this process, over real sockets. Its faults: device_faults_test.cpp.
// ctest: waits
#include <algorithm>
#include <atomic>
#include <ctime>
#include <fstream>

#include "engine/core/error.hpp"
#include "haptics/device_check.hpp"
#include "haptics/tick_pacer.hpp"
#include "tests/error_of.hpp"
#include "tests/haptics/haply_session.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::haply_device_test {
namespace {

constexpr double kRate_Hz = 1000;  // of the states; where faults are judged, as many as a service tells: four a tick
constexpr DVec3 kMiddle_mm = FakeHaply::kMiddle_mm;
std::string complaintOf(const HaplyOptions& options = {}) {
  return errorOf([&] { const HaplyDevice device(options); });
}

/// With free space between 1.2 and 1.6 s.
const std::vector<PathKey> kPressingTwice{{0, {0, 26, 0}},   {0.2, {0, 26, 0}}, {0.4, {0, 14, 0}}, {1.2, {0, 14, 0}},
                                          {1.3, {0, 26, 0}}, {1.4, {0, 26, 0}}, {1.6, {0, 14, 0}}};

/// A state that is ready for forces.
DeviceState settled(HaplyDevice& device) {
  for (int i = 0; i < 2000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (const DeviceState state = device.read(0); state.ok && state.rendersForce) return state;
  }
  return {};
}

/// Until the service has at least so many.
std::vector<FakeHaply::Command> commandsAfter(const FakeHaply& service, std::size_t count) {
  for (int i = 0; i < 30'000 && service.commands().size() < count; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  REQUIRE(service.commands().size() >= count);
  return service.commands();
}

/// Writes a force until a larger one than any before arrives at the service.
void pushUntilFelt(HaplyDevice& device, const FakeHaply& service, const DVec3& force_N) {
  const double before_N = most_N(service.commands());
  for (int i = 0; i < 30'000 && most_N(service.commands()) <= before_N; ++i) {
    CHECK(device.write(force_N));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// A wall pushes along +y with stiffness times depth.
void checkWall(const std::vector<FakeHaply::Command>& commands) {
  double force_N = 0, expected_N = 0, sideways_N = 0;
  int count = 0;
  for (const FakeHaply::Command& command : commands) {
    if (command.time_s < 1.0 || command.time_s > 1.25) continue;
    const double depth_mm = kHaplySphere_mm - glm::length(command.position_mm);
    force_N += command.force_N.y;
    expected_N += kHaplyStiffness_N_per_mm * depth_mm;
    sideways_N = std::max(sideways_N, std::hypot(command.force_N.x, command.force_N.z));
    ++count;
  }
  REQUIRE(count > 20);
  MESSAGE("a wall's force: " << force_N / count << " N arrive for " << expected_N / count << " N, " << count
                             << " commands");
  CHECK(expected_N / count > 0.3);
  CHECK(force_N == near(expected_N, 0.02));
  CHECK(sideways_N < 0.02);
  CHECK(commands.back().force_N == DVec3(0));
}

}  // namespace

TEST_CASE("the force of a wall arrives at a Haply device with its direction and size, in either spelling") {
  FakeHaplyOptions options{.hand = kHaplyPressing, .rate_Hz = kRate_Hz};
  bool values = false;
  SUBCASE("service 3.5 says vector") {}
  SUBCASE("service 3.1 says values, and tells its version elsewhere") {
    options.version = "3.1.2";
    values = true;
  }
  SUBCASE("a permuted basis is undone") { options.permutation = "ZXY"; }
  SUBCASE("a mirrored basis of a device for the left hand") {
    options.permutation = "X-ZY";
    options.handedness = "left";
  }
  SUBCASE("a service that reports no force") { options.tellsForce = false; }
  SUBCASE("a service with 4000 states a second") { options.rate_Hz = 4000; }
  SUBCASE("a service with 200 states a second") { options.rate_Hz = 200; }
  const HaplyFelt felt = feelHaply(options, 1.4);
  CHECK_MESSAGE(!felt.result.deviceFailed, felt.result.fault);
  const auto& commands = felt.commands;
  checkWall(commands);
  CHECK(commands.front().profile);
  CHECK_FALSE(commands.back().profile);
  CHECK(std::ranges::all_of(commands, [&](const auto& command) { return command.values == values; }));
  if (options.permutation != "XYZ") CHECK(says(felt.said, "its axes are permuted (" + options.permutation + ")"));
  CHECK(says(felt.said, "set up for the " + options.handedness + " hand"));
}

TEST_CASE("after a fault of a Haply device the force returns from free space") {
  const HaplyFelt felt =
      feelHaply({.hand = kPressingTwice, .rate_Hz = kRate_Hz, .fault = "uncalibrated", .fault_s = 0.15}, 2.2);
  const auto& commands = felt.commands;
  const double fault_s = felt.faultBegan_s;
  REQUIRE(fault_s > 0);
  CHECK(most_N(commands, 0, fault_s) > FakeHaply::kFelt_N);
  CHECK(most_N(commands, fault_s + 0.01, 1.2) == 0);
  CHECK(most_N(commands, 1.7, 2.2) > 0.3);
  CHECK(says(felt.said, "is ready (white light"));
}

TEST_CASE("a Haply service that was busy and answers many commands at once gives a pose and a force again") {
  const HaplyFelt felt =
      feelHaply({.hand = kPressingTwice, .rate_Hz = kRate_Hz, .fault = "merged", .fault_s = 0.15}, 2.2);
  REQUIRE(felt.faultBegan_s > 0);
  CHECK_FALSE(felt.result.deviceFailed);
  CHECK(most_N(felt.commands, felt.faultBegan_s + 0.03, 1.2) == 0);
  CHECK(most_N(felt.commands, 1.7, 2.2) > 0.3);
  CHECK(says(felt.said, "is ready (white light"));
}

TEST_CASE("a terminal that is stopped when a Haply device reports a fault keeps no force in the hand") {
  SteppedClock clock;
  const FakeHaply service(
      {.hand = kHaplyPressing, .clock = &clock, .rate_Hz = kRate_Hz, .fault = "uncalibrated", .fault_s = 0.1});
  std::atomic<bool> zeroCame = false;
  const auto stopped = [&](const std::string& sentence) {
    if (sentence.find("is not calibrated") == std::string::npos) return;
    const Stopwatch since;
    while (!zeroCame && since.elapsed_s() < 5) {
      const auto commands = service.commands();
      zeroCame = commands.back().afterFault && commands.back().force_N == DVec3(0);
      std::this_thread::yield();
    }
  };
  clock.hold();
  {
    HaplyDevice device({.say = stopped, .clock = &clock});
    SphereContact sphere(kHaplySphere_mm, kMiddle_mm);
    ServoLoop(device, sphere, ForceLaw({.stiffness_N_per_mm = kHaplyStiffness_N_per_mm}, {}),
              {.duration_s = 0.6, .realtime = true, .clock = &clock})
        .run();
    clock.leave();
  }
  REQUIRE(service.faultBegan_s() > 0);
  CHECK(zeroCame);
  CHECK(service.forcesAfterFault() <= 1);
}

TEST_CASE("a Haply service that hangs up is reported at once, and no core spins meanwhile") {
  const FakeHaply service({.hangsUp = true});
  const std::clock_t before = std::clock();
  CHECK(says(complaintOf(), "the Haply service closes the connection before it lists its devices; start it again"));
  CHECK(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC < 0.3);
}

TEST_CASE(
    "a second program's force on a Haply device takes palpate's away, until it is gone and the hand in free space") {
  FakeHaplyOptions options{.hand = kPressingTwice, .fault = "second", .fault_s = 0.15};
  bool shares = false;
  SUBCASE("its force is seen in the states") {}
  SUBCASE("through a permuted basis, too") { options.permutation = "ZX-Y"; }
  SUBCASE("but both add up where that is asked for") { shares = true; }
  const HaplyFelt felt = feelHaply(options, 2.2, {.shares = shares});
  const auto& commands = felt.commands;
  const double fault_s = felt.faultBegan_s;
  REQUIRE_MESSAGE(fault_s > 0, felt.said);
  CHECK_FALSE(felt.result.deviceFailed);
  CHECK(most_N(commands, 0, fault_s) > FakeHaply::kFelt_N);
  CHECK(most_N(commands, 1.7, 2.2) > 0.3);
  CHECK(commands.back().force_N == DVec3(0));
  const std::string sentence = "receives forces from another program";
  const std::size_t said = felt.said.find(sentence);
  if (shares) {
    CHECK(most_N(commands, fault_s, fault_s + options.fault_s) > FakeHaply::kFelt_N);
    CHECK(said == std::string::npos);
    return;
  }
  int forces = 0;  // commands with a force between the second program's begin and the free space
  double zero_ms = 0;
  for (const FakeHaply::Command& command : commands)
    if (command.afterFault && command.time_s < 1.2 && command.force_N != DVec3(0)) {
      ++forces;
      zero_ms = std::max(zero_ms, 1e3 * (command.time_s - fault_s));
    }
  MESSAGE("| second | " << forces << " | " << zero_ms << " | goes on |");
  CHECK(forces <= haply::ForceWatch::kStates + 1);
  REQUIRE(said != std::string::npos);
  CHECK(felt.said.find(sentence, said + 1) == std::string::npos);
  CHECK(says(felt.said.substr(said), "is ready (white light"));
}

TEST_CASE("a force that a Haply service reports late or rounded is not another program's") {
  haply::ForceWatch watch;
  const auto showsAnother = [&](const DVec3& reported_N, int states) {
    bool shows = false;
    for (int i = 0; i < states; ++i) shows = watch.showsAnother(reported_N);
    return shows;
  };
  for (int i = 0; i < 40; ++i) {
    watch.sent({0, 0.1 * i, 0});
    CHECK_FALSE(watch.showsAnother(DVec3(0.05, 0.1 * std::max(i - 10, 0), 0)));
  }
  CHECK_FALSE(showsAnother({0, 3.5, 0.6}, haply::ForceWatch::kStates - 1));
  CHECK(showsAnother({0, 3.5, 0.6}, 1));
  CHECK_FALSE(watch.showsAnother(std::nullopt));
  CHECK_FALSE(showsAnother({0, 3.5, 0}, 1));
  CHECK_FALSE(showsAnother({0, 3.5, 0.6}, haply::ForceWatch::kStates - 1));
}

TEST_CASE("a Haply device's pose has palpate's axes, and its grip's orientation and buttons") {
  FakeHaplyOptions options{.hand = {{0, {11, 22, -33}}}, .pressed = true};
  DQuat turn(std::sqrt(0.5), 0, std::sqrt(0.5), 0);  // about Haply's z, which is palpate's y
  std::uint32_t buttons = 2;
  int count = 2;
  SUBCASE("wireless") {}
  SUBCASE("wired") {
    options.wireless = false;
    turn = {1, 0, 0, 0};
    buttons = count = 1;
  }
  SUBCASE("without a grip") {
    options.grips = false;
    turn = {1, 0, 0, 0};
    buttons = 0;
    count = 0;
  }
  SteppedClock still;
  options.clock = &still;
  const FakeHaply service(options);
  HaplyDevice device({.clock = &still});
  const DeviceState state = settled(device);
  REQUIRE(state.ok);
  CHECK(glm::distance(state.position, kMiddle_mm + DVec3(11, 22, -33)) < 0.1);
  CHECK(std::abs(glm::dot(state.turn, turn)) == near(1, 1e-9));
  CHECK(state.buttons == buttons);
  CHECK(device.limits().buttons == count);
}

TEST_CASE("a mirrored basis turns a Haply grip the right way") {
  // A quarter about the first of the program's axes, in a frame whose second axis is negated.
  const auto axes = haply::axesOf("X-YZ");
  REQUIRE(axes.has_value());
  const std::string message =
      R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0.001,"y":0.002,"z":0.003}}}],
          "verse_grip":[{"device_id":"1","state":{"orientation":{"w":1,"x":0,"y":0,"z":1}}}]})";
  const haply::State state = haply::stateIn(message, {.id = "A", .grip = "1", .wireless = false, .axes = *axes}, {});
  CHECK(glm::distance(state.position_mm, DVec3(1, 3, 2)) < 1e-9);
  // Mirrored, a turn about up goes the other way round.
  CHECK(std::abs(glm::dot(state.turn, DQuat(std::sqrt(0.5), 0, -std::sqrt(0.5), 0))) == near(1, 1e-9));
  CHECK_FALSE(haply::axesOf("XXY").has_value());
  CHECK_FALSE(haply::axesOf("XY").has_value());
}

TEST_CASE("two Haply devices are told apart by their serial numbers") {
  const FakeHaply service({.ids = {"049D", "0815"}});
  CHECK(
      says(complaintOf(), "there are 2 devices; choose one by its serial number: haply:049D (right hand), haply:0815"));
  CHECK(says(complaintOf({.serial = "1234"}), "no device '1234' is connected; devices are haply:049D"));
  {
    HaplyDevice device({.serial = "0815"});
    settled(device);
    CHECK(device.facts().serial == "0815");
  }
  const auto commands = service.commands();
  REQUIRE_FALSE(commands.empty());
  CHECK(std::ranges::all_of(commands, [](const auto& command) { return command.id == "0815"; }));
}

TEST_CASE("a Haply device in another program's use is refused, unless it is asked for") {
  const FakeHaply service({.inUse = true});
  CHECK(says(complaintOf(), "another program uses 049D, and the forces of both would add up"));
  CHECK(service.commands().empty());
  CHECK(complaintOf({.shares = true}).empty());
}

TEST_CASE("without a Haply service, a device or a readable configuration an error says what to do") {
  const ScratchFolder folder;
  const Variable config("PALPATE_HAPLY_CONFIG", (folder / "haply.json").string());
  const auto complains = [&](const std::string& text, const std::string& part) {
    std::ofstream(folder / "haply.json") << text;
    CHECK(says(complaintOf(), part));
  };
  complains(R"({"communication/websocket/port": 1})", "the Haply service does not answer (127.0.0.1:1: ");
  complains(R"({"communication/websocket/port": 70000})", "haply.json: communication/websocket/port is not a port");
  complains("{", "haply.json: is not the JSON of the Haply service's configuration");
  const FakeHaply service({.ids = {}});
  CHECK(says(complaintOf(), "the Haply service has no Inverse3; check its cable and power supply"));
}

TEST_CASE("a crash leaves a Haply device without a force") {
  SteppedClock still;
  const FakeHaply service({.clock = &still});
  HaplyDevice device({.clock = &still});
  settled(device);
  pushUntilFelt(device, service, {0, 1, 0});
  device.emergencyStop();
  CHECK(device.write({0, 1, 0}));
  const std::size_t before = service.commands().size();
  const auto later = commandsAfter(service, before + 20);
  CHECK(most_N({later.begin() + static_cast<std::ptrdiff_t>(before) + 1, later.end()}) == 0);
}

TEST_CASE("a session that no longer writes forces to a Haply device leaves it without one" * kClock) {
  const FakeHaply service({});
  HaplyDevice device({});
  settled(device);
  pushUntilFelt(device, service, {0, 1, 0});
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  CHECK(commandsAfter(service, service.commands().size() + 2).back().force_N == DVec3(0));
  CHECK_FALSE(device.write({std::nan(""), 0, 0}));
  pushUntilFelt(device, service, {0, 100, 0});
  CHECK(most_N(service.commands()) == near(device.limits().peakForce_N, 1e-9));
}

TEST_CASE("the force answers a Haply device's pose within a few milliseconds" * kMoreInFull * kClock) {
  const auto steps = byTier<std::size_t>(150, 3000);
  constexpr double kStep_s = 0.006;
  const FakeHaply service({.step_s = kStep_s});
  HaplyDevice device({});
  settled(device);
  const TickPacer pacer(1000, false);
  const std::size_t before = service.latencies_us().size();
  const auto answered = [&] { return service.latencies_us().size() - before; };
  for (std::uint64_t tick = 0; tick < 60'000 && answered() < steps; tick = pacer.waitFor(tick + 1)) {
    const DeviceState state = device.read(0);
    REQUIRE(device.write({0, state.position.y - kMiddle_mm.y, 0}));
  }
  std::vector<double> all = service.latencies_us();
  std::vector<double> latencies(all.begin() + static_cast<std::ptrdiff_t>(before), all.end());
  REQUIRE(latencies.size() >= steps);
  std::ranges::sort(latencies);
  const auto at = [&](double share) {
    return latencies[std::min(latencies.size() - 1,
                              static_cast<std::size_t>(share * static_cast<double>(latencies.size())))];
  };
  MESSAGE("pose to force: median " << at(0.5) << " us, p99.9 " << at(0.999) << " us, N " << latencies.size());
#if defined(__SANITIZE_THREAD__)
  CHECK(at(0.5) < 20'000);  // ThreadSanitizer takes most of the time, in the service as well
#else
  CHECK(at(0.5) < 4000);
#endif
}

TEST_CASE("the version of a Haply service decides the spelling of the force") {
  CHECK(haply::versionIn(R"({"build_time": "2024-08-07T16:00:00", "version": "3.0.5"})") == "3.0.5");
  CHECK(haply::versionIn("3.5.1-rc") == "3.5.1");
  CHECK(haply::versionIn("no number").empty());
  CHECK(haply::saysValues("3.0.5"));
  CHECK(haply::saysValues("3.1"));
  CHECK_FALSE(haply::saysValues("3.2.0"));
  CHECK_FALSE(haply::saysValues(""));
}

TEST_CASE("a Haply device that fails while its test is under way has no force within two ticks") {
  // Still, then right, up, towards the user, and down onto the wall.
  const FakeHaplyOptions fake{.hand = {{0, {0, 0, 0}},
                                       {1.5, {0, 0, 0}},
                                       {2, {30, 0, 0}},
                                       {2.5, {30, 30, 0}},
                                       {3, {30, 30, 30}},
                                       {3.6, {30, 20, 30}}},
                              .rate_Hz = kRate_Hz,
                              .fault = "closed",
                              .fault_s = 5};
  DeviceCheckResult result;
  const HaplyFelt felt = playHaply(fake, {}, [&](HaplyDevice& device, SteppedClock* clock) {
    DeviceCheckQuery query({.freeSpace_s = 0.5, .softest_N_per_mm = 0.2, .clock = clock}, device.limits());
    result = checkDevice(device, query);
    return ServoResult{};
  });
  CHECK(result.axesAreRight());
  CHECK(result.freeForce_N == 0);
  CHECK(result.peakForce_N > FakeHaply::kFelt_N);
  CHECK_FALSE(result.fault.empty());
  CHECK_FALSE(result.offeredStiffness_N_per_mm());
  CHECK(felt.faultBegan_s > 0);
  CHECK(felt.forcesAfterFault().size() <= 1);
}

}  // namespace palpate::haply_device_test
