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

inline constexpr double kPoll_us = 1;  ///< budget too short for a thread to sleep

/// The probes of a hand; numbering continues across hands.
struct ProbeRange {
  std::uint32_t first = 0, count = 0;
};

/// A question to the GPU: one pose of all hands.
struct Question {
  double time_s = 0;        ///< time of the poses
  bool realtime = false;    ///< its tick may end before the answer arrives
  bool behindEdit = false;  ///< an edit was still in progress
  bool timed = true;        ///< timed on the GPU; a driver on the CPU's cores may wait for all its work to report it
  Stopwatch since;          ///< time since it was asked
  double gpu_us = 0;        ///< GPU time of the lists that have run; after the answer, the reported time
  std::bitset<kMaxHands> dropped;  ///< hands reset since
};

/// Submits questions to the GPU and takes the answers: ahead of the poses or with them, in time or late. One question
/// at a time; QuestionState is its state.
///
/// A question is a run of command lists recorded ahead, one set for each half of the live cloud.
class QuestionPipeline {
 public:
  /// `points`: maximum number of points of the cloud.
  QuestionPipeline(Device& device, const ContactOptions& options, const HashGrid& grid, std::uint32_t points, Wait wait,
                   CommandList::Timing timing);

  /// Records the question for the half of the cloud given by `parity`.
  void record(std::uint32_t parity, const shared::CloudView& cloud, DeviceAddress logHead, DeviceAddress velocities);
  /// Records the reset of each hand.
  void recordForgetting(std::span<const ProbeRange> hands);
  /// Triggers the driver's one-time work now, so that it does not happen during touch.
  void warmUp();
  /// Replaces the contact step, after finish() and once the GPU is idle; all lists must be recorded again.
  void setContact(const ContactOptions& options, const HashGrid& grid, std::uint32_t points);
  /// Sets whether questions may be submitted ahead: as `wanted` says; if not given, on drivers that are known to let a
  /// question wait, if a test shows that it does.
  void allowAhead(std::optional<bool> wanted, std::uint32_t parity);

  QuestionState state() const { return progress_.state(); }
  bool isOut() const { return state() == QuestionState::asked || state() == QuestionState::late; }
  /// In flight or answered, in the tick of its pose.
  bool isInTick() const { return state() == QuestionState::asked || state() == QuestionState::answered; }
  /// The question in flight, or the last one.
  const Question& question() const { return question_; }

  /// Submits the next question ahead, if allowed. `realtime`: there is time to rehearse the last one.
  void askAhead(std::uint32_t parity, bool realtime);
  /// Ends a question that was submitted ahead.
  void withdraw();
  /// Whether the last question's list has ended in the driver's view: some us after its answer was seen.
  bool mayAskWithin(double budget_us) const;
  /// Begins a new question: put() each of its probes, then ask(). Where points move, with their motion since their
  /// frame.
  void begin();
  void put(std::uint32_t probe, const Vec3& place, const shared::ContactState& carried, const PointsMotion& motion);
  void ask(double time_s, bool realtime, bool behindEdit, std::uint32_t parity);
  /// Whether the answer arrives within the budget (0: no limit).
  bool isAnsweredWithin(double budget_us);
  /// Ends the tick of the question.
  void closeTick() { progress_.happened(QuestionEvent::tickClosed); }
  /// Resets a hand: its probes' states are cleared. Not within a tick.
  void resetHand(std::size_t hand);

  // Sample of a probe in the last answer.
  shared::ContactSample sample(std::uint32_t probe) const { return contact_.sample(probe); }
  /// Whether the last answer is complete for all probes.
  bool isWhole() const { return contact_.hasAnswered(tick_); }

  const ContactStep& contact() const { return contact_; }
  bool asksAhead() const { return ahead_; }
  std::uint64_t answeredAhead() const { return answeredAhead_; }
  /// Number of questions so far, those withdrawn included.
  std::uint32_t count() const { return tick_; }
  /// Passes of the last answered question, with their times.
  std::vector<PassRecord> passes() const;

 private:
  // The lists that a question ran or runs, from `first` to `last`, and the submission of the last one.
  struct Run {
    std::uint32_t parity = 0, first = 0, last = 0;
    Queue::Ticket ticket = 0;
  };
  const CommandList& lastList(const Run& run) const { return *lists_[run.parity][run.last]; }
  // GPU time of a list of the last question, once it has run.
  double timeOf_us(std::uint32_t list) const;
  // Whether a question submitted ahead sees what the host writes after the submission.
  bool hearsTheHost(std::uint32_t parity);
  void submit(std::uint32_t parity);
  // Waits until the last question's list may run again, and reads its time.
  void settle();
  // Whether the last submitted list has finished, polled as `wait_` says (0: waits until it has).
  bool runEndsWithin(double budget_us);

  Device& device_;
  Wait wait_;
  CommandList::Timing timing_;
  ContactStep contact_;
  std::array<std::vector<std::unique_ptr<CommandList>>, 2> lists_;
  std::vector<std::unique_ptr<CommandList>> forgets_;  // one per hand
  QuestionProgress progress_;
  Question question_;
  Run run_;       // of the question waiting or in flight, or of the last one
  Run answered_;  // of the last answered question
  std::uint32_t tick_ = 0;
  bool ahead_ = false;
  std::uint64_t answeredAhead_ = 0;
  double lastTime_us_ = 0;  // GPU time of the last question's lists whose time is known
};

/// What the host and the GPU tell each other about a proxy: its state with a question, its sample as the answer.
/// The proxy state passed to the GPU with a question; empty: the GPU's own. Positions relative to the cloud's origin.
shared::ContactState stateOf(const std::optional<ProxyTracker::State>& state);

/// The proxy state for the next tick after the GPU's answer to a HIP, relative to the cloud's origin, at a time.
ProxyTracker::State proxyStateOf(const shared::ContactSample& sample, const DVec3& hip, double time_s);

/// The contact at a HIP, in file coordinates, as answered to the last question.
Contact contactOf(const shared::ContactSample& sample, const DVec3& hip, const QuestionPipeline& questions);

}  // namespace palpate
