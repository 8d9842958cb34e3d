#pragma once

#include <memory>
#include <optional>

#include "engine/cuda/cuda_memory.hpp"
#include "engine/cuda/cuda_touch.hpp"
#include "engine/cuda/step_args.hpp"

namespace palpate::cu {

/// What the queries read and write besides the cloud. Everything a tick needs is taken here.
class StepBuffers {
 public:
  StepBuffers(const Stream& stream, double radius, double friction, std::uint32_t points);

  StepArgs argsFor(const shared::CloudView& cloud) const;
  Message& message() const { return message_.host(); }
  const Answer& answer() const { return answer_.host(); }
  /// The answer to the pose of that tick, once it is there, whole.
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

/// How a pose becomes launches. One query is out at a time.
class QueryMethod {
 public:
  virtual ~QueryMethod() = default;
  QueryMethod() = default;
  QueryMethod(const QueryMethod&) = delete;
  QueryMethod& operator=(const QueryMethod&) = delete;

  /// Submits a query of the half `parity` of the cloud; its answer will carry pose.tick. `timed`: time_us()
  /// will be asked for.
  virtual void ask(const shared::ContactPose& pose, unsigned parity, bool timed) = 0;
  /// Does what the host has to do in the middle of a query; called again and again until the answer is there.
  virtual void advance() {}
  /// Whether all that was submitted has ended. Throws the error of what failed.
  virtual bool ended() = 0;
  /// After a query ended without an answer: submits it anew, or throws.
  virtual void revive();
  /// GPU time of the last timed query, us; waits for its end.
  virtual double time_us() = 0;
  /// Leaves the GPU alone until the next query.
  virtual void rest() {}
  /// Whether queries see by themselves what was submitted to the stream before them.
  virtual bool inStreamOrder() const { return true; }
};

/// `views`: what queries read, by the half of the cloud that counts.
std::unique_ptr<QueryMethod> makeQueryMethod(CudaMethod method, const Stream& stream, const StepBuffers& buffers,
                                             const shared::CloudView (&views)[2]);

}  // namespace palpate::cu
