// A hand's link to the server of its session: its age, its silence, its failure, and the thread that serves it.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/server_file.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/link_statistics.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/stroke_outbox.hpp"
#include "haptics/sharing/wanted_points.hpp"

namespace palpate::sharing {

/// Messages of the thread of a joined session, which are added under the session's lock and logged without it.
/// Thread-safe.
class LinkMessages {
 public:
  explicit LinkMessages(Log* log) : log_(log) {}

  void add(std::string message) {
    constexpr std::size_t kMaxUnread = 8;
    const std::scoped_lock hold(lock_);
    if (unread_.size() < kMaxUnread) unread_.push_back(message);
    unlogged_.push_back(std::move(message));
  }

  /// Messages since the last call, the first eight of them.
  std::vector<std::string> take() {
    const std::scoped_lock hold(lock_);
    return std::exchange(unread_, {});
  }

  /// Writes the messages since the last call to the log, which may take long. Exceptions of its listeners are ignored,
  /// since they would end this hand's part in the session (LogListener).
  void log() {
    std::vector<std::string> messages;
    {
      const std::scoped_lock hold(lock_);
      messages.swap(unlogged_);
    }
    if (!log_) return;
    try {
      for (const std::string& message : messages) log_->say("{}", message);
    } catch (...) {
    }
  }

 private:
  Log* log_;
  std::mutex lock_;
  std::vector<std::string> unread_, unlogged_;
};

/// Sends the edits of a hand to the server.
class StrokeSender {
 public:
  /// `session` must outlive it.
  explicit StrokeSender(const JoinedSession& session);
  /// Sends all that is pending to the server of that session, as far as the link has room.
  void send(StrokeOutbox& outbox, const Id& server);

 private:
  bool write(const StrokePiece& piece, const Id& server);

  const JoinedSession& session_;
  Writer<Stroke> strokes_;
  // Of the piece that is written.
  std::vector<State> states_;
  std::vector<std::uint64_t> replaced_;
};

/// Pings a session's server, and receives the echoes.
/// Not thread-safe.
class LinkProbe {
 public:
  /// The session must outlive it. The first pings follow each other sooner: until one is back the round trip is
  /// unknown.
  explicit LinkProbe(const JoinedSession& session);
  void attach(ReaderWait& wait) const { wait.attach(echoes_); }
  /// Receives echoes, and pings when due. Returns whether a new echo was received.
  bool turn();
  /// From now on pings another server of the session's name.
  void follow(const Id& server) { server_ = server; }
  /// Requests a write of the server's file, from the next ping on.
  void requestWrite() { request_.begin(sent_); }
  const std::optional<ServerSave>& answer() const { return request_.answer(); }
  LinkCounts counts() const { return statistics_.counts(since_.elapsed_s()); }

 private:
  Id server_, client_;
  Writer<Ping> pings_;
  Reader<Ping> echoes_;
  LinkStatistics statistics_;
  WriteRequest request_;
  std::uint32_t sent_ = 0;
  Stopwatch since_, lastPing_;
};

/// All functions but the first six are for the holder of lock().
class ServerLink final : public ServerFile {
 public:
  /// The session must outlive it. `failed` is called once, when the link has failed for good.
  ServerLink(const JoinedSession& session, Log* log, std::function<void()> failed = {});

  std::mutex& lock() const { return lock_; }
  const InformationAge& known() const { return known_; }
  /// Log messages since the last call, the first few of them. Thread-safe.
  std::vector<std::string> takeSaid() { return messages_.take(); }
  void requestWrite() override;
  std::optional<ServerSave> answer() const override;
  /// Calls `turn` under the lock, until it is stopped or has failed; wakes when something was received, or `wakeUp` is
  /// called, or after `poll_s`. For the link's own thread.
  void run(const std::stop_token& stop, double poll_s, const WakeUp* wakeUp, const std::function<void()>& turn);

  WantedPoints& points() { return points_; }
  const Id& server() const { return points_.server(); }
  /// Something of the server's stream was received.
  void heard();
  /// Others are changing the surface at a hand here.
  void changed() { known_.changed(); }
  /// Pings the server, and reports when silence reduces the force and when that ends. Returns whether it has answered a
  /// ping since the last call.
  bool probe();
  double silent_s() const { return lastHeard_.elapsed_s(); }
  /// Silent for so long that another server may have taken over.
  bool isSilent() const;
  /// Then: another server of the session's name that was not left before; empty: there is none.
  std::optional<SessionNotice> successor();
  /// Leaves the present server for that one.
  void follow(const Id& server);

  /// Sends the strokes of the hands here, and again if the server takes none, although it is heard. Fails if that does
  /// not help. `progresses`: it has just taken some, or has had no reason to. Returns whether they were sent again.
  bool send(StrokeOutbox& outbox, bool progresses);

  void add(std::string message) { messages_.add(std::move(message)); }
  void fail(const std::string& why);
  const std::string& fault() const { return fault_; }

  double longestSilent_s() const { return std::max(longestSilent_s_, silent_s()); }
  double oldest_s() const { return std::max(oldest_s_, known_.age_s()); }
  LinkCounts counts() const { return probe_.counts(); }

 private:
  void reportForce();

  const JoinedSession& session_;
  std::function<void()> failed_;
  LinkMessages messages_;
  mutable std::mutex lock_;
  WantedPoints points_;
  std::set<Id> left_;  // previous servers
  StrokeSender strokes_;
  LinkProbe probe_;
  SessionNotices notices_;
  InformationAge known_;
  std::string fault_;
  Stopwatch lastHeard_, progressed_;
  double longestSilent_s_ = 0, oldest_s_ = 0;
  int stuck_ = 0;
  enum class Felt { whole, fading, gone } felt_ = Felt::whole;
};

}  // namespace palpate::sharing
