// ctest: waits
// Mutated samples of each of palpate's types and of ROS's clouds: lengths, counts, numbers, bits. DDS refuses
// impossible ones; the others are delivered to a served and to a joined session as if they had been sent.
#include <dds/ddsi/ddsi_serdata.h>
#include <doctest/doctest.h>

#include <cstring>
#include <random>

#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/presence.hpp"
#include "haptics/sharing/ros_intake.hpp"
#include "tests/labels.hpp"
#include "tests/sharing/honest_hand.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate::mutated_samples_test {

using namespace sharing;

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Makes one to four changes to a sample, fewer among its first bytes, so that it is still addressed to somebody.
void mutate(Bytes& bytes, std::mt19937& dice) {
  constexpr std::array<std::uint32_t, 12> kEdges{0,  1,    2,          36,         37,         64,
                                                 65, 4096, 0x7fc00000, 0x7f800000, 0xffffffff, 0x80000000};
  constexpr std::size_t kHead = 20;  // encapsulation and session
  for (std::size_t left = 1 + dice() % 4; left > 0 && !bytes.empty(); --left) {
    const std::size_t from = bytes.size() > kHead && dice() % 16 ? kHead : 0,
                      at = from + dice() % (bytes.size() - from);
    switch (dice() % 6) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1U << dice() % 8);
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(dice());
        break;
      case 2:
      case 3: {
        const std::uint32_t edge = kEdges[dice() % kEdges.size()];
        const std::size_t begin = at / 4 * 4;
        std::memcpy(bytes.data() + begin, &edge, std::min(sizeof edge, bytes.size() - begin));
        break;
      }
      case 4:
        bytes.resize(dice() % 4 ? bytes.size() - std::min<std::size_t>(bytes.size(), dice() % 8) : at);
        break;
      default:
        bytes.insert(bytes.end(), dice() % 64, static_cast<std::uint8_t>(dice()));
    }
  }
}

struct Tried {
  int accepted = 0, refused = 0;
};

/// Samples of one type in wire format.
template <class T>
class Wire {
 public:
  /// Reads DDS's type description from any sample of it, on a private topic.
  Wire(dds_entity_t participant, const dds_topic_descriptor_t& type, const T& any)
      : topic_(participant, type, "nobody/" + lastPart(type.m_typename)) {
    const Reader<T> reader(participant, topic_, reliableQos(false));
    const Writer<T> writer(participant, topic_, reliableQos(false));
    REQUIRE(writer.write(any));
    ddsi_serdata* one = nullptr;
    dds_sample_info_t about;
    REQUIRE(dds_takecdr(reader, &one, 1, &about, DDS_ANY_STATE) == 1);
    type_ = one->type;  // owned by the topic
    ddsi_serdata_unref(one);
  }

  Bytes bytesOf(const T& sample) const {
    ddsi_serdata* const made = ddsi_serdata_from_sample(type_, SDK_DATA, &sample);
    REQUIRE(made != nullptr);
    Bytes bytes(ddsi_serdata_size(made));
    ddsi_serdata_to_ser(made, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(made);
    return bytes;
  }
  /// DDS's interpretation of received bytes; null if DDS refuses them.
  ddsi_serdata* read(Bytes& bytes) const {
    const ddsrt_iovec_t whole{.iov_base = bytes.data(), .iov_len = bytes.size()};
    return bytes.size() < 4 ? nullptr : ddsi_serdata_from_ser_iov(type_, SDK_DATA, 1, &whole, bytes.size());
  }
  /// Writes a mutated copy of a sample.
  void write(const Writer<T>& writer, const T& sample, std::mt19937& dice, Tried& tried) const {
    Bytes bytes = bytesOf(sample);
    mutate(bytes, dice);
    ddsi_serdata* const made = read(bytes);
    if (!made) {
      ++tried.refused;
      return;
    }
    ++tried.accepted;
    dds_writecdr(writer, made);  // takes ownership
  }

 private:
  static std::string lastPart(const std::string& name) { return name.substr(name.rfind(':') + 1); }

  Topic<T> topic_;
  const ddsi_sertype* type_ = nullptr;
};

/// A participant that writes mutated samples to a session.
class Mutant {
 public:
  explicit Mutant(unsigned seed) : participant_(ownNetwork()), topics_(participant_), dice_(seed) {
    const Reader<Notice> notices(participant_, topics_.notices, reliableQos(true));
    while (!known_) notices.take([&](const Notice& notice) { known_ = notice; });
  }

