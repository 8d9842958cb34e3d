// Recording of GPU work: the only file with raw barriers.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/core/pass_record.hpp"
#include "engine/gpu/attachment.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/constant_block.hpp"
#include "engine/gpu/graphics_pipeline.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

/// Pairs of GPU timestamps. Scopes are numbered in the order of recording; their times can be read once the commands
/// have run. If a queue family has no timestamps, every time is 0.
class GpuTimer {
 public:
  static constexpr std::uint32_t kMaxScopes = 256;

  GpuTimer(Device& device, std::uint32_t queueFamily);
  ~GpuTimer();
  GpuTimer(const GpuTimer&) = delete;
  GpuTimer& operator=(const GpuTimer&) = delete;

  void reset(VkCommandBuffer commands);
  std::uint32_t open(VkCommandBuffer commands);
  void close(VkCommandBuffer commands, std::uint32_t scope);
  /// 0 if the scope has not run yet.
  double time_us(std::uint32_t scope) const;

 private:
  Device& device_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  std::uint64_t ticksMask_;  // the valid bits of this queue family's timestamps; 0: none
  std::uint32_t scopes_ = 0;
};

class Device;
class Queue;

/// Targets of a draw: images of one size, colours in the order of the pipeline's formats.
struct DrawTargets {
  std::vector<const Attachment*> colors;
  const Attachment* depth = nullptr;
  bool clearColors = false;  ///< to 0 first; otherwise they keep the results of earlier draws of this list
  bool clearDepth = false;   ///< to 1, likewise
};

/// A command buffer with automatic barriers: each command sees all earlier ones in this list and in lists submitted
/// earlier to the same queue. Inside an `independent` scope commands may overlap each other. Recorded once between
/// begin() and end(); may be submitted repeatedly, but never while it is still running.
///
/// On a throughput or background queue it yields to other queues: their work waits until a dispatch in progress has
/// started all of its workgroups, however short these are and regardless of priorities (seen on an H200). Long
/// dispatches recorded while there is urgent work (Device::hasUrgentWork) are therefore split into slices.
class CommandList {
 public:
  /// The timed parts: none; outermost sections; every section and pass. Each timestamp pair delays the GPU by 1.3 us on
  /// an H200.
  enum class Timing { none, sections, passes };

  CommandList(Device& device, const Queue& queue, std::string name, Timing timing = Timing::none);
  ~CommandList();
  CommandList(const CommandList&) = delete;
  CommandList& operator=(const CommandList&) = delete;

  void begin();
  void end();

  /// Passes that read a block read this slot of this one from now on; it must outlive the runs of this list.
  void use(const ConstantBlock& block, std::uint32_t slot);

