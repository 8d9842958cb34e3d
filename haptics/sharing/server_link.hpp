// A hand's link to the server of its session: its age, its silence, its failure, and the thread that serves it.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>

#include "haptics/server_file.hpp"
#include "haptics/sharing/link_messages.hpp"
#include "haptics/sharing/link_probe.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/stroke_sender.hpp"
#include "haptics/sharing/wanted_points.hpp"

namespace palpate::sharing {

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
