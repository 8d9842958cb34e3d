// Matter simulated elsewhere, as a hand feels it here: over links with a given delay, without a network.
#include <doctest/doctest.h>

#include <optional>
#include <random>

#include "tests/labels.hpp"
#include "tests/matter/far_matter.hpp"

namespace palpate::pond_test {

namespace {

MatterScene smallTank(Matter matter = Matter::water) {
  MatterScene scene = tank({12, 20, 12}, 11);
  scene.matter = matter;
  if (matter == Matter::sand) scene.density_kg_m3 = 1600;
  scene.tool = usualTool(scene);
  scene.tool.radius_mm = 25;
  return scene;
}

double buoyancy_N(const MatterScene& scene) {
  const double radius_m = scene.tool.radius_mm * 1e-3;
  return scene.density_kg_m3 * kGravity_m_s2 * 4 * 3.14159265358979 / 3 * radius_m * radius_m * radius_m;
}

/// The same hand in remote matter and, for comparison, in the same matter here.
class Both {
 public:
  Both(const MatterScene& scene, double delay_s, bool compares = true) : far_(scene, delay_s) {
    if (compares) local_.emplace(scene, MatterOptions{.threads = 1, .tools = 1});
  }

  struct Felt {
    DVec3 local{0}, far{0};  // means, N
    double trembles_N = 0;   // RMS of the far force about its mean
  };
  /// Takes `steps` steps at that velocity; the first `settling` ones do not count.
  Felt go(int steps, const DVec3& velocity_m_s, int settling) {
    Felt felt;
    double square = 0;
    for (int k = 0; k < steps; ++k) {
      hand_.place_m += kMatterStep_s * velocity_m_s;
      far_.step(hand_);
      if (local_) local_->step({&hand_, 1});
      least_J_ = std::min(least_J_, far_.here().portEnergy_J(0));
      most_N_ = std::max(most_N_, glm::length(far_.felt().force_N));
      if (local_) mostHere_N_ = std::max(mostHere_N_, glm::length(local_->answers()[0].force_N));
      if (k < settling) continue;
      if (local_) felt.local += local_->answers()[0].force_N / double(steps - settling);
      felt.far += far_.felt().force_N / double(steps - settling);
      square += glm::dot(far_.felt().force_N, far_.felt().force_N) / double(steps - settling);
    }
    felt.trembles_N = std::sqrt(std::max(0.0, square - glm::dot(felt.far, felt.far)));
    return felt;
  }
  FarMatter& far() { return far_; }
  double min_J() const { return least_J_; }
  double most_N() const { return most_N_; }
  double mostHere_N() const { return mostHere_N_; }  // in the same matter here
  HandPose& hand() { return hand_; }
  /// Steps until the remote state is known here, with the ball at that position.
  void meet(const DVec3& place_m, double delay_s) {
    hand_.place_m = place_m;
    go(static_cast<int>(2e3 * delay_s) + 200, DVec3(0), 0);
  }

