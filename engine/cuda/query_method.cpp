#include "engine/cuda/query_method.hpp"

#include <array>
#include <bit>

#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/resident_method.hpp"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

StepBuffers::StepBuffers(const Stream& stream, double radius, double friction, std::uint32_t points)
    : radius_(static_cast<float>(radius)),
      friction_(static_cast<float>(friction)),
      state_(1),
      gather_(1),
      runs_(shared::kPatchMaxCells),
      slots_(2 * std::size_t{kMaxSlots}),
      spill_(2 * std::size_t{kMaxSlots}),
      chunkCounts_(bruteChunks(points)) {
  state_.clear(stream);
  gather_.clear(stream);
}

StepArgs StepBuffers::argsFor(const shared::CloudView& cloud) const {
  return {.cloud = cloud,
          .message = message_.device(),
          .answer = answer_.device(),
          .report = report_.device(),
          .state = state_.data(),
          .spill = spill_.data(),
          .gather = gather_.data(),
          .runs = runs_.data(),
          .slots = slots_.data(),
          .chunkCounts = chunkCounts_.data(),
          .radius = radius_,
          .friction = friction_};
}

std::optional<shared::ContactSample> StepBuffers::sample(std::uint32_t tick) const {
  constexpr std::size_t kWords = sizeof(shared::ContactSample) / sizeof(std::uint32_t);
  const auto* from = reinterpret_cast<const volatile std::uint32_t*>(&answer_.host().sample);
  std::array<std::uint32_t, kWords> words;
  for (std::size_t i = 0; i < kWords; ++i) words[i] = from[i];
  const auto sample = std::bit_cast<shared::ContactSample>(words);
  return sample.tick == tick && sample.seal == shared::sealOf(sample) ? std::optional(sample) : std::nullopt;
}

void QueryMethod::revive() { throw CudaError("CUDA: a query ended without an answer"); }

namespace {

// Queries that are launched into the stream of the edits.
class StreamMethod : public QueryMethod {
 public:
  StreamMethod(const Stream& stream, const StepBuffers& buffers, const shared::CloudView (&views)[2])
      : stream_(stream), buffers_(buffers), args_{buffers.argsFor(views[0]), buffers.argsFor(views[1])} {}

  void ask(const shared::ContactPose& pose, unsigned parity, bool timed) override {
    timed_ = timed;
    if (timed) start_.record(stream_);
    launch(pose, parity);
  }
  bool ended() override { return stream_.idle("answering a query"); }
  double time_us() override {
    end_.synchronize("answering a query");
    return end_.since_us(start_);
  }

 protected:
  // Submits the query, or its first part; calls submitted() after the last part.
  virtual void launch(const shared::ContactPose& pose, unsigned parity) = 0;
  void submitted() {
    if (timed_) end_.record(stream_);
  }

  const Stream& stream_;
  const StepBuffers& buffers_;
  StepArgs args_[2];  // indexed by parity

 private:
  bool timed_ = false;
  Event start_, end_;
};

class BruteMethod final : public StreamMethod {
 public:
  using StreamMethod::StreamMethod;

 private:
  void launch(const shared::ContactPose& pose, unsigned parity) override {
    launchBruteGather(args_[parity], pose, stream_.get());
    launchSolve(args_[parity], pose, stream_.get());
    submitted();
  }
};

class TwoStepMethod final : public StreamMethod {
 public:
  using StreamMethod::StreamMethod;

  void advance() override {
    if (complete_ || loadAcquire(buffers_.report().sequence) != pose_.tick) return;
    launchFill(args_[parity_], buffers_.report(), stream_.get());
    launchSolve(args_[parity_], pose_, stream_.get());
    complete_ = true;
    submitted();
  }
  // Between the two steps the stream is idle, and the query has not ended.
  bool ended() override { return StreamMethod::ended() && complete_; }

 private:
  void launch(const shared::ContactPose& pose, unsigned parity) override {
    pose_ = pose;
    parity_ = parity;
    complete_ = false;
    launchPlan(args_[parity], pose, stream_.get());
  }

  shared::ContactPose pose_{};
  unsigned parity_ = 0;
  bool complete_ = true;
};

class DynamicMethod final : public StreamMethod {
 public:
  using Launch = void (*)(const StepArgs&, const shared::ContactPose&, cudaStream_t);
  DynamicMethod(Launch parent, const Stream& stream, const StepBuffers& buffers, const shared::CloudView (&views)[2])
      : StreamMethod(stream, buffers, views), parent_(parent) {
    reserveDeviceLaunches();
  }

 private:
  void launch(const shared::ContactPose& pose, unsigned parity) override {
    parent_(args_[parity], pose, stream_.get());
    submitted();
  }

  Launch parent_;
};

class FusedMethod final : public StreamMethod {
 public:
  using StreamMethod::StreamMethod;

 private:
  void launch(const shared::ContactPose& pose, unsigned parity) override {
    buffers_.message().pose = pose;
    launchFused(args_[parity], stream_.get());
    submitted();
  }
};

class GraphMethod final : public StreamMethod {
 public:
  GraphMethod(const Stream& stream, const StepBuffers& buffers, const shared::CloudView (&views)[2])
      : StreamMethod(stream, buffers, views),
        graphs_{{stream, [&] { launchFused(args_[0], stream.get()); }},
                {stream, [&] { launchFused(args_[1], stream.get()); }}} {}

 private:
  void launch(const shared::ContactPose& pose, unsigned parity) override {
    buffers_.message().pose = pose;
    graphs_[parity].launch(stream_);
    submitted();
  }

  Graph graphs_[2];
};

}  // namespace

std::unique_ptr<QueryMethod> makeQueryMethod(CudaMethod method, const Stream& stream, const StepBuffers& buffers,
                                             const shared::CloudView (&views)[2]) {
  switch (method) {
    case CudaMethod::brute:
      return std::make_unique<BruteMethod>(stream, buffers, views);
    case CudaMethod::twoStep:
      return std::make_unique<TwoStepMethod>(stream, buffers, views);
    case CudaMethod::naiveDp:
      return std::make_unique<DynamicMethod>(launchNaive, stream, buffers, views);
    case CudaMethod::arrayDp:
      return std::make_unique<DynamicMethod>(launchArray, stream, buffers, views);
    case CudaMethod::graph:
      return std::make_unique<GraphMethod>(stream, buffers, views);
    case CudaMethod::persistent:
      return std::make_unique<ResidentMethod>(buffers, views);
    case CudaMethod::fused:
      break;
  }
  return std::make_unique<FusedMethod>(stream, buffers, views);
}

}  // namespace palpate::cu
