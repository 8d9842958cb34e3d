// This program's part in a joined session.
#pragma once

#include <palpate/palpate.h>

#include <string>
#include <string_view>
#include <vector>

#include "haptics/session/session.hpp"
#include "haptics/sharing/network.hpp"
#include "haptics/sharing/session_joiner.hpp"

namespace palpate::library {

/// Validates the network of a program.
NetworkConfig networkFrom(const pp_network* network);

/// Stop sign of a call that waits on that network.
StopSign stopFrom(const pp_network* network);

/// How to join a session.
struct JoinSubject {
  JoinConfig network;
  std::string hand;  ///< name of the hand; empty: name of the machine
  double timeout_s = Joining{}.timeout_s;
  bool readOnly = false;
  StopSign stop;  ///< of the joining call
};
/// Throws UsageError.
JoinSubject joinFrom(const pp_join_options& options);

class JoinedPart {
 public:
  explicit JoinedPart(JoinSubject how) : how_(std::move(how)) {}

  double timeout_s() const { return how_.timeout_s; }
  /// Joins, and stores the names of session, server and points. For one model; must not outlive this.
  SessionJoiner joiner();
  /// The brush as the joined session allows it. Throws UsageError if none is allowed.
  BrushConfig allowed(const BrushConfig& brush, const Session& session) const;
  pp_sharing state(const Session& session) const;
  std::vector<pp_other_hand> otherHands(const Session& session) const;
  std::vector<pp_other_camera> cameras(const Session& session) const;
  void publishCamera(const Session& session, const pp_camera_place* camera) const;
  /// Whether the server has confirmed all edits of this program.
  static bool isDelivered(const Session& session);
  /// Throws NetworkError if it has not.
  void requireDelivered(const Session& session, std::string_view what) const;
  /// Throws NetworkError if this hand's part has ended permanently.
  void check(const Session& session) const;

 private:
  JoinSubject how_;
  std::string name_, host_, source_;
};

}  // namespace palpate::library
