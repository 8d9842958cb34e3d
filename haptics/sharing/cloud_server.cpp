#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/start_thread.hpp"
#include "haptics/sharing/heard_hands.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/point_server.hpp"
#include "haptics/sharing/point_writer.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/stroke_server.hpp"
#include "haptics/sharing/version_watch.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kSilentHand_s = 1;  // a hand that is silent for this long touches nothing

}  // namespace

/// Moves the points of a served cloud in real time, on its own thread during its lifetime, with the hands received
/// meanwhile.
class MotionThread {
 public:
  struct Parts {
    ServedMotion motion;
    double rate_Hz = 60;
    const PointCloud& cloud;  ///< at the start; the hands are around it
    const Participant& participant;
    const Topics& topics;
    Id session;
  };
  explicit MotionThread(const Parts& parts)
      : motion_(parts.motion),
        apart_s_(1 / parts.rate_Hz),
        hands_(parts.participant, parts.topics, parts.cloud, kSilentHand_s),
        session_(parts.session),
        thread_(startThread([this](const std::stop_token& stop) { run(stop); })) {}

  struct Moved {
    std::shared_ptr<const CloudFrame> frame;  ///< null: none since the last call
    std::vector<SeenHand> hands;              ///< with the forces on them
  };
  /// Newest frame since the last call. Rethrows what the motion has thrown.
  Moved newest() {
    const std::scoped_lock hold(lock_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::exchange(newest_, {});
  }

  std::uint64_t frames() const { return frames_; }

 private:
  void run(const std::stop_token& stop) {
    try {
      const Stopwatch since;
      for (double next_s = 0; !stop.stop_requested();) {
        const double now_s = since.elapsed_s();
        if (now_s < next_s) {
          std::this_thread::sleep_for(std::chrono::duration<double>(std::min(next_s - now_s, 0.02)));
          continue;
        }
        // Frames that are late are skipped.
        next_s = std::max(next_s + apart_s_, now_s);
        hands_.hear(session_);
        auto frame = std::make_shared<CloudFrame>();
        std::vector<SeenHand> hands = hands_.all();
        if (!motion_(now_s, hands, *frame)) continue;
        ++frames_;
        const std::scoped_lock hold(lock_);
        newest_ = {.frame = std::move(frame), .hands = std::move(hands)};
      }
    } catch (...) {
      const std::scoped_lock hold(lock_);
      failure_ = std::current_exception();
    }
  }

  ServedMotion motion_;
  double apart_s_;
  HeardHands hands_;
  Id session_;
  std::mutex lock_;  // guards the next two
  Moved newest_;
  std::exception_ptr failure_;
  std::atomic<std::uint64_t> frames_ = 0;
  std::jthread thread_;  // destroyed first
};

namespace {

constexpr std::size_t kLongestName = 200;
constexpr std::int32_t kMaxPings = 4096;  // queued
constexpr double kServerPoll_s = 0.05;    // how often a requested stop is checked
constexpr double kFrameLook_s = 0.004;    // how often a new frame is looked for

void requireSessionName(const std::string& name) {
  if (name.empty() || name.size() > kLongestName || printable(name.c_str()) != name)
    throw UsageError("name: '{}' is not a valid session name: 1 to {} bytes without control characters",
                     printable(name.c_str()), kLongestName);
}

FarFacts factsOf(const PointCloud& cloud, const CloudServer::Parts& parts) {
  FarFacts facts = parts.facts.value_or(FarFacts{});
  if (!parts.facts) {
    const SpacingRange spacing = spacingRange(cloud);
    facts = {.spacing = spacing.mean, .wideSpacing = spacing.wide, .noise = spacing.noise, .up = findUp(cloud).up};
  }
  facts.extent = {.bounds = boundsOf(cloud), .points = cloud.size()};
  // A brick has some hundred points of a surface or some dozen particles; the cloud's longest side has at most
  // kMaxAlongSide bricks.
  constexpr double kSpacings = 16, kSpacingsOfMatter = 4, kMaxAlongSide = 1 << 18;
  facts.edge = std::max((facts.matter.empty() ? kSpacings : kSpacingsOfMatter) * facts.spacing,
                        facts.extent.bounds.longestSide() / kMaxAlongSide);
  if (!(facts.edge > 0)) facts.edge = 1;
  facts.moves = static_cast<bool>(parts.motion);
  return facts;
}

}  // namespace

struct CloudServer::Link {
  Link(const PointCloud& served, Parts given)
      : cloud(served),
        parts(std::move(given)),
        participant(parts.network),
        topics(participant),
        name(participant, topics, parts.name, parts.log),
        echoes(participant, topics.pings, bestEffortQos(kEchoes)),
        pings(participant, topics.pings, keepingLast(bestEffortQos(), kMaxPings)),
        versions(participant),
        wait(participant),
        shared(statesOf(cloud)),
        writer({.cloud = cloud, .points = shared, .save = parts.save, .log = parts.log}) {
    wait.attach(pings);
    if (parts.sculptable) goOn();
    streams.emplace(PointServer::Parts{.participant = participant,
                                       .topics = topics,
                                       .session = session,
                                       .cloud = cloud,
                                       .facts = factsOf(cloud, parts),
                                       .file = servedFileOf(cloud),
                                       .points = shared,
                                       .log = parts.log});
    streams->attach(wait);
    if (parts.motion)
      moving.emplace(MotionThread::Parts{.motion = parts.motion,
                                         .rate_Hz = parts.motion_Hz,
                                         .cloud = cloud,
                                         .participant = participant,
                                         .topics = topics,
                                         .session = session});
  }

