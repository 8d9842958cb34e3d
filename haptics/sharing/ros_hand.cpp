#include <chrono>
#include <thread>
#include <vector>

#include "engine/core/start_thread.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"
#include "haptics/sharing/ros_tf.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kMetres_per_mm = 1e-3;
constexpr std::size_t kWaiting = 1 << 13;  // maximum of queued ticks, eight seconds at 1 kHz
constexpr auto kLook = std::chrono::milliseconds(2);

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

template <class V>
void put(V& to, const DVec3& from) {
  to.x = from.x;
  to.y = from.y;
  to.z = from.z;
}

}  // namespace

void requireRosName(const std::string& name) { rosName(name); }

class RosHand::Link {
 public:
  struct Tick {
    double time_s = 0;
    DVec3 hip{0}, proxy{0}, force_N{0}, torque_mNm{0};
    DQuat turn{1, 0, 0, 0};
  };

  Link(const RosPublishing& publishing, double rate_Hz)
      : publishing_(publishing),
        frame_(rosName(publishing.name)),
        least_s_(1 / rate_Hz),
        participant_(rosParticipant(publishing.network)),
        poses_(participant_, topic("pose"), RosDelivery::reliable),
        proxies_(participant_, topic("proxy"), RosDelivery::reliable),
        wrenches_(participant_, topic("wrench"), RosDelivery::reliable),
        frames_(participant_, frame_, frame_ + "/hand", false),
        stands_(publishFrame(participant_, publishing)),
        ticks_(kWaiting),
        thread_(startThread([this](const std::stop_token& stop) { publish(stop); })) {}

  // On the servo thread.
  void add(const Tick& tick) noexcept {
    constexpr double kRounding_s = 1e-9;
    if (next_s_ && tick.time_s < *next_s_ - kRounding_s) return;
    // On a grid, so that a late tick does not delay the next one, unless whole intervals were left out.
    next_s_ = next_s_ && tick.time_s < *next_s_ + least_s_ ? *next_s_ + least_s_ : tick.time_s + least_s_;
    const std::uint64_t next = added_.load(std::memory_order_relaxed);
    if (next - taken_.load(std::memory_order_acquire) == kWaiting) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    ticks_[next % kWaiting] = tick;
    added_.store(next + 1, std::memory_order_release);
  }

  Counts finish() {
    if (thread_.joinable()) {
      thread_.request_stop();
      thread_.join();
      for (const dds_entity_t writer :
           {dds_entity_t(poses_), dds_entity_t(proxies_), dds_entity_t(wrenches_), dds_entity_t(frames_)})
        dds_wait_for_acks(writer, DDS_SECS(1));
    }
    if (failure_) std::rethrow_exception(failure_);
    return {.ticks = published_, .lost = lost_.load()};
  }

 private:
  std::string topic(const char* of) const { return kRosTopics + frame_ + "/" + of; }

  void publish(const std::stop_token& stop) {
    try {
      while (true) {
        const bool isLast = stop.stop_requested();
        takeAll();
        if (isLast) return;
        std::this_thread::sleep_for(kLook);
      }
    } catch (...) {
      failure_ = std::current_exception();
    }
  }

  void takeAll() {
    const std::uint64_t begin = taken_.load(std::memory_order_relaxed), end = added_.load(std::memory_order_acquire);
    for (std::uint64_t i = begin; i < end; ++i) {
      write(ticks_[i % kWaiting]);
      taken_.store(i + 1, std::memory_order_release);
    }
  }

  void write(const Tick& tick) {
    if (!began_ns_) began_ns_ = now_ns() - static_cast<std::int64_t>(tick.time_s * 1e9);
    RosHeader header{};
    const std::int64_t time_ns = *began_ns_ + static_cast<std::int64_t>(tick.time_s * 1e9);
    setStamp(header, time_ns);
    header.frame_id = frame_.data();
    const double metres = publishing_.mm_per_unit * kMetres_per_mm;
    RosPoseStamped pose{.header = header, .pose = {}};
    put(pose.pose.position, tick.hip * metres);
    pose.pose.orientation = {tick.turn.x, tick.turn.y, tick.turn.z, tick.turn.w};
    bool isWritten = poses_.write(pose);
    isWritten = frames_.write(time_ns, tick.hip * metres, tick.turn) && isWritten;
    put(pose.pose.position, tick.proxy * metres);
    isWritten = proxies_.write(pose) && isWritten;
    RosWrenchStamped wrench{.header = header, .wrench = {}};
    put(wrench.wrench.force, tick.force_N);
    put(wrench.wrench.torque, tick.torque_mNm * 1e-3);
    isWritten = wrenches_.write(wrench) && isWritten;
    if (isWritten)
      ++published_;
    else
      lost_.fetch_add(1, std::memory_order_relaxed);
  }

  RosPublishing publishing_;
  std::string frame_;
  double least_s_;
  Participant participant_;
  RosPublisher<RosPoseStamped> poses_, proxies_;
  RosPublisher<RosWrenchStamped> wrenches_;
  RosTransformPublisher frames_;
  std::optional<RosTransformPublisher> stands_;
  std::optional<std::int64_t> began_ns_;  // wall clock at zero of the session's time
  std::uint64_t published_ = 0;
  std::exception_ptr failure_;
  // Used by the servo thread.
  std::optional<double> next_s_;
  // Shared by both threads.
  std::vector<Tick> ticks_;
  std::atomic<std::uint64_t> added_ = 0, taken_ = 0, lost_ = 0;
  std::jthread thread_;  // destroyed before all that it uses
};

RosHand::RosHand(const RosPublishing& publishing, double rate_Hz)
    : link_(std::make_unique<Link>(publishing, rate_Hz)) {}
RosHand::~RosHand() = default;

void RosHand::ticked(const TraceRow& row, const DeviceState& device) noexcept {
  link_->add({.time_s = row.time_s,
              .hip = row.hip,
              .proxy = row.proxy,
              .force_N = row.force_N,
              .torque_mNm = row.torque_mNm,
              .turn = device.turn});
}

RosHand::Counts RosHand::finish() { return link_->finish(); }

}  // namespace palpate
