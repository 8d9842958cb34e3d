// A Haply Inverse3 with its grip, through the Haply service of this machine, which needs no SDK.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/latest_value.hpp"
#include "engine/core/semaphore.hpp"
#include "engine/core/start_thread.hpp"
#include "engine/core/vec.hpp"
#include "haptics/devices/haply_service.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/session_clock.hpp"

namespace palpate {

/// Reports of a thread that sends forces, passed to a thread that has the time to say them.
/// post() neither allocates nor waits, whatever the receiver does: a terminal that is stopped blocks what is written
/// to it. One thread posts.
template <class Code>
class ReportQueue {
 public:
  /// `report` is called on a thread of the queue, in order, also for what was posted before the end; what it throws is
  /// ignored.
  explicit ReportQueue(std::function<void(Code)> report) : report_(std::move(report)) {
    reporter_ = startThread([this](const std::stop_token& stop) { work(stop); });
  }
  ~ReportQueue() {
    reporter_.request_stop();
    posted_.post();
  }
  ReportQueue(const ReportQueue&) = delete;
  ReportQueue& operator=(const ReportQueue&) = delete;

  /// Dropped while kLength earlier ones are pending.
  void post(Code code) noexcept {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kLength) return;
    codes_[end % kLength] = code;
    end_.store(end + 1, std::memory_order_release);
    posted_.post();
  }

 private:
  static constexpr std::size_t kLength = 64;

  void work(const std::stop_token& stop) {
    while (true) {
      const std::size_t begin = begin_.load(std::memory_order_relaxed);
      if (begin == end_.load(std::memory_order_acquire)) {
        if (stop.stop_requested()) return;
        posted_.take();
        continue;
      }
      const Code code = codes_[begin % kLength];
      begin_.store(begin + 1, std::memory_order_release);
      try {
        report_(code);
      } catch (...) {  // NOLINT(bugprone-empty-catch): a listener may not end the device's thread
      }
    }
  }

  std::function<void(Code)> report_;
  std::array<Code, kLength> codes_{};
  std::atomic<std::size_t> begin_ = 0, end_ = 0;
  Semaphore posted_;
  std::jthread reporter_;  // destroyed first
};

namespace haply {

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

}  // namespace haply

struct HaplyOptions {
  std::string serial;                           ///< empty: the only device
  bool shares = false;                          ///< takes a device that another program uses, whose forces add to these
  std::function<void(const std::string&)> say;  ///< messages for the user, also from a thread of the device
  /// Replaces the machine's clock, and must outlive the device. The service paces the exchange then.
  SessionClock* clock = nullptr;
};

/// A thread of its own exchanges messages with the service, at most 4000 times a second: each tells the newest force
/// and is answered with the newest state. read() and write() exchange both with that thread and never wait. The
/// thread itself takes the force away as soon as a state shows a fault, several in a row show another program's force,
/// none comes for 20 ms, or no force was written for 20 ms; it stays away for so long that ForceGate then waits for
/// free space. Another thread says why, so that no listener delays the zero.
class HaplyDevice final : public HapticDevice {
 public:
  /// Throws Error that says what is missing and what to do.
  explicit HaplyDevice(const HaplyOptions& options);
  /// Tells the service a force of zero, and closes.
  ~HaplyDevice() override;

  std::string_view name() const override { return facts_.model; }
  DeviceLimits limits() const override { return limits_; }
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  /// Also gives the exchange a moment to send the zero.
  void emergencyStop() noexcept override;
  bool isStopped() const noexcept override { return stopped_.load(); }
  void resume() noexcept override;
  std::string faultText() const override;

  const HapticDeviceFacts& facts() const { return facts_; }

 private:
  void choose();
  std::int64_t now_ns() const noexcept { return clock_.now_ns(); }
  void say(const std::string& sentence);
  void exchange(const std::stop_token& stop);
  /// False at the end of the session.
  bool exchangeOnce(std::string& message);
  void hearEvents();
  void take(const std::string& message, std::int64_t now_ns);
  void accept(const std::string& message, std::int64_t now_ns);
  void enter(haply::Trouble trouble, std::int64_t now_ns);
  void tell(haply::Trouble trouble);
  void publish(std::int64_t now_ns);
  DVec3 permitted_N(std::int64_t now_ns) noexcept;
  bool send(const DVec3& force_N);

  HaplyOptions options_;
  SessionClock& clock_;
  std::unique_ptr<HaplyService> service_;
  haply::Choice choice_;
  bool values_ = false;  ///< spelling of the force
  HapticDeviceFacts facts_;
  DeviceLimits limits_;

  // Used by the thread of the exchange.
  haply::State state_;
  haply::ForceWatch forces_;
  bool introduced_ = false, safetyHolds_ = false;
  int unanswered_ = 0;
  haply::Trouble told_ = haply::Trouble::none;
  std::int64_t good_ns_ = 0, sent_ns_ = 0, quietUntil_ns_ = 0;

  /// For the thread that ticks.
  struct Shown {
    DVec3 position_mm{0};
    DQuat turn{1, 0, 0, 0};
    std::uint32_t buttons = 0;
    bool rendersForce = false;
    std::int64_t time_ns = 0;  ///< of the state
  };
  LatestValue<Shown> shown_;
  Shown last_;  // used by the thread that ticks
  struct Wanted {
    DVec3 force_N{0};
    std::int64_t time_ns = 0;
  };
  LatestValue<Wanted> wanted_;
  Wanted newest_;  // used by the thread of the exchange

  std::atomic<haply::Trouble> fault_ = haply::Trouble::none;  ///< that ended the session
  std::atomic<bool> stopped_ = false, zeroSent_ = false;
  ReportQueue<haply::Trouble> reports_;
  std::jthread exchange_;  // destroyed first
};

}  // namespace palpate