 private:
  FarMatter far_;
  std::optional<MatterWorld> local_;
  HandPose hand_{.place_m = {0.06, 0.15, 0.06}};
  double least_J_ = 0, most_N_ = 0, mostHere_N_ = 0;
};

}  // namespace

TEST_CASE("in remote water a ball floats as in local water, and has about the same drag" * kFull) {
  const MatterScene scene = smallTank();
  const double expected_N = buoyancy_N(scene);
  for (const double delay_s : {0.0, 0.05, 0.5}) {
    Both both(scene, delay_s);
    both.go(900, {0, -0.1, 0}, 0);
    const Both::Felt held = both.go(900, DVec3(0), 500);
    const Both::Felt right = both.go(400, {0.05, 0, 0}, 150), left = both.go(400, {-0.05, 0, 0}, 150);
    const double drag_N = (left.far.x - right.far.x) / 2, localDrag_N = (left.local.x - right.local.x) / 2;
    MESSAGE(fmt::format(
        "{:.0f} ms each way: buoyancy {:.3f} N here, {:.3f} N far ({:.3f} N displaced), trembles by {:.3f} N; "
        "drag at 50 mm/s {:.3f} and {:.3f} N; at most {:.2f} and {:.2f} N; least energy {:.3f} mJ",
        1e3 * delay_s, held.local.y, held.far.y, expected_N, held.trembles_N, localDrag_N, drag_N, both.mostHere_N(),
        both.most_N(), 1e3 * both.min_J()));
    CHECK(std::abs(held.far.y - held.local.y) < 0.15 * expected_N);
    CHECK(std::hypot(held.far.x, held.far.z) < 0.1 * expected_N);
    // With a long delay it comes to rest later: the remote ball is still moving.
    CHECK(held.trembles_N < (delay_s < 0.1 ? 0.2 : 1) * expected_N);
    CHECK(both.most_N() < 1.5 * both.mostHere_N());
    CHECK(drag_N > 0.6 * localDrag_N);
    CHECK(drag_N < 1.5 * localDrag_N);
    CHECK(both.min_J() >= -1e-3);
    CHECK(both.far().there().state() == MatterState::running);
    CHECK(both.far().here().counts().restarts == 0);
  }
}

TEST_CASE("remote sand holds a ball like local sand" * kFull) {
  const MatterScene scene = smallTank(Matter::sand);
  for (const double delay_s : {0.0, 0.05, 0.5}) {
    Both both(scene, delay_s);
    both.meet({0.06, 0.15, 0.06}, delay_s);
    const Both::Felt into = both.go(700, {0, -0.1, 0}, 500);
    const Both::Felt held = both.go(600, DVec3(0), 300);
    const Both::Felt along = both.go(300, {0.05, 0, 0}, 100);
    MESSAGE(
        fmt::format("{:.0f} ms each way: into sand at 100 mm/s {:.2f} N here, {:.2f} N far; held {:.2f} and {:.2f} N; "
                    "along at 50 mm/s {:.2f} and {:.2f} N; trembles by {:.2f} N; at most {:.2f} and {:.2f} N; least "
                    "energy {:.3f} mJ",
                    1e3 * delay_s, into.local.y, into.far.y, held.local.y, held.far.y, along.local.x, along.far.x,
                    held.trembles_N, both.mostHere_N(), both.most_N(), 1e3 * both.min_J()));
    // With a delay of a second it is pushed against sand that is not yet known to have yielded.
    const double less = delay_s < 0.1 ? 0.8 : 0.6, more = delay_s < 0.1 ? 1.2 : 1.75;
    const auto isAlike = [&](double far_N, double local_N) { return far_N / local_N > less && far_N / local_N < more; };
    CHECK(isAlike(into.far.y, into.local.y));
    CHECK(isAlike(held.far.y, held.local.y));
    CHECK(isAlike(along.far.x, along.local.x));
    CHECK(held.trembles_N < 0.05 * held.local.y);
    CHECK(both.min_J() >= -1e-3);
    CHECK(both.far().there().state() == MatterState::running);
    CHECK(both.far().here().counts().restarts == 0);
  }
}

TEST_CASE("remote sand supports a ball like local sand at a wall, at the bottom and half out of it" * kFull) {
  const MatterScene scene = smallTank(Matter::sand);
  const double delay_s = 0.05;
  struct Place {
    const char* name;
    DVec3 above_m;
    int steps;  // of the descent at 100 mm/s
  };
  for (const Place& place :
       {Place{"at a wall", {0.03, 0.15, 0.06}, 700}, Place{"in a corner", {0.03, 0.15, 0.03}, 600},
        Place{"at the bottom", {0.06, 0.15, 0.06}, 1050}, Place{"half out", {0.06, 0.15, 0.06}, 450}}) {
    Both both(scene, delay_s);
    both.meet(place.above_m, delay_s);
    const Both::Felt into = both.go(place.steps, {0, -0.1, 0}, place.steps - 150);
    const Both::Felt held = both.go(400, DVec3(0), 250);
    const Both::Felt out = both.go(500, {0, 0.1, 0}, 350);
    MESSAGE(fmt::format(
        "{}: into sand {:.2f} N here, {:.2f} N far; held {:.2f} and {:.2f} N; out again {:.2f} and {:.2f} N; "
        "at most {:.2f} and {:.2f} N; least energy {:.3f} mJ",
        place.name, into.local.y, into.far.y, held.local.y, held.far.y, out.local.y, out.far.y, both.mostHere_N(),
        both.most_N(), 1e3 * both.min_J()));
    CHECK(into.far.y > 0.7 * into.local.y);
    // In front of a moving ball the yielding is known late.
    CHECK(into.far.y < 1.7 * into.local.y);
    CHECK(held.far.y > 0.6 * held.local.y);
    CHECK(held.far.y < 1.4 * held.local.y);
    CHECK(both.most_N() < 1.5 * both.mostHere_N());
    CHECK(both.min_J() >= -1e-3);
    CHECK(both.far().there().state() == MatterState::running);
  }
}

TEST_CASE("hands gain no energy from remote matter, at any motion and latency" * kFull) {
  std::mt19937 random(11);
  std::normal_distribution<double> push;
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const double delay_s : {0.05, 0.5}) {
      FarMatter far(smallTank(matter), delay_s);
      HandPose hand{.place_m = {0.06, 0.15, 0.06}};
      DVec3 speed(0);
      double min_J = 0, most_N = 0;
      for (int k = 0; k < 900; ++k) {
        speed = 0.98 * speed - DVec3(0, 8e-3, 0);
        for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.05 * push(random);
        hand.place_m = glm::clamp(hand.place_m + kMatterStep_s * speed, DVec3(0.03), DVec3(0.09, 0.15, 0.09));
        far.step(hand);
        min_J = std::min(min_J, far.here().portEnergy_J(0));
        most_N = std::max(most_N, glm::length(far.felt().force_N));
      }
      MESSAGE(fmt::format("random hands in {}, {:.0f} ms each way: least energy {:.3f} mJ, at most {:.1f} N",
                          matter == Matter::water ? "water" : "sand", 1e3 * delay_s, 1e3 * min_J, most_N));
      CHECK(most_N > 0.5);
      CHECK(min_J >= -1e-3);
      CHECK(far.here().state() == MatterState::running);
    }
}

