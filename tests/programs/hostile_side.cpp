// An attacker in the network of a session: sends, as fast as possible for a number of seconds, samples that no client
// and no server of palpate would send; the same for the same seed.
//   hostile_side DOMAIN ATTACK SECONDS SEED
#include <fmt/format.h>

#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/hostile.h"
#include "haptics/sharing/messages.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr std::size_t kManyIds = 10'000;

/// Samples of raw bytes under the name of another type, which that type's readers accept.
template <class Raw>
class RawWriter {
 public:
  RawWriter(dds_entity_t participant, const dds_topic_descriptor_t& raw, const dds_topic_descriptor_t& as,
            const std::string& topic, const Qos& qos)
      : type_(raw), topic_(participant, named(type_, as), topic), writer_(participant, topic_, qos) {}
  void write(const Raw& sample) const { writer_.write(sample); }

 private:
  static const dds_topic_descriptor_t& named(dds_topic_descriptor_t& type, const dds_topic_descriptor_t& as) {
    type.m_typename = as.m_typename;
    return type;
  }
  dds_topic_descriptor_t type_;
  Topic<Raw> topic_;
  Writer<Raw> writer_;
};

/// Raw bytes as samples of each of palpate's types, also with sizes that no valid sample has.
class AnyBytes {
 public:
  explicit AnyBytes(std::uint32_t domain) : domain_(domain) {}

  void write(std::mt19937& dice, const std::uint8_t (&session)[16]) {
    writeAs(palpate_hostile_Few_desc, few_, dice, session);
    writeAs(palpate_hostile_Some_desc, some_, dice, session);
    writeAs(palpate_hostile_Many_desc, many_, dice, session);
  }

 private:
  // A participant can have one type per topic.
  template <class Raw>
  void begin(const dds_topic_descriptor_t& raw, std::vector<RawWriter<Raw>>& writers) {
    const auto topic = [](const char* name) { return fmt::format("palpate/{}/{}", kVersion, name); };
    const auto add = [&](const dds_topic_descriptor_t& as, const std::string& name, const Qos& qos) {
      participants_.push_back(std::make_unique<Participant>(NetworkConfig{.domain = domain_}));
      writers.emplace_back(*participants_.back(), raw, as, name, qos);
    };
    add(palpate_sharing_Notice_desc, "palpate/notice", reliableQos(true));
    add(palpate_sharing_Want_desc, topic("want"), bestEffortQos());
    add(palpate_sharing_Stroke_desc, topic("stroke"), reliableQos(false));
    add(palpate_sharing_Hand_desc, topic("hand"), bestEffortQos());
    add(palpate_sharing_Facts_desc, topic("facts"), reliableQos(true));
    add(palpate_sharing_Ping_desc, topic("ping"), bestEffortQos());
    add(palpate_sharing_Ping_desc, topic("ping"), bestEffortQos(kEchoes));
  }

  template <class Raw>
  void writeAs(const dds_topic_descriptor_t& raw, std::vector<RawWriter<Raw>>& writers, std::mt19937& dice,
               const std::uint8_t (&session)[16]) {
    if (writers.empty()) begin(raw, writers);
    Raw sample;
    for (std::uint8_t& byte : sample.bytes) byte = static_cast<std::uint8_t>(dice() % 4 ? dice() : 0xff * (dice() % 2));
    if (dice() % 2) std::memcpy(sample.bytes, session, std::min(sizeof sample.bytes, sizeof session));
    writers[dice() % writers.size()].write(sample);
  }

  std::uint32_t domain_;
  std::vector<std::unique_ptr<Participant>> participants_;
  std::vector<RawWriter<palpate_hostile_Few>> few_;
  std::vector<RawWriter<palpate_hostile_Some>> some_;
  std::vector<RawWriter<palpate_hostile_Many>> many_;
};

struct Writers {
  Writers(dds_entity_t participant, const Topics& topics)
      : wants(participant, topics.wants, bestEffortQos()),
        strokes(participant, topics.strokes, reliableQos(false)),
        notices(participant, topics.notices, reliableQos(true)),
        hands(participant, topics.hands, bestEffortQos()),
        facts(participant, topics.facts, reliableQos(true)),
        pings(participant, topics.pings, bestEffortQos()),
        echoes(participant, topics.pings, bestEffortQos(kEchoes)) {}
  Writer<Want> wants;
  Writer<Stroke> strokes;
  Writer<Notice> notices;
  Writer<HandSample> hands;
  Writer<Facts> facts;
  Writer<Ping> pings, echoes;
};

class HostileSide {
 public:
  HostileSide(std::uint32_t domain, std::uint32_t seed)
      : participant_(NetworkConfig{.domain = domain}),
        topics_(participant_),
        dice_(seed),
        writers_(participant_, topics_),
        heardHands_(participant_, topics_.hands, bestEffortQos()),
        heardWants_(participant_, topics_.wants, bestEffortQos()),
        bytes_(domain) {}

