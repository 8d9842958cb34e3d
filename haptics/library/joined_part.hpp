// What a session of the library's has with others, where it was joined.
#pragma once

#include <palpate/palpate.h>

#include <optional>
#include <string>
#include <vector>

#include "haptics/session/session.hpp"
#include "haptics/session/session_joiner.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate::library {

/// Which network a program means.
NetworkConfig networkFrom(const pp_network* network);

/// What ends a call that waits there.
StopSign stopFrom(const pp_network* network);

/// How a session of others is joined.
struct JoinSubject {
  JoinConfig network;
  std::string hand;  ///< empty: as the machine
  double patience_s = Joining{}.patience_s;
  bool readOnly = false;
  StopSign stop;  ///< of the call that joins
};
/// Throws UsageError.
JoinSubject joinFrom(const pp_join_options& options);

class JoinedPart {
 public:
  explicit JoinedPart(JoinSubject how) : how_(std::move(how)) {}

  double patience_s() const { return how_.patience_s; }
  /// Remembers whose it is. For one model, and for as long as this is.
  SessionJoiner joiner();
  /// A brush as it can be there. Throws UsageError where there can be none.
  BrushConfig allowed(const BrushConfig& brush, const Session& session) const;
  pp_sharing state(const Session& session) const;
  std::vector<pp_other_hand> others(const Session& session) const;
  std::vector<pp_other_camera> cameras(const Session& session) const;
  void showCamera(const Session& session, const pp_camera_place* camera) const;
  /// Throws NetworkError where this hand's part has ended for good.
  void check(const Session& session) const;

 private:
  JoinSubject how_;
  std::string name_, host_, source_;
};

}  // namespace palpate::library