TEST_CASE("a hand that joins with its ball under water feels buoyancy and is not carried up") {
  Both both(smallTank(), 0.05, false);
  both.hand().place_m = {0.06, 0.05, 0.06};
  const Both::Felt held = both.go(600, DVec3(0), 350);
  CHECK(held.far.y > 0.7 * buoyancy_N(smallTank()));
  double work_J = 0;
  for (int k = 0; k < 600; ++k) {
    both.go(1, {0, 0.1, 0}, 0);
    work_J += both.far().felt().force_N.y * 0.1 * kMatterStep_s;
  }
  CHECK(work_J < 1e-3);
  CHECK(both.min_J() >= -1e-3);
}

TEST_CASE("water that flows remotely carries along a ball that is held still here") {
  MatterScene scene = tank({20, 20, 20}, 11);  // so wide that the local part reaches no wall
  scene.tool = {.radius_mm = 25, .mass_kg = 0.065};
  const float speed_m_s = 0.1f;
  const int rests = 300, flows = 250;
  std::vector<Vec3> beginning = placesAtRest(scene);
  for (const Vec3& place : placesAtRest(scene))
    beginning.push_back(place - Vec3(static_cast<float>(scene.box_mm.x * 1e-3), 0, 0));
  int step = 0;
  MatterPond pond(scene, {.threads = 1, .tools = 1}, [&](KnownMatter& known) {
    if (step % 16 != 0) return false;
    const float gone_m = speed_m_s * 1e-3f * static_cast<float>(std::max(0, step - rests));
    known = {};
    for (const Vec3& place : beginning) {
      known.ids.push_back(static_cast<std::uint32_t>(known.size()));
      known.positions.push_back(place + Vec3(gone_m, 0, 0));
      known.velocities.emplace_back(0);
    }
    return true;
  });
  const HandPose hand{.place_m = {0.1, 0.055, 0.1}};
  double before_N = 0, along_N = 0;
  for (; step < rests + flows; ++step) {
    pond.step({&hand, 1});
    if (step >= rests - 100 && step < rests) before_N += pond.answers()[0].force_N.x / 100;
    if (step >= rests + flows - 100) along_N += pond.answers()[0].force_N.x / 100;
  }
  MESSAGE("in water that flows by at 100 mm/s: " << along_N << " N, at rest " << before_N << " N");
  CHECK(std::abs(before_N) < 0.05);
  CHECK(along_N > 0.1);
  CHECK(pond.counts().restarts == 0);
}