  // Resumes from the journal, if there is one.
  void goOn() {
    if (!parts.journal.empty()) {
      journal.emplace(
          parts.journal, cloud.size(), sharing::checksumOf(cloud), session, [&](const StrokeJournal::Piece& piece) {
            if (shared.take(piece.client, piece.number, piece.states) != SharedPoints::Taken::taken)
              throw FileError(parts.journal, "is damaged: a piece of a stroke does not follow those before it");
          });
      session = journal->session();
      if (parts.log && journal->pieces() > 0)
        parts.log->say("{}: continues with {} of strokes", parts.journal.string(), counted(journal->pieces(), "piece"));
      if (parts.log && journal->tornBytes() > 0)
        parts.log->say("{}: its last {} bytes were an incomplete piece and are removed; its client sends it again",
                       parts.journal.string(), journal->tornBytes());
    }
    strokes.emplace(StrokeServer::Parts{.participant = participant,
                                        .topics = topics,
                                        .session = session,
                                        .points = shared,
                                        .journal = journal ? &*journal : nullptr,
                                        .log = parts.log});
    strokes->attach(wait);
  }

  // A client of another version learns so from the notice (Notice::version); this logs it at the server.
  void sayVersions() {
    for (const std::uint32_t other : versions.fresh())
      if (parts.log)
        parts.log->say(
            "{}: another version of palpate ({}, and this is {}) is on the network and cannot join; install the same "
            "one on both",
            parts.name, other, kVersion);
  }

  void announce() {
    name.requireFree(parts.stop);
    Notice notice{};
    set(notice.session, session);
    notice.version = kVersion;
    put(notice.name, parts.name);
    put(notice.host, ownHost());
    put(notice.model, printable(parts.model.c_str()));
    notice.points = cloud.size();
    for (int axis = 0; axis < 3; ++axis) notice.origin[axis] = cloud.origin[axis];
    notice.mm_per_unit = parts.mm_per_unit;
    notice.colored = cloud.hasColors();
    notice.sculptable = parts.sculptable;
    notice.checksum = sharing::checksumOf(cloud);
    name.announce(notice);
  }

  const PointCloud& cloud;
  Parts parts;
  Participant participant;
  Topics topics;
  Id session = freshId();
  SessionName name;
  Writer<Ping> echoes;
  Reader<Ping> pings;
  VersionWatch versions;
  ReaderWait wait;
  SharedPoints shared;
  PointWriter writer;
  std::optional<StrokeJournal> journal;
  std::optional<StrokeServer> strokes;
  std::optional<PointServer> streams;
  std::optional<MotionThread> moving;
  std::uint64_t answered = 0;  // pings
};

CloudServer::CloudServer(const PointCloud& cloud, Parts parts) {
  requireSessionName(parts.name);
  if (parts.facts && parts.facts->matter.size() >= sizeof(Facts::matter))
    throw UsageError("matter: a scene of {} bytes is too long to be announced", parts.facts->matter.size());
  if (parts.motion && parts.sculptable) throw UsageError("sculptable: a session that moves cannot be sculpted");
  PALPATE_CHECK(cloud.hasNormals() || cloud.empty());
  constexpr std::uint64_t kMaxPoints = std::uint64_t{0xffffffff} * kBlockPoints;
  PALPATE_CHECK_LT(cloud.size(), kMaxPoints);
  link_ = std::make_unique<Link>(cloud, std::move(parts));
  link_->announce();
}

CloudServer::~CloudServer() = default;

void CloudServer::serve(const std::atomic<bool>& stop, double seconds) {
  const Stopwatch since;
  double next_s = 0;
  while (!stop && !(seconds > 0 && since.elapsed_s() >= seconds)) {
    if (next_s > 0) link_->wait.sleep(std::min(kServerPoll_s, next_s));
    PointServer& streams = *link_->streams;
    link_->pings.take([&](const Ping& ping) {
      if (!isSame(ping.session, link_->session)) return;
      Ping echo = ping;
      link_->writer.answer(echo);
      link_->echoes.write(echo);
      ++link_->answered;
      streams.heard(idOf(ping.client));
    });
    link_->sayVersions();
    link_->name.watch();
    if (link_->strokes) link_->strokes->take();
    if (link_->parts.restarts) streams.tell(link_->parts.restarts());
    streams.take();
    if (link_->moving)
      if (auto moved = link_->moving->newest(); moved.frame) streams.show(std::move(moved.frame), moved.hands);
    next_s = std::min(link_->writer.advance(), streams.write());
    if (link_->moving && !streams.isIdle()) next_s = std::min(next_s, kFrameLook_s);
  }
}

ServedCounts CloudServer::counts() const {
  const StreamCounts& streams = link_->streams->counts();
  ServedCounts counts{.clients = streams.whole,
                      .requests = streams.requests,
                      .blocks = streams.blocks,
                      .pings = link_->answered,
                      .refused = streams.refused,
                      .sent = streams.states,
                      .partial = streams.near,
                      .partialPoints = streams.nearPoints,
                      .partialSteps = streams.nearSteps};
  if (link_->moving) counts.frames = link_->moving->frames();
  if (!link_->strokes) return counts;
  const StrokeTally& strokes = link_->strokes->counts();
  counts.sculptors = strokes.sculptors;
  counts.pieces = strokes.pieces;
  counts.states = strokes.states;
  counts.again = strokes.again;
  counts.refused += strokes.refused;
  return counts;
}

std::span<const PointState> CloudServer::points() const { return link_->shared.points(); }

void CloudServer::save() { link_->writer.writeNow(); }

}  // namespace palpate
