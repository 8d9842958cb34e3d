// ctest: waits
// The participants of a session, with hands and cameras, over a network of this machine.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/presence.hpp"
#include "tests/labels.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate::presence_test {

using namespace sharing;

namespace {

PointCloud threePoints() {
  PointCloud cloud;
  cloud.origin = DVec3(450'000, -300'000, 1000);
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  cloud.normals.assign(3, Vec3(0, 0, 1));
  return cloud;
}

CameraPlace cameraAt(double x) {
  return {.position = DVec3(450'000 + x, -300'000.25, 1007),
          .turn = DQuat(0.5, -0.5, 0.5, -0.5),
          .fovY_rad = 0.75,
          .aspect = 1.5};
}

HandPlace handAt(double x) {
  const DVec3 place(450'000 + x, -300'000, 1000);
  return {.position = place, .proxy = place + DVec3(0, 0, 0.25), .touching = true};
}

/// A client that has joined and watches the others.
struct Looking {
  Looking(const std::string& session, const std::string& name, bool near = false)
      : joined(joinCloud(session, {.network = ownNetwork(), .partial = near})),
        presence(sharePresence(joined.session, name, joined.cloud)) {}
  bool sees(double x, double seconds = 10) const {
    return within(seconds, [&] {
      return std::ranges::any_of(presence->cameras(), [&](const SeenCamera& other) {
        return glm::distance(other.place.position, cameraAt(x).position) < 1e-9;
      });
    });
  }
  void movesHands(const std::vector<HandPlace>& hands) const {
    HandPlaces places{.count = static_cast<std::uint32_t>(hands.size())};
    std::ranges::copy(hands, places.hands.begin());
    presence->moved(places);
  }
  /// Whether exactly one hand has that name, and is there.
  bool seesHand(const std::string& name, double x) const {
    std::vector<double> at;
    for (const SeenHand& hand : presence->hands())
      if (hand.name == name) at.push_back(hand.place.position.x - 450'000);
    return at.size() == 1 && std::abs(at[0] - x) < 1e-6;
  }
  JoinedCloud joined;
  std::shared_ptr<SharedPresence> presence;
};

}  // namespace

TEST_CASE("cameras of other clients are shown, follow their motion, stay while at rest, and disappear when hidden") {
  const PointCloud cloud = threePoints();
  Served served(cloud, "looked at");
  const Looking ada("looked at", "Ada"), bert("looked at", "Bert", true);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(ada.presence->cameras().empty());  // no camera was sent yet
  ada.presence->show(cameraAt(2));
  REQUIRE(bert.sees(2));
  const SeenCamera seen = bert.presence->cameras().at(0);
  CHECK(seen.name == "Ada");
  CHECK(seen.place.turn == cameraAt(2).turn);
  CHECK(seen.place.fovY_rad == 0.75);
  CHECK(seen.place.aspect == 1.5);
  CHECK(ada.presence->cameras().empty());  // a client does not see its own camera
  ada.presence->show(cameraAt(3));
  CHECK(bert.sees(3));
  bert.presence->show(cameraAt(-4));
  CHECK(ada.sees(-4));
  CHECK(ada.presence->cameras().at(0).number != seen.number);
  // Longer than a silent camera is kept.
  std::this_thread::sleep_for(std::chrono::milliseconds(3500));
  CHECK(within(30, [&] {
    const auto cameras = bert.presence->cameras();
    return cameras.size() == 1 && glm::distance(cameras[0].place.position, cameraAt(3).position) < 1e-9 &&
           cameras[0].age_s < 2;
  }));
  // A later client sees it, too.
  const Looking carla("looked at", "");
  CHECK(carla.sees(3));
  ada.presence->show(std::nullopt);
  CHECK(within(30, [&] { return bert.presence->cameras().empty(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  CHECK(bert.presence->cameras().empty());
  CHECK_THROWS_AS(ada.presence->show(CameraPlace{.fovY_rad = 4}), UsageError);
}

TEST_CASE("a camera that moves at 1 kHz is sent thirty times a second, and one at rest twice" * kClock) {
  const PointCloud cloud = threePoints();
  Served served(cloud, "shaken");
  const Looking ada("shaken", "Ada");
  const Participant participant(ownNetwork());
  const Topics own(participant);
  const Reader<Camera> heard(participant, own.cameras, keepingLast(bestEffortQos(), 1000));
  ada.presence->show(cameraAt(0));
  std::size_t samples = 0;
  REQUIRE(within(10, [&] { return (samples += heard.take([](const Camera&) {})) > 0; }));
  const auto heardIn = [&](double seconds, bool moves) {
    std::size_t count = 0;
    double x = 0;
    for (const Stopwatch since; since.elapsed_s() < seconds;) {
      if (moves) ada.presence->show(cameraAt(x += 0.01));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      count += heard.take([](const Camera&) {});
    }
    return count;
  };
  const std::size_t moving = heardIn(2, true);
  CHECK(moving <= 61);
  CHECK(moving > 10);
  heardIn(0.2, false);
  const std::size_t standing = heardIn(2.1, false);
  CHECK(standing <= 5);
  CHECK(standing >= 2);
}

TEST_CASE("invalid cameras and those of other sessions are not shown, and new ones only up to the limit") {
  const PointCloud cloud = threePoints();
  Served served(cloud, "looked at by strangers");
  const Looking ada("looked at by strangers", "Ada");
  const Participant participant(ownNetwork());
  const Topics topics(participant);
  const Writer<Camera> writer(participant, topics.cameras, bestEffortQos());
  std::uint32_t number = 0;
  const auto good = [&] {
    Camera camera{};
    set(camera.session, ada.joined.session->session);
    camera.client[0] = 1;
    put(camera.name, "a\033[31mb");
    for (int axis = 0; axis < 3; ++axis) camera.position[axis] = cameraAt(1).position[axis];
    camera.orientation[0] = 1;
    camera.fov_y = 1;
    camera.aspect = 1;
    camera.number = ++number;
    return camera;
  };
  const auto isSeen = [&](const std::function<void(Camera&)>& spoil, double seconds) {
    return within(seconds, [&] {
      Camera camera = good();
      spoil(camera);
      writer.write(camera);
      return !ada.presence->cameras().empty();
    });
  };
  const auto asIs = [](Camera&) {};
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kShort_s = 0.3;
  // The first camera received may have any number.
  REQUIRE(isSeen([](Camera& camera) { camera.number = 0; }, 10));
  CHECK(isCamera(ada.presence->cameras().at(0).place));
  REQUIRE(isSeen(asIs, 10));
  CHECK(ada.presence->cameras().at(0).name == "a?[31mb");
  REQUIRE(within(30, [&] { return ada.presence->cameras().empty(); }));
  const std::pair<const char*, std::function<void(Camera&)>> kSpoilt[] = {
      {"no position", [&](Camera& camera) { camera.position[1] = kNan; }},
      {"a position beyond all clouds", [](Camera& camera) { camera.position[2] = 1e300; }},
      {"farther than a cloud of this size is viewed from", [](Camera& camera) { camera.position[2] = 1e9; }},
      {"no orientation", [&](Camera& camera) { camera.orientation[0] = static_cast<float>(kNan); }},
      {"an orientation of length 0", [](Camera& camera) { camera.orientation[0] = 0; }},
      {"an angle of 0", [](Camera& camera) { camera.fov_y = 0; }},
      {"an angle beyond a half turn", [](Camera& camera) { camera.fov_y = 3.2F; }},
      {"a negative aspect", [](Camera& camera) { camera.aspect = -1; }},
      {"another session", [](Camera& camera) { camera.session[3] ^= 1; }},
      {"its own client", [&](Camera& camera) { set(camera.client, ada.joined.session->client); }}};
  for (const auto& [what, spoil] : kSpoilt) CHECK_FALSE_MESSAGE(isSeen(spoil, kShort_s), what);
  REQUIRE(isSeen(asIs, 30));
  // One after another, so that none is lost because of another; repeated, since silent ones are dropped.
  CHECK(within(30, [&] {
    for (std::uint32_t i = 0; i < 600; ++i) {
      Camera camera = good();
      camera.client[1] = static_cast<std::uint8_t>(i);
      camera.client[2] = static_cast<std::uint8_t>(i >> 8);
      writer.write(camera);
      if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return ada.presence->cameras().size() == 256;
  }));
  CHECK(ada.presence->cameras().size() <= 256);
}

TEST_CASE("all clients see all hands of the others, also with only nearby points and in read-only sessions") {
  const PointCloud cloud = threePoints();
  for (const bool sculptable : {true, false}) {
    CAPTURE(sculptable);
    Served served(cloud, "felt", sculptable);
    const Looking ada("felt", "Ada", true), bert("felt", "Bert"), carla("felt", "Carla", true);
    const auto allMove = [&] {
      ada.movesHands({handAt(1), handAt(2)});
      bert.movesHands({handAt(3)});
      carla.movesHands({handAt(4), handAt(5), handAt(6)});
    };
    const auto areSeen = [&] {
      allMove();
      return ada.seesHand("Bert", 3) && ada.seesHand("Carla", 4) && ada.seesHand("Carla, hand 2", 5) &&
             ada.seesHand("Carla, hand 3", 6) && bert.seesHand("Ada", 1) && bert.seesHand("Ada, hand 2", 2) &&
             carla.seesHand("Ada, hand 2", 2) && carla.seesHand("Bert", 3);
    };
    REQUIRE(within(10, areSeen));
    CHECK(ada.presence->hands().size() == 4);  // without its own
    CHECK(carla.presence->hands().size() == 3);
    const std::vector<SeenHand> seen = ada.presence->hands();
    std::set<std::uint32_t> numbers;
    for (const SeenHand& hand : seen) {
      numbers.insert(hand.number);
      CHECK(hand.place.touching);
      CHECK(hand.place.proxy == hand.place.position + DVec3(0, 0, 0.25));
      CHECK(hand.age_s < 2);
    }
    CHECK(numbers.size() == 4);
    // Hands without further messages disappear for all other clients.
    CHECK(within(30, [&] {
      ada.movesHands({handAt(1), handAt(2)});
      return ada.presence->hands().empty() && bert.presence->hands().size() == 2 && carla.presence->hands().size() == 2;
    }));
    // One hand less is shown as one less.
    CHECK(within(30, [&] {
      ada.movesHands({handAt(7)});
      return bert.presence->hands().size() == 1 && bert.seesHand("Ada", 7);
    }));
    served.end();
  }
}

TEST_CASE("hands are shown again by a restarted server of the same points, but not by one of other points") {
  const PointCloud cloud = threePoints();
  PointCloud others = cloud;
  others.positions[2] = {0, 2, 0};
  std::optional<Served> served(std::in_place, cloud, "restarted");
  const Looking ada("restarted", "Ada"), bert("restarted", "Bert");
  const auto seesBert = [](const Looking& looking, const Looking& moving, double x) {
    return [&, x] {
      moving.movesHands({handAt(x)});
      return looking.seesHand("Bert", x);
    };
  };
  REQUIRE(within(30, seesBert(ada, bert, 1)));
  served.emplace(others, "restarted");
  const Looking carla("restarted", "Carla");  // has the other points
  CHECK_FALSE(within(2, seesBert(carla, bert, 2)));
  CHECK(ada.seesHand("Bert", 2));
  served.emplace(cloud, "restarted");
  const Looking dora("restarted", "Dora");
  CHECK(within(30, seesBert(dora, bert, 3)));
}

TEST_CASE("invalid, distant and surplus hands are not shown, and new ones only up to the limit") {
  const PointCloud cloud = threePoints();
  Served served(cloud, "felt by strangers");
  const Looking ada("felt by strangers", "Ada", true), bert("felt by strangers", "Bert");
  const Participant participant(ownNetwork());
  const Topics topics(participant);
  std::optional<Writer<HandSample>> writer(std::in_place, participant, topics.hands, bestEffortQos());
  std::uint32_t number = 0;
  const auto good = [&] {
    HandSample hand{};
    set(hand.session, ada.joined.session->session);
    hand.client[0] = 1;
    put(hand.name, "a\033[31mb");
    for (int axis = 0; axis < 3; ++axis) hand.position[axis] = hand.proxy[axis] = handAt(1).position[axis];
    hand.number = ++number;
    return hand;
  };
  const auto isSeen = [&](const std::function<void(HandSample&)>& spoil, double seconds) {
    return within(seconds, [&] {
      HandSample hand = good();
      spoil(hand);
      writer->write(hand);
      return !ada.presence->hands().empty() || !bert.presence->hands().empty();
    });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kShort_s = 0.3;
  REQUIRE(isSeen([](HandSample&) {}, 10));
  REQUIRE(within(30, [&] {
    writer->write(good());
    return ada.presence->hands().size() == 1 && bert.presence->hands().size() == 1;
  }));
  CHECK(ada.presence->hands().at(0).name == "a?[31mb");
  REQUIRE(within(30, [&] { return ada.presence->hands().empty() && bert.presence->hands().empty(); }));
  const std::pair<const char*, std::function<void(HandSample&)>> kSpoilt[] = {
      {"no position", [&](HandSample& hand) { hand.position[1] = kNan; }},
      {"no proxy", [&](HandSample& hand) { hand.proxy[2] = kNan; }},
      {"a position beyond all clouds", [](HandSample& hand) { hand.position[0] = 1e300; }},
      {"a distant proxy", [](HandSample& hand) { hand.proxy[0] = 1e12; }},
      {"a hand too many", [](HandSample& hand) { hand.which = kMaxHands; }},
      {"another session", [](HandSample& hand) { hand.session[3] ^= 1; }}};
  for (const auto& [what, spoil] : kSpoilt) CHECK_FALSE_MESSAGE(isSeen(spoil, kShort_s), what);
  // A hand that repeats the same message is present once, and disappears when it ends.
  std::size_t most = 0;
  within(3, [&] {
    HandSample hand = good();
    hand.number = 0xffffffff;
    writer->write(hand);
    most = std::max(most, ada.presence->hands().size());
    return false;
  });
  CHECK(most == 1);
  CHECK(within(30, [&] { return ada.presence->hands().empty(); }));
  // One after another, so that none is lost because of another; repeated, since silent ones are dropped.
  CHECK(within(30, [&] {
    for (std::uint32_t i = 0; i < 4800; ++i) {
      HandSample hand = good();
      hand.client[1] = static_cast<std::uint8_t>(i / 8);
      hand.client[2] = static_cast<std::uint8_t>(i / 8 >> 8);
      hand.which = i % 8;
      writer->write(hand);
      if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      most = std::max(most, ada.presence->hands().size());
    }
    return most >= 256;
  }));
  CHECK(most == 256);
  // An honest client is seen again once the attacker is gone.
  writer.reset();
  CHECK(within(10, [&] {
    bert.movesHands({handAt(3)});
    return ada.seesHand("Bert", 3);
  }));
}

}  // namespace palpate::presence_test
