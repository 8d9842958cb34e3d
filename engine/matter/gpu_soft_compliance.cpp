#include "engine/matter/gpu_soft_compliance.hpp"

#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/matter/matter_pipeline.hpp"
#include "shaders/shared/soft_descent.h"
#include "shaders/simulation.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kRoundsAtOnce = 20;  // even, so that the list can be repeated
constexpr std::uint32_t kMaxRounds = 300;
constexpr double kLeft = 1e-3;  // tolerance of the residual; the relative error of the compliance is its square

double sumOf(const Buffer& read, std::uint32_t row, std::uint32_t blocks) {
  double sum = 0;
  for (const Vec4& part : read.mapped<Vec4>().subspan(std::size_t{row} * blocks, blocks))
    sum += static_cast<double>(part.x);
  return sum;
}

}  // namespace

GpuSoftCompliance::GpuSoftCompliance(Device& device, Queue& queue, const SoftMemory& memory, const SoftSizes& sizes,
                                     double hold_1_s2)
    : device_(device),
      queue_(queue),
      memory_(memory),
      sizes_(sizes),
      way_(matterPipeline<shared::SoftDescentArgs>(device, shader_code::matter_soft_way)),
      trial_(matterPipeline<shared::SoftDescentArgs>(device, shader_code::matter_soft_trial)),
      cells_(SoftPasses::trialPass(device, sizes)),
      answer_(matterPipeline<shared::SoftDescentArgs>(device, shader_code::matter_soft_answer)),
      descend_(matterPipeline<shared::SoftDescentArgs>(device, shader_code::matter_soft_descend)),
      trialNodes_(softBuffer<Vec4>(device, std::uint64_t{shared::kNodeVec4s} * sizes.nodes, "trial")),
      load_(softBuffer<Vec4>(device, sizes.nodes, "load")),
      vectors_(softBuffer<Vec4>(device, std::uint64_t{shared::kDescentVectors} * sizes.nodes, "descent")),
      sums_(softBuffer<Vec4>(device, std::uint64_t{shared::kDescentRows} * sizes.nodeBlocks(), "descent sums")),
      sumsRead_(Buffer::of<Vec4>(device, std::uint64_t{shared::kDescentRows} * sizes.nodeBlocks(), Memory::readback,
                                 "soft descent sums read")),
      begin_(device, queue, "soft descent begins"),
      rounds_(device, queue, "descent") {
  record(hold_1_s2);
}

std::uint64_t GpuSoftCompliance::bytes() const {
  return trialNodes_.bytes() + load_.bytes() + vectors_.bytes() + sums_.bytes() + sumsRead_.bytes();
}

void GpuSoftCompliance::record(double hold_1_s2) {
  const shared::SoftDescentArgs args{.setting = memory_.setting.address(),
                                     .nodes = memory_.nodes.address(),
                                     .trial = trialNodes_.address(),
                                     .load = load_.address(),
                                     .vectors = vectors_.address(),
                                     .sums = sums_.address(),
                                     .incident = memory_.incident.address(),
                                     .forces = memory_.forces.address(),
                                     .nodeCount = sizes_.nodes,
                                     .stride = sizes_.stride,
                                     .blocks = sizes_.nodeBlocks(),
                                     .round = 1,
                                     .begins = 1,
                                     .sign = 1,
                                     .hold = static_cast<float>(hold_1_s2),
                                     .unused = 0};
  begin_.begin();
  begin_.fill(sums_, 0, sums_.bytes());
  begin_.dispatch(descend_, sizes_.nodes, args);
  begin_.copy(sums_, sumsRead_, sums_.bytes());
  begin_.end();
  rounds_.begin();
  for (std::uint32_t round = 0; round < kRoundsAtOnce; ++round) {
    shared::SoftDescentArgs now = args;
    now.round = round;
    now.begins = 0;
    rounds_.dispatch(way_, sizes_.nodes, now);
    for (const float sign : {1.0f, -1.0f}) {
      now.sign = sign;
      rounds_.dispatch(trial_, sizes_.nodes, now);
      SoftPasses::recordTrial(rounds_, cells_, memory_, sizes_, trialNodes_.address());
      rounds_.dispatch(answer_, sizes_.nodes, now);
    }
    rounds_.dispatch(descend_, sizes_.nodes, now);
  }
  rounds_.copy(sums_, sumsRead_, sums_.bytes());
  rounds_.end();
}

double GpuSoftCompliance::give(const std::vector<Vec4>& load) {
  upload(device_, queue_, load_, load);
  queue_.run(begin_);
  const std::uint32_t blocks = sizes_.nodeBlocks();
  const double begin = sumOf(sumsRead_, shared::kLeftRow, blocks);
  if (!(begin > 0)) return 0;
  double left = begin;
  for (std::uint32_t done = 0; done < kMaxRounds && left > kLeft * kLeft * begin; done += kRoundsAtOnce) {
    queue_.run(rounds_);
    left = sumOf(sumsRead_, shared::kLeftRow, blocks);
  }
  return sumOf(sumsRead_, shared::kMovedRow, blocks);
}

}  // namespace palpate