  template <class T, class Fill>
  void write(const dds_topic_descriptor_t& type, const Topic<T>& topic, const Qos& qos, int count, Fill&& fill) {
    CAPTURE(type.m_typename);
    const Wire wire(participant_, type, T{});
    const Writer<T> writer(participant_, topic, qos);
    Tried tried;
    for (int i = 0; i < count; ++i) {
      T sample{};
      std::memcpy(sample.session, known_->session, sizeof sample.session);
      fill(sample);
      wire.write(writer, sample, dice_, tried);
    }
    CHECK(tried.accepted > count / 20);
    CHECK(tried.refused > count / 20);
  }

  std::uint32_t roll() { return static_cast<std::uint32_t>(dice_()); }
  /// One of forty clients.
  void setClient(std::uint8_t (&client)[16]) { client[0] = static_cast<std::uint8_t>(1 + roll() % 40); }
  /// States of some of so many points.
  template <class Sequence>
  void giveStates(Sequence& to, std::uint32_t points) {
    states_.resize(1 + roll() % kStates);
    for (State& state : states_)
      state = {.id = roll() % points, .position = {1, 2, 3}, .normal = {0, 0, 1}, .color = 0};
    give(to, states_);
  }
  const Topics& topics() const { return topics_; }
  dds_entity_t participant() const { return participant_; }
  const Notice& notice() const { return *known_; }

 private:
  Participant participant_;
  Topics topics_;
  std::mt19937 dice_;
  std::optional<Notice> known_;
  std::vector<State> states_;
};

}  // namespace

TEST_CASE("a served and sculpted session continues amid corrupted samples") {
  const PointCloud cloud = flatCloud(5000);
  Served served(cloud, "mutated");
  HonestHand hand("mutated");
  const JoinedCloud one = joinCloud("mutated", {.network = ownNetwork()}),
                    another = joinCloud("mutated", {.network = ownNetwork()});
  const auto onlooker = sharePresence(one.session, "onlooker", one.cloud),
             honest = sharePresence(another.session, "honest", another.cloud);
  std::this_thread::sleep_for(std::chrono::milliseconds(400));  // it sculpts
  Mutant mutant(1);
  const Topics& topics = mutant.topics();
  constexpr int kTimes = 4000;
  for (const bool edits : {false, true})
    mutant.write(palpate_sharing_Want_desc, topics.wants, bestEffortQos(), kTimes, [&](Want& want) {
      mutant.setClient(want.client);
      put(want.host, "mutant");
      want.number = mutant.roll();
      want.epoch = mutant.roll() % 100;
      want.every = 1 + mutant.roll() % 2;
      want.first = mutant.roll() % 100;
      want.edits = edits;
      want.upTo = mutant.roll() % 1000;
    });
  mutant.write(palpate_sharing_Stroke_desc, topics.strokes, reliableQos(false), kTimes, [&](Stroke& stroke) {
    mutant.setClient(stroke.client);
    stroke.number = mutant.roll() % 50;  // in any order, with duplicates
    mutant.giveStates(stroke.states, 5000);
  });
  mutant.write(palpate_sharing_Hand_desc, topics.hands, bestEffortQos(), kTimes, [&](sharing::HandSample& shown) {
    mutant.setClient(shown.client);
    put(shown.name, "mutant");
    shown.which = static_cast<std::uint8_t>(mutant.roll());
    shown.number = mutant.roll();
  });
  std::size_t cameras = 0;
  mutant.write(palpate_sharing_Camera_desc, topics.cameras, bestEffortQos(), kTimes, [&](Camera& camera) {
    mutant.setClient(camera.client);
    put(camera.name, "mutant");
    camera.orientation[0] = camera.fov_y = camera.aspect = 1;
    camera.number = mutant.roll();
    if (mutant.roll() % 64) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(8));  // time to receive some
    const std::vector<SeenCamera> others = onlooker->cameras();
    cameras += others.size();
    for (const SeenCamera& other : others) {
      CHECK(isCamera(other.place));
      CHECK(glm::length(other.place.position) < 1e12);  // every camera can be drawn
    }
  });
  CHECK(cameras > 0);
  for (const char* partition : {"", kEchoes})
    mutant.write(palpate_sharing_Ping_desc, topics.pings, bestEffortQos(partition), kTimes,
                 [&](Ping& ping) { mutant.setClient(ping.client); });
  mutant.write(palpate_sharing_Notice_desc, topics.notices, reliableQos(true), kTimes, [&](Notice& notice) {
    notice = mutant.notice();
    notice.session[5] ^= static_cast<std::uint8_t>(1 + mutant.roll() % 200);
  });
  std::optional<Id> victim;
  const Reader<sharing::HandSample> hands(mutant.participant(), topics.hands, bestEffortQos());
  while (!victim)
    hands.take([&](const sharing::HandSample& shown) {
      if (std::string(shown.name) == "honest") victim = idOf(shown.client);
    });
  mutant.write(palpate_sharing_PointsSample_desc, topics.points, reliableQos(false, partitionOf(*victim)), kTimes,
               [&](Points& result) {
                 result.epoch = 1;
                 result.head = mutant.roll();
                 mutant.giveStates(result.states, 5000);
               });
  honest->show(CameraPlace{.position = DVec3(1, 2, 3), .fovY_rad = 1});
  CHECK(within(10, [&] {
    return std::ranges::any_of(onlooker->cameras(), [](const SeenCamera& other) { return other.name == "honest"; });
  }));
  const SharedCounts counts = hand.end();
  CHECK(counts.same);
  CHECK(counts.delivered);
  CHECK(counts.sent > 50);
  CHECK(joinCloud("mutated", {.network = ownNetwork()}).cloud.positions == cloud.positions);
  const ServedCounts handed = served.end();
  CHECK(handed.refused > 100);
  CHECK(handed.sculptors > 10);
}

