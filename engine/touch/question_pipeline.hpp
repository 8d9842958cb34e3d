#pragma once

#include <array>
#include <bitset>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/contact/contact_step.hpp"
#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/touch/question_state.hpp"

namespace palpate {

class Device;

inline constexpr double kPoll_us = 1;  ///< a budget that lets no thread sleep

/// The probes of a hand, numbered through all hands.
struct ProbeRange {
  std::uint32_t first = 0, count = 0;
};

/// What is asked of the GPU at one pose of all hands.
struct Question {
  double time_s = 0;        ///< of the poses
  bool realtime = false;    ///< its tick may end before the answer comes
  bool behindEdit = false;  ///< an edit was still under way
  bool timed = true;        ///< on the GPU; a driver that needs our cores may wait for all its work to tell a time
  Stopwatch since;          ///< it was asked
  double gpu_us = 0;        ///< of the lists that have run; once it is answered, what is reported of them
  std::bitset<kMaxHands> dropped;  ///< hands that have begun anew since
};

/// Asks the GPU and takes its answers: ahead of the poses or with them, in time or late. One question at a time;
/// QuestionState says where it is.
///
/// A question is a run of command lists recorded ahead, one for each half of the live cloud.
class QuestionPipeline {
 public:
  /// `points`: how many the cloud may have.
  QuestionPipeline(Device& device, const ContactOptions& options, const HashGrid& grid, std::uint32_t points, Wait wait,
                   CommandList::Timing timing);

  /// Records the question for the half of the cloud that `parity` tells.
  void record(std::uint32_t parity, const shared::CloudView& cloud, DeviceAddress logHead, DeviceAddress velocities);
  /// Records how each of the hands begins anew.
  void recordForgetting(std::span<const ProbeRange> hands);
  /// Has the driver do once what it would else do in mid-touch.
  void warmUp();
  /// Another contact step, after finish() and once the GPU is at rest; all must be recorded again.
  void setContact(const ContactOptions& options, const HashGrid& grid, std::uint32_t points);
  /// Questions may be submitted ahead: `wanted` says so, or else on drivers that are known to let a question wait, if
  /// it does.
  void allowAhead(std::optional<bool> wanted, std::uint32_t parity);

  QuestionState state() const { return progress_.state(); }
  bool isOut() const { return state() == QuestionState::asked || state() == QuestionState::late; }
  /// In the tick of its pose.
  bool isInTick() const { return state() == QuestionState::asked || state() == QuestionState::answered; }
  /// The question that is out, or the last one.
  const Question& question() const { return question_; }

  /// Submits the next question ahead, if it may be.
  void askAhead(std::uint32_t parity);
  /// Ends a question that was submitted ahead.
  void withdraw();
  /// Whether the last question's list has ended, as the driver sees it: some us after its answer was seen.
  bool mayAskWithin(double budget_us) const;
  /// A new question: put() each of its probes, then ask(). Where points move, with how they have gone on since.
  void begin();
  void put(std::uint32_t probe, const Vec3& place, const shared::ContactState& carried, const PointsMotion& motion);
  void ask(double time_s, bool realtime, bool behindEdit, std::uint32_t parity);
  /// Whether the answer is there within the budget (0: whenever it comes).
  bool isAnsweredWithin(double budget_us);
  /// The tick of the question is over.
  void closeTick() { progress_.happened(QuestionEvent::tickClosed); }
  /// A hand begins anew: what its probes have felt is forgotten. Not within a tick.
  void resetHand(std::size_t hand);

  // Of the last answer.
  shared::ContactSample sample(std::uint32_t probe) const { return contact_.sample(probe); }
  /// Whether it is there, whole, for all probes.
  bool isWhole() const { return contact_.hasAnswered(tick_); }

  const ContactStep& contact() const { return contact_; }
  bool asksAhead() const { return ahead_; }
  std::uint64_t answeredAhead() const { return answeredAhead_; }
  /// The passes of the last question that was answered, with their times.
  std::vector<PassRecord> passes() const;

 private:
  // The lists that a question ran or runs, from `first` to `last`, and the submission of the last one.
  struct Run {
    std::uint32_t parity = 0, first = 0, last = 0;
    Queue::Ticket ticket = 0;
  };
  const CommandList& lastList(const Run& run) const { return *lists_[run.parity][run.last]; }
  // Whether a question that was submitted ahead hears what the host writes then.
  bool hearsTheHost(std::uint32_t parity);
  void submit(std::uint32_t parity);
  // Waits until the last question's list may run again, and learns how long it took.
  void settle();
  // Whether the list that was submitted last has done its part, as `wait_` looks at it (0: waits until it has).
  bool runEndsWithin(double budget_us);

  Device& device_;
  Wait wait_;
  CommandList::Timing timing_;
  ContactStep contact_;
  std::array<std::vector<std::unique_ptr<CommandList>>, 2> lists_;
  std::vector<std::unique_ptr<CommandList>> forgets_;  // one for each hand
  QuestionProgress progress_;
  Question question_;
  Run run_;       // of the question that waits or is out, or of the last one
  Run answered_;  // of the last one that was answered
  std::uint32_t tick_ = 0;
  bool ahead_ = false;
  std::uint64_t answeredAhead_ = 0;
  double lastTime_us_ = 0;  // on the GPU, of the last question's lists whose time is known
};

}  // namespace palpate
