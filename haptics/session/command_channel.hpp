// How the commands of a session reach its servo loop, which goes on meanwhile, and its recording.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptics/servo_mailbox.hpp"
#include "haptics/session/running_loop.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

class Log;

/// A command either runs on the loop's thread between two ticks (post()), or works on the points while the loop lends
/// its query (Loan): each hand then keeps the planes that it felt last. Each stands in the recording at its tick.
///
/// For the thread of the session, unless stated otherwise.
class CommandChannel {
 public:
  struct Parts {
    const SessionConfig& config;   ///< after a loan the loop has its force and its brush; outlives this
    std::function<void()> settle;  ///< called once a loan has begun; what it throws ends the loan
    Log* log = nullptr;
  };
  explicit CommandChannel(Parts parts) : parts_(std::move(parts)) {}

  /// The mailbox of a loop on a thread of its own, open while that runs.
  ServoMailbox& mailbox() { return mailbox_; }
  /// A loop runs on this thread while this lives. For that thread.
  class Running {
   public:
    Running(CommandChannel& channel, RunningLoop& loop) : channel_(channel) { channel_.running_ = &loop; }
    ~Running() { channel_.running_ = nullptr; }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    CommandChannel& channel_;
  };

  /// Calls act(RunningLoop&), which must be noexcept and returns a tick of the recording, between two ticks. Returns
  /// that tick; nothing where no loop runs. Throws CommandTimeout.
  template <class Act>
  std::optional<std::uint64_t> post(Act act) {
    std::uint64_t tick = 0;
    const auto run = [this, act, &tick]() noexcept { tick = act(*running_); };
    if (mailbox_.isOpen()) {
      if (!mailbox_.post(run)) return std::nullopt;
    } else {
      if (!running_) return std::nullopt;
      run();
    }
    return tick;
  }

  /// The query of a loop in progress is lent while this lives. May be nested. Throws CommandTimeout, and as
  /// Parts::settle does; then nothing has changed.
  class Loan {
   public:
    /// `endsRecording`: the recording has no tick from now on.
    explicit Loan(CommandChannel& channel, bool endsRecording = false) : channel_(channel) {
      channel_.borrow(endsRecording);
    }
    ~Loan() { channel_.giveBack(); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

   private:
    CommandChannel& channel_;
  };
  /// Lends it until the next command.
  void lend();
  bool isLent() const { return isLent_; }
  /// Neither lent nor in a Loan.
  bool isFree() const { return !isLent_ && loans_ == 0; }
  /// While it is lent: the time of the loop's next tick.
  double next_s() const { return lent_.next_s; }

  // The recording, which is changed in a Loan.
  SessionRecording* recording() const { return recording_.get(); }
  /// `contacts`: those of the back end (recordContacts()), if a loop is running.
  void begin(std::unique_ptr<SessionRecording> recording, std::vector<double> contacts);
  std::unique_ptr<SessionRecording> release();
  /// Records a command that has taken effect before that tick.
  void add(std::uint64_t tick, LoggedCommand command);
  /// Records a command of the present loan, once that has been given back; where no loop runs, now, if it is a change
  /// of points, a mask or a field, or the first tick is still to come.
  void note(LoggedCommand::Kind kind, std::string content);

 private:
  void borrow(bool endsRecording);
  void giveBack() noexcept;
  void record(std::uint64_t tick);

  Parts parts_;
  ServoMailbox mailbox_;
  RunningLoop* running_ = nullptr;  // for the thread of the loop
  int loans_ = 0;                   // nested
  bool isLent_ = false;
  RunningLoop::Lent lent_;
  std::unique_ptr<SessionRecording> recording_;
  std::vector<LoggedCommand> notes_;  // of the loan
  std::vector<double> contacts_,
      state_;  // of a recording that begins in a running loop: contacts, and the loop's state
};

}  // namespace palpate
