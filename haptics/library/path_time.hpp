// When the next path of a session begins, and which hands keep their contact until then.
#pragma once

#include <atomic>
#include <vector>

#include "haptics/path.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

/// Where points move, time continues from path to path; elsewhere each path begins at 0. All but askReset() for one
/// thread at a time.
class PathTime {
 public:
  /// Time of the next tick, s.
  double begin_s() const { return next_s_; }
  /// The path, which begins at 0, at that time.
  Path later(const Path& path) const;
  /// Whether a hand begins where it ended, and so keeps its contact.
  bool goesOn(std::size_t hand, const Path& path, const ModelScale& scale) const;

  /// The next path begins at 0.
  void restart();
  /// The same, once that path begins. For any thread.
  void askReset() { reset_ = true; }
  bool takeReset() { return reset_.exchange(false); }
  /// The hands have moved over points that move.
  void ended(const ServoResult& result, double tick_s);
  /// After a tick of pp_touch(): its contact does not continue in the next path.
  void ticked(double next_s);

 private:
  double next_s_ = 0;
  std::vector<DVec3> hips_;  // of each hand at the end of the last path
  std::atomic<bool> reset_ = false;
};

}  // namespace palpate::library