  /// Runs at least `threads` invocations; `args` become the push constants. Zero threads record nothing.
  template <class Args>
  void dispatch(const ComputePipeline& pipeline, std::uint64_t threads, const Args& args) {
    static_assert(std::is_trivially_copyable_v<Args> && sizeof(Args) <= kMaxPushBytes);
    dispatchBytes(pipeline, threads, std::as_bytes(std::span(&args, 1)));
  }
  /// The same for a pipeline that reads images.
  template <class Args>
  void dispatch(const ComputePipeline& pipeline, std::uint64_t threads, const Args& args, const ImageReads& images) {
    static_assert(std::is_trivially_copyable_v<Args> && sizeof(Args) <= kMaxPushBytes);
    dispatchBytes(pipeline, threads, std::as_bytes(std::span(&args, 1)), images.handle());
  }
  /// The same for a number of workgroups that an earlier pass wrote: three uint32 (x, y, z), `offset` bytes into
  /// `groups`.
  template <class Args>
  void dispatchIndirect(const ComputePipeline& pipeline, const Buffer& groups, const Args& args,
                        std::uint64_t offset = 0) {
    static_assert(std::is_trivially_copyable_v<Args> && sizeof(Args) <= kMaxPushBytes);
    dispatchIndirectBytes(pipeline, groups, std::as_bytes(std::span(&args, 1)), offset);
  }
  /// Draws on a queue with graphics; not within an `independent` scope. Zero vertices only clear.
  template <class Args>
  void draw(const GraphicsPipeline& pipeline, const DrawTargets& targets, std::uint32_t vertices, const Args& args) {
    static_assert(std::is_trivially_copyable_v<Args> && sizeof(Args) <= kMaxPushBytes);
    drawBytes(pipeline, targets, vertices, std::as_bytes(std::span(&args, 1)));
  }
  void copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t fromOffset = 0,
            std::uint64_t toOffset = 0);
  /// Copies a picture, 4 bytes a pixel in rows from the top, to a whole swapchain image, and transitions it for
  /// presentation.
  void show(const Buffer& picture, VkImage image, const UVec2& size_px);
  /// Fills with a 32-bit pattern; `bytes` is a multiple of 4.
  void fill(const Buffer& buffer, std::uint32_t pattern, std::uint64_t bytes, std::uint64_t offset = 0);

  /// A named part of the list: a debug label and, with timing, a time.
  class Section {
   public:
    Section(CommandList& list, const std::string& name);
    ~Section();
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;

   private:
    CommandList& list_;
    std::string outer_;
    std::optional<std::uint32_t> timer_;
  };
  [[nodiscard]] Section section(const std::string& name) { return Section(*this, name); }

  /// While it lives, commands after the first do not wait for each other.
  class Independent {
   public:
    explicit Independent(CommandList& list) : list_(list) { list_.independent_ = Overlap::first; }
    ~Independent() { list_.independent_ = Overlap::no; }
    Independent(const Independent&) = delete;
    Independent& operator=(const Independent&) = delete;

   private:
    CommandList& list_;
  };
  [[nodiscard]] Independent independent() { return Independent(*this); }

  VkCommandBuffer handle() const { return commands_; }
  /// Called by the queue; before the first submission there are no times to read.
  void noteSubmission() const { submitted_ = true; }
  /// Time of a section in the last completed run, us; 0 if it was not timed.
  double sectionTime_us(std::string_view name) const;
  /// The recorded commands, in order, with the times of the last completed run.
  std::vector<PassRecord> passes() const;

 private:
  // Maximum number of consecutive slices of one dispatch of a yielding list.
  static constexpr std::uint64_t kMaxSlices = 1024;

  enum class Overlap { no, first, yes };
  enum class Size { known, inMemory };  // of a pass that is being recorded

  void dispatchBytes(const ComputePipeline& pipeline, std::uint64_t threads, std::span<const std::byte> args,
                     VkDescriptorSet images = VK_NULL_HANDLE);
  void drawBytes(const GraphicsPipeline& pipeline, const DrawTargets& targets, std::uint32_t vertices,
                 std::span<const std::byte> args);
  void dispatchIndirectBytes(const ComputePipeline& pipeline, const Buffer& groups, std::span<const std::byte> args,
                             std::uint64_t offset);
  void bind(const ComputePipeline& pipeline, std::span<const std::byte> args);
  void bindBlock(VkPipelineBindPoint at, VkPipelineLayout layout);
  void orderAfterPrevious(Size size);
  void orderDraw(const DrawTargets& targets);
  void openPass(const std::string& name, std::uint64_t threads, std::uint64_t bytes);
  void closePass();
  void openLabel(const std::string& name);
  void closeLabel();

  Device& device_;
  std::string name_;
  Timing timing_;
  bool givesWay_;  // disabled under validation: the layer of Debian 12 does not support dispatches with a base
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  std::unique_ptr<GpuTimer> timer_;
  Overlap independent_ = Overlap::no;
  bool drew_ = false;                       // since the last barrier
  bool waits_ = false;                      // the command being recorded is preceded by a barrier
  VkDescriptorSet block_ = VK_NULL_HANDLE;  // in use
  std::uint32_t blockOffset_ = 0;
  std::string section_;
  std::vector<std::pair<std::string, std::uint32_t>> sectionTimers_;
  std::vector<PassRecord> passes_;
  std::vector<std::uint32_t> passTimers_;  // of the first passes
  mutable bool submitted_ = false;
};

/// Two-dimensional grid for `groups` workgroups: if they exceed the limit of one axis a second one is used. Shaders
/// undo this with workgroupIndex() of lib/index.glsl. Throws GpuError if two axes are not enough.
struct GroupGrid {
  std::uint32_t x, y;
};
GroupGrid groupGrid(std::uint64_t groups, std::uint32_t largestAxis);

}  // namespace palpate