TEST_CASE("a restart of remote matter restarts the local part, and without news the local part stays as it is" *
          kMoreInFull) {
  Both both(smallTank(), 0.02, false);
  both.hand().place_m = {0.06, 0.06, 0.06};
  both.go(500, DVec3(0), 0);
  const double before_N = both.most_N();
  both.far().hold(true);
  const Both::Felt silent = both.go(byTier(600, 1500), DVec3(0), byTier(300, 500));
  CHECK(silent.far.y > 0.7 * buoyancy_N(smallTank()));
  CHECK(silent.trembles_N < 0.3 * buoyancy_N(smallTank()));
  both.far().hold(false);
  both.far().collapse();
  both.go(10, DVec3(0), 0);
  const Both::Felt after = both.go(byTier(400, 1500), DVec3(0), byTier(200, 1000));
  CHECK(both.far().here().counts().restarts >= 1);
  CHECK(std::isfinite(after.far.y));
  CHECK(both.most_N() < 3 * before_N + 3);
  CHECK(both.min_J() >= -1e-3);
}

TEST_CASE("invalid news of remote matter gives a bounded, finite force, which recovers with valid news") {
  const MatterScene scene = smallTank();
  std::mt19937 random(5);
  const std::vector<Vec3> rest = placesAtRest(scene);
  std::uniform_real_distribution<float> anywhere(-0.5f, 0.7f);
  const auto somewhere = [&] {
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) place[axis] = anywhere(random);
    return place;
  };
  int times = 0;
  bool lies = true;
  MatterPond pond(scene, {.threads = 1, .tools = 1}, [&](KnownMatter& known) {
    if (++times % 16 != 1) return false;
    known = {.positions = rest, .velocities = std::vector<Vec3>(rest.size(), Vec3(0)), .time_s = 1e-3 * times};
    if (lies)
      for (std::size_t i = 0; i < rest.size(); ++i) {
        switch (times / 16 % 4) {
          case 0:
            known.positions[i] = somewhere();
            break;
          case 1:
            known.positions[i] = Vec3(0.06f, 0.03f, 0.02f);  // all at the same position
            break;
          case 2:
            known.positions[i] += 0.4f * somewhere();
            break;
          default:
            known.velocities[i] = Vec3(1e30f, -1e30f, 3e38f);
        }
      }
    for (std::uint32_t i = 0; i < rest.size(); ++i) known.ids.push_back(i);
    return true;
  });
  const HandPose hand{.place_m = {0.06, 0.05, 0.06}};
  double most_N = 0;
  for (int k = 0; k < 800; ++k) {
    pond.step({&hand, 1});
    REQUIRE(pond.state() == MatterState::running);
    REQUIRE(isFinite(pond.answers()[0].force_N));
    most_N = std::max(most_N, glm::length(pond.answers()[0].force_N));
    REQUIRE(pond.members() < 2 * rest.size());
  }
  MESSAGE("the largest force of lies: " << most_N << " N, " << pond.counts().restarts << " times begun anew");
  CHECK(pond.counts().restarts > 5);
  lies = false;
  DVec3 mean(0);
  for (int k = 0; k < 600; ++k) {
    pond.step({&hand, 1});
    if (k >= 300) mean += pond.answers()[0].force_N / 300.0;
  }
  CHECK(mean.y > 0.5 * buoyancy_N(scene));
  CHECK(mean.y < 1.5 * buoyancy_N(scene));
}

