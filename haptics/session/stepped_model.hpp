// A model that moves, without a servo loop: for a program that shows it to hands on other machines.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "engine/core/clock.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/moving_model.hpp"

namespace palpate {

/// Steps what a configuration says that moves: a motion, the frames of a depth camera, or matter, in which the hands
/// are as those of one session: they press a soft body, and hold balls in water and sand. A simulation that has failed
/// begins anew. One thread uses it at a time, but for restarts().
class SteppedModel {
 public:
  struct Parts {
    const BackendKind& backend;  ///< that moves matter
    unsigned threads = 0;        ///< on the CPU; 0: one per core
    Log* log =
        nullptr;  ///< hears of frames that do not go into a map, and of a simulation that begins anew; outlives it
  };
  /// Throws Error, ConfigError.
  SteppedModel(const SessionConfig& config, std::shared_ptr<const Model> model, const Parts& parts);
  ~SteppedModel();

  /// How often step() wants to be called.
  double rate_Hz() const;
  /// Frames a second, at most, that step() gives.
  static constexpr double kFrames_Hz = 60;
  /// Goes on to that time, s since the beginning; hands that are not among `hands` any more touch nothing. False where
  /// the points are where they were in the last frame, or it is too soon for the next one.
  bool step(double time_s, std::span<const SeenHand> hands, CloudFrame& frame);
  /// Of a simulation that has failed. For any thread.
  Restarts restarts() const;

 private:
  // A far hand in the simulation.
  struct Slot {
    std::optional<std::uint32_t> number;
    DVec3 hip{0};
    bool seen = false;
  };
  void move(double time_s, std::span<const SeenHand> hands);
  void restart();
  void leaveParticles(CloudFrame& frame) const;
  void seat(std::span<const SeenHand> hands, double since_s);
  DVec3 nowhere() const;

  std::shared_ptr<const Model> model_;
  std::shared_ptr<PlayedStream> stream_;
  std::optional<FusedStream> fusion_;
  std::unique_ptr<CloudSource> source_;  // where no hand has a part in it
  std::unique_ptr<TouchBackend> matter_;
  Log* log_;
  std::size_t particles_ = 0;  // that move, the first of the points
  double fastest_ = 0;         // that a hand goes, model units per second
  bool isFailing_ = false;
  Stopwatch sinceRestart_;
  mutable std::mutex lock_;  // of the next one
  Restarts restarts_;
  std::array<Slot, kMaxHands> slots_;
  std::optional<double> last_s_, shown_s_;
  double frameTime_s_ = 0;
};

}  // namespace palpate