  /// Finds the session that is served in this domain.
  bool findSession() {
    const Reader<Notice> notices(participant_, topics_.notices, reliableQos(true));
    bool isFound = false;
    for (const Stopwatch since; since.elapsed_s() < 10; std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
      notices.take([&](const Notice& notice) {
        isFound = true;
        set(session_, idOf(notice.session));
        points_ = static_cast<std::uint32_t>(notice.points);
      });
      dds_publication_matched_status_t status{};
      if (isFound && dds_get_publication_matched_status(writers_.wants, &status) == 0 && status.current_count > 0)
        return true;
    }
    return false;
  }

  /// Repeats the attack and returns the number of repetitions.
  std::uint64_t run(const std::string& attack, double seconds) {
    const std::map<std::string, std::function<void()>> attacks{
        {"requests", [&] { request(idNumber(roll() % kManyIds)); }},
        {"unread", [&] { unread(); }},
        {"resumes", [&] { resume(idNumber(roll() % kManyIds)); }},
        {"one-resumes", [&] { resume(idNumber(1)); }},
        {"strokes", [&] { stroke(idNumber(1), ++number_, true); }},
        {"sculptors", [&] { stroke(idNumber(++number_), 1, true); }},
        {"bad-strokes", [&] { stroke(idNumber(roll() % kManyIds), any64(), roll() % 2 == 0); }},
        {"results", [&] { result(); }},
        {"hands", [&] { hand(); }},
        {"one-near", [&] { near(idNumber(1)); }},
        {"nears", [&] { near(idNumber(roll() % kManyIds)); }},
        {"bricks", [&] { bricks(); }},
        {"facts", [&] { facts(); }},
        {"notices", [&] { notice(); }},
        {"pings", [&] { ping(); }},
        {"bytes", [&] { bytes_.write(dice_, session_); }},
    };
    const auto found = attacks.find(attack);
    if (found == attacks.end()) return 0;
    std::uint64_t said = 0;
    for (const Stopwatch since; since.elapsed_s() < seconds; ++said) found->second();
    return said;
  }

 private:
  static Id idNumber(std::uint64_t number) {
    Id id{0xba, 0xd0};
    std::memcpy(id.data() + 4, &number, sizeof number);
    return id;
  }
  std::uint32_t roll() { return static_cast<std::uint32_t>(dice_()); }
  std::uint64_t any64() {
    constexpr std::array<std::uint64_t, 6> kEdges{
        0, 1, ~std::uint64_t{0}, std::uint64_t{1} << 63, 0xffffffff, 1'000'000'000'000};
    return roll() % 2 ? kEdges[roll() % kEdges.size()] : (std::uint64_t{roll()} << 32) | roll();
  }
  float anyFloat() {
    constexpr std::array<float, 7> kEdges{0,
                                          -0.0F,
                                          1e38F,
                                          -1e38F,
                                          1e-42F,
                                          std::numeric_limits<float>::quiet_NaN(),
                                          std::numeric_limits<float>::infinity()};
    return kEdges[roll() % kEdges.size()];
  }

  Want wantOf(const Id& client, const std::string& host) {
    Want want{};
    set(want.session, idOf(session_));
    set(want.client, client);
    put(want.host, host);
    want.number = ++wants_;
    return want;
  }

  // All points, from any block on, again and again.
  void request(const Id& client) {
    Want want = wantOf(client, "a flood");
    want.epoch = 1 + wants_ / 16;
    want.every = roll() % 8 ? 1 : roll();
    want.first = roll() % 8 ? 0 : roll();
    writers_.wants.write(want);
  }

  // Readers of 64 clients that are present but read nothing, like clients on a suspended machine.
  void unread() {
    constexpr std::size_t kReaders = 64;
    if (unread_.size() < kReaders) {
      unread_.emplace_back(participant_, topics_.points, reliableQos(false, partitionOf(idNumber(unread_.size()))));
    }
    request(idNumber(roll() % unread_.size()));
  }

  // The edits of others, from any position of the order on.
  void resume(const Id& client) {
    Want want = wantOf(client, std::string(200, 'x'));
    want.epoch = ++epoch_;
    want.every = 1;
    want.first = static_cast<std::uint32_t>(blocksOf(points_)) + (roll() % 8 ? 0 : roll());
    want.edits = true;
    want.upTo = roll() % 2 ? 0 : any64();
    writers_.wants.write(want);
  }

  void stroke(const Id& client, std::uint64_t number, bool isGood) {
    std::vector<State> states(isGood ? kStates : roll() % (kStates + 1));
    for (State& state : states) {
      state = {.id = roll() % points_, .position = {1, 2, 3}, .normal = {0, 0, 1}, .color = roll()};
      if (isGood) continue;
      if (roll() % 2) state.id = roll();
      state.position[roll() % 3] = anyFloat();
      state.normal[roll() % 3] = anyFloat();
    }
    Stroke stroke{};
    set(stroke.session, idOf(session_));
    set(stroke.client, client);
    stroke.number = number;
    give(stroke.states, states);
    if (!writers_.strokes.write(stroke) && number == number_) --number_;
  }

