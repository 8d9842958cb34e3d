// A simulation that follows the hands, step by step to the time of each pose.
#pragma once

#include <array>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/matter/stepped_control.hpp"

namespace palpate {

/// Poses of the hands at a time.
struct MatterQuestion {
  double time_s = 0;
  std::array<HandPose, kMaxHands> hands;
  /// Number of repositionings of each hand: after one its ball is placed at the hand instead of moving there.
  std::array<std::uint32_t, kMaxHands> putDown{};
};

/// The answers to the hands.
struct MatterAnswer {
  MatterQuestion question;
  bool moves = true;  ///< false: it is paused, and no hand feels anything
  MatterState state = MatterState::running;
  std::array<ToolAnswer, kMaxHands> hands;
};

/// The particles at a time, by id.
struct MatterView {
  double time_s = 0;                        ///< time of the question
  std::vector<Vec3> positions, velocities;  ///< m, m/s
};

/// goTo() is for one thread, take() for one other thread, the rest for any thread.
class MatterSteps final : public SteppedControl {
 public:
  /// `simulation` has `tools` tools. `mostAtOnce`: maximum number of steps in one goTo(), further steps are dropped; 0:
  /// unlimited.
  MatterSteps(std::unique_ptr<MatterSimulation> simulation, std::size_t tools, std::uint32_t mostAtOnce);

  /// Runs the steps that fit between the last question and this one, a single step for the first question; if time goes
  /// back the scene restarts.
  MatterAnswer goTo(const MatterQuestion& question);
  /// The same without throwing: an exception is kept, and this and all further answers are those of a simulation that
  /// does not run.
  MatterAnswer answerTo(const MatterQuestion& question) noexcept;
  /// Throws the exception that answerTo() has kept, if any.
  void throwFault() const;
  /// Whether throwFault() would throw.
  bool isFaulty() const noexcept { return faulty_.load(); }
  const MatterSimulation& world() const { return *world_; }

  /// Takes the newest shown particles. False if there are none since the last call.
  bool take(MatterView& view);
  /// Shows the particles in the state after the last question, unless already shown. For the thread of goTo().
  void showPresent();

 private:
  void restart();
  void place(const MatterQuestion& question);
  void show(double time_s);

  std::unique_ptr<MatterSimulation> world_;
  std::size_t tools_;
  std::vector<HandPose> hands_;  // of the last question
  std::vector<HandPose> between_;
  std::array<std::uint32_t, kMaxHands> putDown_{};  // of the last question
  std::optional<double> unshown_s_;  // time of the last question, if it moved particles and these are not shown yet
  std::atomic<bool> faulty_ = false;
  std::exception_ptr fault_;         // written before faulty_
  std::atomic<bool> wanted_ = true;  // the last shown particles were taken
  std::mutex mutex_;
  std::optional<double> shownAt_s_;  // nullopt: taken
  std::vector<Vec3> positions_, velocities_;
};

}  // namespace palpate