TEST_CASE("late news of moving sand, received together with the next, causes no force step") {
  const MatterScene scene = smallTank(Matter::sand);
  const std::vector<Vec3> rest = placesAtRest(scene);
  constexpr int kApart = 16;
  // The bed oscillates at up to 100 mm/s. News is due every 16 steps; if held up, every fourth one is 15 steps late, so
  // that two are received in two steps.
  const auto mostChange_N = [&](bool isHeldUp) {
    int times = 0;
    MatterPond pond(scene, {.threads = 1, .tools = 1}, [&](KnownMatter& known) {
      const int news = times / kApart, step = times++ % kApart;
      const bool isNow = step == (isHeldUp && news % 4 == 1 ? kApart - 1 : 0);
      if (!isNow) return false;
      const double time_s = 1e-3 * kApart * news;
      const Vec3 way(static_cast<float>(0.002 * std::sin(50 * time_s)), 0, 0);
      known = {.positions = rest, .velocities = std::vector<Vec3>(rest.size(), Vec3(0)), .time_s = time_s};
      for (std::uint32_t i = 0; i < rest.size(); ++i) {
        known.positions[i] += way;
        known.ids.push_back(i);
      }
      return true;
    });
    const HandPose hand{.place_m = {0.06, 0.05, 0.06}};
    double most = 0;
    DVec3 last(0);
    for (int k = 0; k < 1200; ++k) {
      pond.step({&hand, 1});
      REQUIRE(pond.state() == MatterState::running);
      const DVec3 force_N = pond.answers()[0].force_N;
      if (k > 400) most = std::max(most, glm::distance(force_N, last));
      last = force_N;
    }
    CHECK(pond.counts().restarts == 0);
    return most;
  };
  const double even_N = mostChange_N(false), heldUp_N = mostChange_N(true);
  MESSAGE("the largest change of force in a step, of a bed that goes to and fro: "
          << even_N << " N, and where news is held up " << heldUp_N << " N");
  CHECK(heldUp_N < 1.5 * even_N + 0.1);
}

TEST_CASE("local particles stay out of balls and occupied positions, and those moved locally keep their positions") {
  const MatterScene scene = smallTank();
  const MatterPlan plan = planOf(scene);
  const PondSpace space{
      .reach = pondReach(scene, plan), .spacing_m = 0.01f, .fastest_m_s = 10, .box_m = scene.box_mm * 1e-3};
  const PondMembers rules(space);
  KnownMatter known{.positions = placesAtRest(scene), .velocities = {}};
  known.velocities.resize(known.positions.size());
  for (std::uint32_t i = 0; i < known.positions.size(); ++i) known.ids.push_back(i);
  const std::vector<DVec3> balls{{0.06, 0.06, 0.06}};
  const std::vector<std::uint8_t> rests{1};
  std::vector<PondMember> members;
  REQUIRE(rules.renew(known, balls, rests, members));
  std::size_t expected = 0;
  for (const Vec3& place : known.positions) {
    const double distance = glm::distance(DVec3(place), balls[0]);
    expected += distance >= space.reach.within && distance < space.reach.end;
  }
  CHECK(members.size() == expected);
  REQUIRE(members.size() > 200);
  // A member beside the ball moves half a spacing; another particle is then known at its old position.
  const auto own = std::ranges::find_if(
      members, [&](const PondMember& member) { return PondMembers::distance(member.place, balls) < space.reach.free; });
  REQUIRE(own != members.end());
  const std::uint32_t id = own->id;
  const Vec3 place = own->place + Vec3(0.002f);
  own->place = place;
  known.positions[known.size() - 1] = known.positions[id];  // from far above
  REQUIRE(rules.renew(known, balls, rests, members));
  CHECK(members.size() == expected);
  CHECK(std::ranges::find(members, id, &PondMember::id)->place == place);
  CHECK(std::ranges::is_sorted(members, {}, &PondMember::id));
  CHECK(rules.held(static_cast<float>(space.reach.free)) == 0);
  CHECK(rules.held(static_cast<float>(space.reach.held)) == 1);
  // More particles at one position than there can be.
  for (Vec3& position : known.positions) position = Vec3(0.06f, 0.02f, 0.02f);
  KnownMatter crowd = known;
  for (int k = 0; k < 4; ++k)
    for (const Vec3& position : known.positions) {
      crowd.ids.push_back(static_cast<std::uint32_t>(crowd.size()));
      crowd.positions.push_back(position);
      crowd.velocities.emplace_back(0);
    }
  CHECK_FALSE(rules.renew(crowd, balls, rests, members));
}

}  // namespace palpate::pond_test