TEST_CASE("a client that joins amid corrupted blocks receives the announced points or a reason" * kMoreInFull) {
  constexpr std::uint32_t kPoints = 150'000;
  const PointCloud cloud = flatCloud(kPoints);
  Served served(cloud, "mutated");
  Mutant mutant(2);
  const Reader<Want> wants(mutant.participant(), mutant.topics().wants, bestEffortQos());
  int whole = 0, told = 0, other = 0;
  std::jthread joining([&](const std::stop_token& end) {
    while (!end.stop_requested()) try {
        const PointCloud got = joinCloud("mutated", {.network = ownNetwork(), .timeout_s = 2}).cloud;
        ++(got.positions == cloud.positions ? whole : other);
      } catch (const NetworkError& error) {
        CAPTURE(std::string(error.what()));
        CHECK(std::string(error.what()).find("'mutated'") != std::string::npos);
        ++told;
      }
  });
  std::vector<Point> points;
  for (const Stopwatch since; since.elapsed_s() < byTier(2.0, 4.0);) {
    std::optional<Want> asked;
    wants.take([&](const Want& want) { asked = want; });
    if (!asked) continue;
    mutant.write(palpate_sharing_PointsSample_desc, mutant.topics().points,
                 reliableQos(false, partitionOf(idOf(asked->client))), 400, [&](Points& block) {
                   block.epoch = asked->epoch;
                   block.sample = asked->taken + 1 + mutant.roll() % 100;
                   points.assign(kBlockPoints, Point{.position = {1, 2, 3}, .normal = {0, 0, 1}, .color = 0});
                   give(block.points, points);
                 });
  }
  joining.request_stop();
  joining.join();
  CHECK(other == 0);
  CHECK(whole + told > 0);
  MESSAGE(whole, " joined with the announced points, ", told, " refused with a reason");  // the proportion is random
}

