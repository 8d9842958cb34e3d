// A simulation that follows hands: step by step to the time of each pose.
#pragma once

#include <array>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/touch/stepped_control.hpp"

namespace palpate {

/// Where hands are at a time.
struct MatterQuestion {
  double time_s = 0;
  std::array<HandPose, kMaxHands> hands;
  /// How often each was put down elsewhere: its ball stands where it is, then, however it came there.
  std::array<std::uint32_t, kMaxHands> putDown{};
};

/// What they get.
struct MatterAnswer {
  MatterQuestion question;
  bool moves = true;  ///< false: it is held, and nobody feels anything
  MatterState state = MatterState::running;
  std::optional<double> known_s;  ///< MatterSimulation::knownAt_s()
  std::array<ToolAnswer, kMaxHands> hands;
};

/// The particles at some time, by id.
struct MatterView {
  double time_s = 0;                        ///< of the question
  std::vector<Vec3> positions, velocities;  ///< m, m/s
};

/// goTo() is for one thread, take() for another one, and the rest for any.
class MatterSteps final : public SteppedControl {
 public:
  /// `simulation` has `tools` of them. `mostAtOnce`: steps in one goTo(); those beyond it are left out. 0: any number.
  MatterSteps(std::unique_ptr<MatterSimulation> simulation, std::size_t tools, std::uint32_t mostAtOnce);

  /// As many steps as fit between the last question and this one, at the first one a single one; where time goes back
  /// the scene begins anew.
  MatterAnswer goTo(const MatterQuestion& question);
  /// The same where nothing may be thrown: what was is kept, and this and all further answers are of a simulation that
  /// does not run.
  MatterAnswer answerTo(const MatterQuestion& question) noexcept;
  /// Throws what answerTo() has kept, if anything.
  void throwFault() const;
  /// It would throw.
  bool isFaulty() const noexcept { return faulty_.load(); }
  const MatterSimulation& world() const { return *world_; }

  /// The newest particles that are shown. False where none are since the last time.
  bool take(MatterView& view);
  /// Shows the particles as the last question has left them, unless they were. For the thread of goTo().
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
  std::optional<double> unshown_s_;                 // time of the last question, where it moved what is not shown yet
  std::atomic<bool> faulty_ = false;
  std::exception_ptr fault_;         // written before the flag
  std::atomic<bool> wanted_ = true;  // somebody would take what is shown
  std::mutex mutex_;
  std::optional<double> shownAt_s_;  // nothing: it was taken
  std::vector<Vec3> positions_, velocities_;
};

}  // namespace palpate
