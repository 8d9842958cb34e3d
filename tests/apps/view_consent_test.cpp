// ctest: waits
// The window asks after the guided test whether stiffness and axes are to be
// used from now on.
#include <nlohmann/json.hpp>

#include "tests/apps/window_play.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_consent_test {

namespace {

void makeSmallSphere(const std::filesystem::path& folder) {
  works("--quiet make sphere -n 8000 --size 60 -o " + (folder / "sphere.ply").string());
}

/// Of a person before a device that lies on its back, so that its -z is up:
/// still, then right, up and towards the person, and then leaning on the wall
/// below, and lifted now and then, since a stall of the machine takes the force
/// away until the hand is in free space.
std::vector<PathKey> leaning() {
  std::vector<PathKey> hand{{0, {0, 0, 0}},    {6, {0, 0, 0}},       {6.5, {30, 0, 0}},
                            {7, {30, 0, -30}}, {7.5, {30, 30, -30}}, {10.5, {30, 30, -30}}};
  for (double t_s = 11; t_s < 22; t_s += 4)
    for (const auto& [after_s, down_mm] : {std::pair{0.0, 10.0}, {3.0, 10.0}, {3.2, -5.0}, {3.6, -5.0}})
      hand.push_back({t_s + after_s, {30, 30, -30 + down_mm}});
  return hand;
}

/// A window in which a person does the guided test, ends it on the wall, and
/// then does `afterwards`.
struct Tested {
  explicit Tested(const std::string& afterwards)
      : played(play("--device haply --size 480x360 --backend cpu %/sphere.ply "
                    "--mm-per-unit 1",
                    fmt::format("0.2 click Device\n1.0 click Test...\n1.4 state "
                                "{}\n1.5 minimise\n1.6 await {}\n"
                                "1.7 restore\n2 click Stop\n3 state %/found.json\n{}",
                                (service.folder() / "begun.json").string(), (service.folder() / "path_end").string(),
                                afterwards),
                    "", makeSmallSphere)) {
    REQUIRE_MESSAGE(played->outcome.code == 0, played->outcome.text);
    const Result found = device("found.json");
    REQUIRE_MESSAGE(!found["found_stiffness_N_per_mm"].is_null(), found.dump());
    found_N_per_mm = found["found_stiffness_N_per_mm"].get<double>();
  }
  Result device(const std::string& state) const { return played->state(state)["device"]; }
  Result remembered() const { return jsonOf(folder / "palpate" / "devices.json")["devices"]; }

  ScratchFolder folder;
  Variable home{"XDG_CONFIG_HOME", folder.path().string()};
  FakeHaply service{{.hand = leaning(), .begins = "begun.json"}};
  std::unique_ptr<Played> played;
  double found_N_per_mm = 0;
};

}  // namespace

TEST_CASE(
    "stiffness and axes that a person agrees to in the window are used "
    "at once, and remembered" *
    kClock) {
  if (!hasDisplay()) return;
  const Tested tested(R"(3.1 screenshot %/found.png
3.2 key s
6 state %/stiffness.json
6.1 click Use these axes
9 state %/axes.json
9.1 screenshot %/agreed.png
9.2 quit
)");
  const Result stiffness = tested.played->state("stiffness.json"), axes = tested.played->state("axes.json");
  CHECK(stiffness["errors"].empty());
  CHECK(stiffness["device"]["stage"] == "held");
  CHECK(stiffness["device"]["axes"] == "x,y,z");
  CHECK(stiffness["device"]["found_stiffness_N_per_mm"].is_null());
  CHECK(stiffness["stiffness_N_per_mm"].get<double>() == near(tested.found_N_per_mm, 1e-9));
  CHECK(axes["errors"].empty());
  CHECK(axes["device"]["stage"] == "held");
  CHECK(axes["device"]["axes"] == "x,-z,y");
  CHECK(axes["device"]["position_mm"][1].get<double>() == within(-85, 2));
  CHECK(axes["device"]["position_mm"][2].get<double>() == within(180, 2));
  CHECK(axes["stiffness_N_per_mm"].get<double>() == near(tested.found_N_per_mm, 1e-9));
  const Result remembered = tested.remembered()["haply:049D"];
  CHECK(remembered["stiffness_N_per_mm"].get<double>() == near(tested.found_N_per_mm, 1e-9));
  CHECK(remembered["axes"] == "x,-z,y");
  CHECK(tested.service.commands().back().force_N == DVec3(0));
}

TEST_CASE(
    "a person who closes the result of the window's test has nothing "
    "remembered" *
    kClock) {
  if (!hasDisplay()) return;
  const Tested tested(R"(3.1 click Close
4 state %/closed.json
4.1 click Test...
5 state %/again.json
5.1 quit
)");
  const Result closed = tested.played->state("closed.json");
  CHECK(closed["device"]["stage"] == "held");
  CHECK(closed["device"]["remembered"] == "");
  CHECK(closed["device"]["axes"] == "x,y,z");
  CHECK(closed["stiffness_N_per_mm"] == 0.8);
  CHECK(tested.device("again.json")["stage"] == "tested");
  CHECK(tested.remembered().empty());
}

}  // namespace palpate::view_consent_test
