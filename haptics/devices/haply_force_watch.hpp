#pragma once

#include <array>
#include <optional>

#include "engine/core/vec.hpp"

namespace palpate::haply {

/// Compares the force that the service says it applies with those that this program sent. The service adds up the
/// forces of all programs, and does not say how long its report lags behind: a report is this program's if it is
/// within the range of the newest forces sent.
class ForceWatch {
 public:
  static constexpr int kStates = 5;  ///< in a row that show another program's force: one may be a glitch

  void sent(const DVec3& force_N) noexcept {
    sent_N_[next_] = force_N;
    next_ = (next_ + 1) % sent_N_.size();
  }

  /// To be called with each state. True while another program's force is in it.
  bool showsAnother(const std::optional<DVec3>& reported_N) noexcept {
    if (!reported_N) return false;
    DVec3 least_N(0), most_N(0);
    for (const DVec3& force_N : sent_N_) {
      least_N = glm::min(least_N, force_N);
      most_N = glm::max(most_N, force_N);
    }
    const double largest_N = glm::length(glm::max(-least_N, most_N));
    const double off_N = glm::length(*reported_N - glm::clamp(*reported_N, least_N, most_N));
    states_ = off_N > kTolerance_N + kTolerance * largest_N ? states_ + 1 : 0;
    return states_ >= kStates;
  }

 private:
  static constexpr double kTolerance_N = 0.1, kTolerance = 0.1;  ///< of a report, and its share of the largest force

  std::array<DVec3, 32> sent_N_{};  ///< 8 ms at 4000 states a second
  std::size_t next_ = 0;
  int states_ = 0;
};

}  // namespace palpate::haply
