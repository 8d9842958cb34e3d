#include "haptics/sharing/server_link.hpp"

namespace palpate::sharing {

namespace {

constexpr double kPing_s = 0.2, kFirstPings_s = 0.05;
constexpr std::uint32_t kFirstPings = 8;

constexpr double kServerTimeout_s = 3;  // then another server of the name is searched for
constexpr double kStrokeTimeout_s = 5;  // then strokes that were not taken are sent again
constexpr int kMaxStrokeRetries = 12;   // in a row without progress, while the server is heard

}  // namespace

StrokeSender::StrokeSender(const JoinedSession& session)
    : session_(session), strokes_(session.participant, session.topics.strokes, reliableQos(false)) {}

void StrokeSender::send(StrokeOutbox& outbox, const Id& server) {
  while (const StrokePiece* piece = outbox.nextPiece(kStates)) {
    if (write(*piece, server)) continue;
    outbox.notSent();
    break;
  }
}

bool StrokeSender::write(const StrokePiece& piece, const Id& server) {
  Stroke stroke{};
  set(stroke.session, server);
  set(stroke.client, session_.client);
  stroke.number = piece.number;
  states_.clear();
  for (const PointState& point : piece.states) states_.push_back(stateOf(point));
  give(stroke.states, states_);
  replaced_ = piece.replaced;
  give(stroke.replaced, replaced_);
  return strokes_.write(stroke);
}

LinkProbe::LinkProbe(const JoinedSession& session)
    : server_(session.session),
      client_(session.client),
      pings_(session.participant, session.topics.pings, bestEffortQos()),
      echoes_(session.participant, session.topics.pings, bestEffortQos(kEchoes)) {}

bool LinkProbe::turn() {
  bool isAnswered = false;
  echoes_.take([&](const Ping& echo) {
    if (!isSame(echo.session, server_) || !isSame(echo.client, client_)) return;
    isAnswered = statistics_.answered(echo.number, since_.elapsed_s()) || isAnswered;
    request_.answered(echo);
  });
  if (lastPing_.elapsed_s() < (sent_ < kFirstPings ? kFirstPings_s : kPing_s)) return isAnswered;
  lastPing_ = {};
  Ping ping{};
  set(ping.session, server_);
  set(ping.client, client_);
  ping.number = sent_ = statistics_.sent(since_.elapsed_s());
  ping.sent_us = since_.elapsed_us();
  ping.write = request_.write();
  pings_.write(ping);
  return isAnswered;
}

ServerLink::ServerLink(const JoinedSession& session, Log* log, std::function<void()> failed)
    : session_(session),
      failed_(std::move(failed)),
      messages_(log),
      points_(session.participant, session.topics, session.session, session.client),
      strokes_(session),
      probe_(session),
      notices_(session.participant, session.topics) {}

void ServerLink::run(const std::stop_token& stop, double poll_s, const WakeUp* wakeUp,
                     const std::function<void()>& turn) {
  ReaderWait wait(session_.participant);
  try {
    points_.attach(wait);
    probe_.attach(wait);
    if (wakeUp) wait.attach(*wakeUp);
    while (!stop.stop_requested() && fault_.empty()) {  // only this thread sets fault_
      wait.sleep(poll_s);
      if (wakeUp) wakeUp->take();
      {
        const std::scoped_lock hold(lock_);
        turn();
      }
      messages_.log();
    }
  } catch (const std::exception& error) {
    const std::scoped_lock hold(lock_);
    fail(fmt::format("'{}' of {}: {}", session_.name, session_.host, error.what()));
  }
  messages_.log();
  const std::scoped_lock hold(lock_);
  points_.close();
}

void ServerLink::requestWrite() {
  const std::scoped_lock hold(lock_);
  probe_.requestWrite();
}

std::optional<ServerSave> ServerLink::answer() const {
  const std::scoped_lock hold(lock_);
  if (probe_.answer() || fault_.empty()) return probe_.answer();
  return ServerSave{.words = fault_};
}

void ServerLink::heard() {
  longestSilent_s_ = longestSilent_s();
  oldest_s_ = oldest_s();
  lastHeard_ = {};
  known_.heard();
}

bool ServerLink::probe() {
  const bool isAnswered = probe_.turn();
  if (const auto trip_ms = probe_.counts().roundTrip_ms) known_.setRoundTrip(*trip_ms * 1e-3);
  reportForce();
  return isAnswered;
}

void ServerLink::reportForce() {
  const double share = known_.share();
  const Felt now = share >= 1 ? Felt::whole : share > 0 ? Felt::fading : Felt::gone;
  if (now == std::exchange(felt_, now)) return;
  if (now == Felt::whole)  // ForceGate waits for the hand to be outside
    add(
        fmt::format("messages from {} of {} arrive again: the force returns; where it was gone, once the hand has left "
                    "the surface",
                    session_.name, session_.host));
  if (now == Felt::fading)
    add(fmt::format("no message from {} of {} for {:.1f} s: the force fades; edits made here are kept for it",
                    session_.name, session_.host, silent_s()));
  if (now == Felt::gone)
    add(fmt::format("no message from {} of {} for {:.1f} s: no force until the next message", session_.name,
                    session_.host, silent_s()));
}

bool ServerLink::isSilent() const { return silent_s() > kServerTimeout_s; }

std::optional<SessionNotice> ServerLink::successor() {
  for (const SessionNotice& notice : notices_.known())
    if (notice.name == session_.name && notice.session != server() && !left_.contains(notice.session)) return notice;
  return std::nullopt;
}

void ServerLink::follow(const Id& server) {
  left_.insert(points_.server());
  points_.follow(server);
  probe_.follow(server);
}

bool ServerLink::send(StrokeOutbox& outbox, bool progresses) {
  if (progresses) stuck_ = 0;
  if (progresses || outbox.isEmpty() || isSilent()) progressed_ = {};
  bool isAgain = false;
  if (progressed_.elapsed_s() > kStrokeTimeout_s) {
    progressed_ = {};
    if (++stuck_ > kMaxStrokeRetries) {
      fail(fmt::format("'{}' of {} accepts no edits of this hand; save the cloud, and join it again", session_.name,
                       session_.host));
      return false;
    }
    outbox.sendAgain();
    isAgain = true;
  }
  strokes_.send(outbox, server());
  return isAgain;
}

void ServerLink::fail(const std::string& why) {
  if (!fault_.empty()) return;
  fault_ = why;
  known_.fail();
  if (failed_) failed_();
  add(why);
}

}  // namespace palpate::sharing
