#pragma once

#include <cstdint>

#include "engine/gpu/command_list.hpp"

namespace palpate {

/// Dispatches passes over lists of which the GPU alone knows how long they are. Such passes loop, so that any number of
/// workgroups comes to the end. A GPU begins an indirect dispatch some microseconds later than a direct one, and hardly
/// notices workgroups that find nothing to do; a software driver takes its time for each, and limits the rounds of one.
class CountedDispatch {
 public:
  /// What one step along the list keeps busy; a bucket is a subgroup's, too, but there are several points to one.
  enum class Step { invocation, bucket, subgroup };

  explicit CountedDispatch(const Device& device);

  /// Whether the groups that passes run with have to be counted: specialisation constant 1 of shaders that fill lists.
  std::uint32_t countsGroups() const { return direct_ ? 0 : 1; }

  /// Workgroups for a pass that shares its dispatch with another one.
  std::uint32_t sharedGroups(Step step) const;

  /// `counters`: where, at `offset`, the workgroups of an indirect dispatch stand.
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