  // In the name of the server, to any client: results that no server sends.
  void result() {
    heardHands_.take([&](const HandSample& hand) { victim_ = idOf(hand.client); });
    if (!victim_) return;
    if (!results_) results_.emplace(participant_, topics_.points, reliableQos(false, partitionOf(*victim_)));
    std::vector<State> states(1 + roll() % kStates);
    for (State& state : states)
      state = {.id = roll() % points_, .position = {1, 2, 3}, .normal = {0, 0, 1}, .color = roll()};
    State& bad = states[roll() % states.size()];
    switch (roll() % 3) {
      case 0:
        bad.id = points_ + roll() % 1000;
        break;
      case 1:
        bad.position[roll() % 3] = std::numeric_limits<float>::quiet_NaN();
        break;
      default:
        bad.normal[roll() % 3] = 1e30F;
    }
    Points result{};
    set(result.session, idOf(session_));
    result.epoch = roll() % 8 ? 1 + roll() % 3 : roll();  // the first epochs
    result.sample = roll() % 2 ? roll() % 1000 : any64();
    result.acked = any64();
    result.upTo = any64();
    result.head = any64();
    result.digest = any64();
    give(result.states, states);
    results_->write(result);
  }

  void hand() {
    HandSample hand{};
    set(hand.session, idOf(session_));
    set(hand.client, idNumber(++number_));
    hand.which = static_cast<std::uint8_t>(roll());
    put(hand.name, std::string(64, '\x9b'));
    for (int axis = 0; axis < 3; ++axis) {
      hand.position[axis] = roll() % 4 ? 1e300 : anyFloat();
      hand.proxy[axis] = roll() % 4 ? -1e300 : anyFloat();
    }
    hand.touching = hand.sculpts = true;
    hand.number = roll();
    writers_.hands.write(hand);
  }

  // Balls of a client's maximum size, at a new position each time.
  void near(const Id& client) {
    std::vector<palpate_sharing_Ball> balls(8);
    for (palpate_sharing_Ball& ball : balls)
      ball = {.center = {1.0 * (roll() % 1000), 1.0 * (roll() % 1000), 0}, .radius = 1e6};
    Want want = wantOf(client, std::string(200, 'x'));
    want.epoch = 1 + wants_ / 256;
    want.taken = any64();
    give(want.balls, balls);
    writers_.wants.write(want);
  }

  // In the name of the server, to a client near its hand, with the next sample number that it expects: invalid bricks.
  void bricks() {
    heardWants_.take([&](const Want& want) {
      if (isSame(want.session, idOf(session_)) && want.every == 0) heard_ = want;
    });
    if (!heard_) return;
    if (!bricksTo_)
      bricksTo_.emplace(participant_, topics_.points, reliableQos(false, partitionOf(idOf(heard_->client))));
    BrickPart part{.key = any64(), .total = roll() % 3, .count = roll() % 3, .checksum = any64()};
    Points bricks{};
    set(bricks.session, idOf(session_));
    bricks.epoch = heard_->epoch;
    bricks.sample = heard_->taken + 1 + (roll() % 4 ? 0 : roll());
    bricks.true_s = anyFloat();
    bricks.last = bricks.whole = roll() % 2;
    give(bricks.parts, std::span(&part, 1));
    bricksTo_->write(bricks);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  void facts() {
    Facts facts{};
    set(facts.session, idNumber(++number_));
    facts.points = any64();
    facts.spacing = facts.edge = anyFloat();
    writers_.facts.write(facts);
  }

  void notice() {
    Notice notice{};
    set(notice.session, idNumber(++number_));
    notice.version = roll();
    put(notice.name, fmt::format("session {}", number_));
    put(notice.host, std::string(200, 'h'));
    put(notice.model, std::string(1000, 'm'));
    notice.points = any64();
    notice.mm_per_unit = anyFloat();
    writers_.notices.write(notice);
  }

  void ping() {
    Ping ping{};
    set(ping.session, idOf(session_));
    set(ping.client, idNumber(roll() % kManyIds));
    ping.number = roll();
    ping.sent_us = anyFloat();
    writers_.pings.write(ping);
    writers_.echoes.write(ping);
  }

  Participant participant_;
  Topics topics_;
  std::mt19937 dice_;
  Writers writers_;
  Reader<HandSample> heardHands_;
  Reader<Want> heardWants_;
  AnyBytes bytes_;
  std::vector<Reader<Points>> unread_;
  std::optional<Id> victim_;
  std::optional<Writer<Points>> results_;
  std::optional<Want> heard_;  // without its balls, which belong to DDS
  std::optional<Writer<Points>> bricksTo_;
  std::uint8_t session_[16] = {};
  std::uint32_t points_ = 1, epoch_ = 0, wants_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace

}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  try {
    palpate::HostileSide side(static_cast<std::uint32_t>(std::atoi(argv[1])),
                              static_cast<std::uint32_t>(std::atoi(argv[4])));
    if (!side.findSession()) {
      fmt::print("no session to attack\n");
      return 1;
    }
    const std::uint64_t said = side.run(argv[2], std::atof(argv[3]));
    fmt::print("{}\n", said);
    return said > 0 ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print("{}\n", error.what());
    return 1;
  }
}
