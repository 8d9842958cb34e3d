// A moving model without a servo loop: for a program that serves it to hands on other machines.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "engine/core/clock.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/moving_model.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

/// Steps the configured motion: a rigid motion, the frames of a depth camera, or matter, with the hands as in one
/// session: they press a soft body, and hold balls in water and sand. A simulation that has failed is restarted. For
/// one thread at a time, except restarts().
class SteppedModel {
 public:
  struct Parts {
    const BackendKind& backend;  ///< simulates the matter
    unsigned threads = 0;        ///< on the CPU; 0: one per core
    Log* log = nullptr;          ///< for frames that are not fused, and restarts; must outlive it
  };
  /// Throws Error, ConfigError.
  SteppedModel(const SessionConfig& config, std::shared_ptr<const Model> model, const Parts& parts);
  ~SteppedModel();

  /// Rate at which step() is to be called.
  double rate_Hz() const;
  /// Maximum rate of the frames that step() returns.
  static constexpr double kFrames_Hz = 60;
  /// Advances to that time, s since the beginning; hands that are missing in `hands` stop touching. False if the points
  /// have not moved since the last frame, or the next one is not due yet. Sets the force of water or sand on each
  /// hand.
  bool step(double time_s, std::span<SeenHand> hands, CloudFrame& frame);
  /// Restarts of a simulation that has failed. Thread-safe.
  Restarts restarts() const;

 private:
  // A remote hand in the simulation.
  struct Slot {
    std::optional<std::uint32_t> number;
    DVec3 hip{0};
    bool seen = false;
  };
  void move(double time_s, std::span<SeenHand> hands);
  void restart();
  void leaveParticles(CloudFrame& frame) const;
  void seat(std::span<const SeenHand> hands, double since_s);
  DVec3 nowhere() const;

  std::shared_ptr<const Model> model_;
  std::shared_ptr<PlayedStream> stream_;
  std::optional<FusedStream> fusion_;
  std::unique_ptr<CloudSource> source_;  // if hands have no influence
  std::optional<Session> matter_;        // if they do: it is pulled
  Log* log_;
  std::size_t particles_ = 0;  // number of moving points, which are the first
  double fastest_ = 0;         // maximum speed of a hand, model units per second
  bool isFailing_ = false;
  Stopwatch sinceRestart_;
  mutable std::mutex lock_;  // protects restarts_
  Restarts restarts_;
  std::array<Slot, kMaxHands> slots_;
  std::optional<double> last_s_, shown_s_;
  double frameTime_s_ = 0;
};

}  // namespace palpate