TEST_CASE("a client with only nearby points continues amid corrupted requests, facts and bricks") {
  const PointCloud cloud = flatCloud(20'000);
  Served served(cloud, "mutated");
  const JoinedCloud joined = joinNear("mutated");
  REQUIRE(comesTo({50, 20, 0}, joined.far->source()));
  Mutant mutant(4);
  const Topics& topics = mutant.topics();
  constexpr int kTimes = 2000;
  std::vector<palpate_sharing_Ball> balls(8);
  mutant.write(palpate_sharing_Want_desc, topics.wants, bestEffortQos(), kTimes, [&](Want& near) {
    near.client[0] = static_cast<std::uint8_t>(1 + mutant.roll() % 40);
    put(near.host, "mutant");
    near.number = mutant.roll();
    near.epoch = mutant.roll() % 100;
    near.taken = mutant.roll();
    for (palpate_sharing_Ball& ball : balls) ball = {.center = {1.0 * (mutant.roll() % 200), 0, 0}, .radius = 20};
    give(near.balls, balls);
  });
  mutant.write(palpate_sharing_Facts_desc, topics.facts, reliableQos(true), kTimes, [&](Facts& facts) {
    facts.session[5] ^= static_cast<std::uint8_t>(mutant.roll() % 200);
    facts.points = 20'000;
    facts.spacing = facts.edge = 1;
  });
  const Reader<Want> wants(mutant.participant(), topics.wants, bestEffortQos());
  std::array part{BrickPart{.key = BrickGrid::keyOf(IVec3(0)), .total = 1, .count = 1, .checksum = 0}};
  std::array id{std::uint32_t{0}};
  std::array point{Point{.position = {1, 2, 0}, .normal = {0, 0, 1}, .color = 0}};
  int rounds = 0;
  for (const Stopwatch since; since.elapsed_s() < 1.5 || (rounds == 0 && since.elapsed_s() < 30);) {
    std::optional<Want> asked;
    wants.take([&](const Want& want) {
      if (std::string(want.host) != "mutant") asked = want;
    });
    if (!asked) continue;
    ++rounds;
    mutant.write(palpate_sharing_PointsSample_desc, topics.points, reliableQos(false, partitionOf(idOf(asked->client))),
                 200, [&](Points& bricks) {
                   bricks.epoch = asked->epoch + mutant.roll() % 2;
                   bricks.sample = asked->taken + 1;
                   give(bricks.parts, part);
                   give(bricks.ids, id);
                   give(bricks.points, point);
                 });
  }
  CHECK(rounds > 0);
  CHECK(comesTo({50, 180, 0}, joined.far->source()));
  CHECK_NOTHROW(joined.far->check());
  CHECK(joined.far->counts().resumed > 0);
  CHECK(served.end().refused > 20);
}

TEST_CASE("corrupted ROS point clouds are read or refused with a reason") {
  const Participant participant = rosParticipant(ownNetwork());
  RosPointCloud2 nothing{};
  char none[] = "";
  nothing.header.frame_id = none;
  const Wire wire(participant, rosTypeOf<RosPointCloud2>().descriptor, nothing);
  std::mt19937 dice(3);
  Tried tried;
  int taken = 0, told = 0;
  for (int i = 0; i < 20'000; ++i) {
    char x[] = "x", y[] = "y", z[] = "z", frame[] = "map";
    std::array<RosPointField, 3> fields{{{x, 0, 7, 1}, {y, 4, 7, 1}, {z, 8, 7, 1}}};
    Bytes data(12 * (dice() % 5), 0x3f);
    RosPointCloud2 cloud{};
    cloud.header.frame_id = frame;
    cloud.height = 1;
    cloud.width = static_cast<std::uint32_t>(data.size() / 12);
    give(cloud.fields, fields);
    cloud.point_step = 12;
    cloud.row_step = static_cast<std::uint32_t>(data.size());
    give(cloud.data, data);
    Bytes bytes = wire.bytesOf(cloud);
    mutate(bytes, dice);
    ddsi_serdata* const made = wire.read(bytes);
    if (!made) {
      ++tried.refused;
      continue;
    }
    ++tried.accepted;
    RosPointCloud2 read{};
    if (ddsi_serdata_to_sample(made, &read, nullptr, nullptr)) try {
        const std::size_t points = takeMessage(read, nullptr).cloud.size();
        CHECK(points <= bytes.size());
        ++taken;
      } catch (const NetworkError&) {
        ++told;
      }
    dds_sample_free(&read, &rosTypeOf<RosPointCloud2>().descriptor, DDS_FREE_CONTENTS);
    ddsi_serdata_unref(made);
  }
  CHECK(tried.accepted > 1000);
  CHECK(tried.refused > 1000);
  CHECK(taken > 500);
  CHECK(told > 500);
}

}  // namespace palpate::mutated_samples_test
