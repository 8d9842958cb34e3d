#pragma once

#include <cstdint>

#include "engine/gpu/command_list.hpp"

namespace palpate {

/// Dispatches passes over lists whose length only the GPU knows. Such passes loop, so that any number of workgroups
/// completes the list. A GPU starts an indirect dispatch some microseconds later than a direct one, and workgroups
/// without work cost almost nothing; on a software driver each workgroup has a cost, and the iterations of one are
/// limited.
class CountedDispatch {
 public:
  /// The unit that processes one list entry; a bucket also takes a subgroup, but contains several points.
  enum class Step { invocation, bucket, subgroup };

  explicit CountedDispatch(const Device& device);

  /// Whether passes must count the workgroups of their successors: specialisation constant 1 of shaders that fill
  /// lists.
  std::uint32_t countsGroups() const { return direct_ ? 0 : 1; }

  /// Number of workgroups for a pass that shares its dispatch with another one.
  std::uint32_t sharedGroups(Step step) const;

  /// `counters`: contains, at `offset`, the workgroup counts of an indirect dispatch.
  template <class Args>
  void operator()(CommandList& list, const ComputePipeline& pipeline, Step step, const Buffer& counters,
                  std::uint64_t offset, const Args& args) const {
    if (direct_)
      list.dispatch(pipeline, std::uint64_t{workgroups(step)} * pipeline.workgroupSize(), args);
    else
      list.dispatchIndirect(pipeline, counters, args, offset);
  }

 private:
  std::uint32_t workgroups(Step step) const;

  bool direct_;
};

}  // namespace palpate
