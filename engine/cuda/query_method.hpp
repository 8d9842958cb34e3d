#pragma once

#include <memory>
#include <optional>

#include "engine/cuda/cuda_memory.hpp"
#include "engine/cuda/cuda_touch.hpp"
#include "engine/cuda/step_args.hpp"

namespace palpate::cu {

/// Buffers of the queries besides the cloud. Everything that a tick needs is allocated here.
class StepBuffers {
 public:
  StepBuffers(const Stream& stream, double radius, double friction, std::uint32_t points);

  StepArgs argsFor(const shared::CloudView& cloud) const;
  Message& message() const { return message_.host(); }
  const Answer& answer() const { return answer_.host(); }
  /// The complete answer to the pose of that tick; nullopt until it has arrived.
  std::optional<shared::ContactSample> sample(std::uint32_t tick) const;
  const PlanReport& report() const { return report_.host(); }
  const shared::ContactState* state() const { return state_.data(); }

 private:
  float radius_, friction_;
  MappedValue<Message> message_;
  MappedValue<Answer> answer_;
  MappedValue<PlanReport> report_;
  DeviceArray<shared::ContactState> state_;
  DeviceArray<Gather> gather_;
  DeviceArray<CellRun> runs_;
  DeviceArray<shared::vec4> slots_, spill_;
  DeviceArray<std::uint32_t> chunkCounts_;
};

/// Launches the query for a pose. One query at a time is in flight.
class QueryMethod {
 public:
  virtual ~QueryMethod() = default;
  QueryMethod() = default;
  QueryMethod(const QueryMethod&) = delete;
  QueryMethod& operator=(const QueryMethod&) = delete;

  /// Submits a query of the half `parity` of the cloud; its answer will contain pose.tick. `timed`: time_us() will be
  /// called.
  virtual void ask(const shared::ContactPose& pose, unsigned parity, bool timed) = 0;
  /// Does the host's part during a query; called repeatedly until the answer arrives.
  virtual void advance() {}
  /// Whether all submissions have ended. Throws the error of a failed one.
  virtual bool ended() = 0;
  /// After a query ended without an answer: submits it again, or throws.
  virtual void revive();
  /// GPU time of the last timed query, us; waits for its end.
  virtual double time_us() = 0;
  /// Releases the GPU until the next query.
  virtual void rest() {}
  /// Whether queries are ordered after earlier submissions to the stream.
  virtual bool inStreamOrder() const { return true; }
};

/// `views`: the cloud as read by queries, indexed by the front half.
std::unique_ptr<QueryMethod> makeQueryMethod(CudaMethod method, const Stream& stream, const StepBuffers& buffers,
                                             const shared::CloudView (&views)[2]);

}  // namespace palpate::cu
