#include "engine/gpu/command_list.hpp"

#include <algorithm>
#include <array>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

constexpr VkPipelineStageFlags2 kWork = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 kWrites = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags2 kReads = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT;

constexpr std::size_t kTimedPasses = 200;  // the remaining scopes of the timer are for sections
static_assert(kTimedPasses < GpuTimer::kMaxScopes);

// Additional stages and accesses of draws, on a queue with graphics.
constexpr VkPipelineStageFlags2 kDrawing =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
    VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
constexpr VkAccessFlags2 kShaders = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT;
constexpr VkAccessFlags2 kDrawingWrites =
    VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags2 kDrawingReads =
    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT;

struct Scope {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};

// All earlier commands of this list and of earlier lists.
Scope before(bool drew) { return {kWork | (drew ? kDrawing : 0), kWrites | (drew ? kDrawingWrites : 0)}; }

void memoryBarrier(const Device& device, VkCommandBuffer commands, const Scope& from, const Scope& to,
                   std::span<const VkImageMemoryBarrier2> images = {}) {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .pNext = nullptr,
                                 .srcStageMask = from.stages,
                                 .srcAccessMask = from.access,
                                 .dstStageMask = to.stages,
                                 .dstAccessMask = to.access};
  const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                              .pNext = nullptr,
                              .dependencyFlags = 0,
                              .memoryBarrierCount = 1,
                              .pMemoryBarriers = &barrier,
                              .bufferMemoryBarrierCount = 0,
                              .pBufferMemoryBarriers = nullptr,
                              .imageMemoryBarrierCount = static_cast<std::uint32_t>(images.size()),
                              .pImageMemoryBarriers = images.data()};
  device.vk().vkCmdPipelineBarrier2(commands, &info);
}

struct Layouts {
  VkImageLayout from, to;
};
VkImageMemoryBarrier2 imageBarrier(VkImage image, VkImageAspectFlags aspect, const Layouts& layouts, const Scope& from,
                                   const Scope& to) {
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
          .pNext = nullptr,
          .srcStageMask = from.stages,
          .srcAccessMask = from.access,
          .dstStageMask = to.stages,
          .dstAccessMask = to.access,
          .oldLayout = layouts.from,
          .newLayout = layouts.to,
          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .image = image,
          .subresourceRange = {
              .aspectMask = aspect, .baseMipLevel = 0, .levelCount = 1, .baseArrayLayer = 0, .layerCount = 1}};
}

// Discards the contents of the image.
VkImageMemoryBarrier2 toGeneralLayout(const Attachment& image, const Scope& from, const Scope& to) {
  return imageBarrier(image.handle(), image.aspect(), {VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL}, from, to);
}

VkRenderingAttachmentInfo target(const Attachment& image, bool clear, const VkClearValue& to) {
  return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
          .pNext = nullptr,
          .imageView = image.view(),
          .imageLayout = VK_IMAGE_LAYOUT_GENERAL,
          .resolveMode = VK_RESOLVE_MODE_NONE,
          .resolveImageView = VK_NULL_HANDLE,
          .resolveImageLayout = VK_IMAGE_LAYOUT_UNDEFINED,
          .loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
          .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
          .clearValue = to};
}

}  // namespace

GpuTimer::GpuTimer(Device& device, std::uint32_t queueFamily)
    : device_(device), ticksMask_(device.timestampMask(queueFamily)) {
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .pNext = nullptr,
                                   .flags = 0,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = 2 * kMaxScopes,
                                   .pipelineStatistics = 0};
  device.check(device.vk().vkCreateQueryPool(device.handle(), &info, nullptr, &pool_), "vkCreateQueryPool");
}

GpuTimer::~GpuTimer() { device_.vk().vkDestroyQueryPool(device_.handle(), pool_, nullptr); }

void GpuTimer::reset(VkCommandBuffer commands) {
  scopes_ = 0;
  device_.vk().vkCmdResetQueryPool(commands, pool_, 0, 2 * kMaxScopes);
}

std::uint32_t GpuTimer::open(VkCommandBuffer commands) {
  PALPATE_CHECK_LT(scopes_, kMaxScopes);
  if (ticksMask_) device_.vk().vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 2 * scopes_);
  return scopes_++;
}

void GpuTimer::close(VkCommandBuffer commands, std::uint32_t scope) {
  if (ticksMask_)
    device_.vk().vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 2 * scope + 1);
}

double GpuTimer::time_us(std::uint32_t scope) const {
  if (!ticksMask_) return 0;
  std::array<std::uint64_t, 2> ticks{};
  const VkResult result =
      device_.vk().vkGetQueryPoolResults(device_.handle(), pool_, 2 * scope, 2, sizeof(ticks), ticks.data(),
                                         sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT);
  if (result == VK_NOT_READY) return 0;
  device_.check(result, "vkGetQueryPoolResults");
  return static_cast<double>((ticks[1] - ticks[0]) & ticksMask_) * device_.timestampPeriod_ns() * 1e-3;
}

GroupGrid groupGrid(std::uint64_t groups, std::uint32_t largestAxis) {
  if (groups <= largestAxis) return {static_cast<std::uint32_t>(groups), 1};
  const std::uint64_t rows = (groups + largestAxis - 1) / largestAxis;
  if (rows > largestAxis) throw GpuError("a pass of {} workgroups is larger than a GPU grid", groups);
  return {static_cast<std::uint32_t>((groups + rows - 1) / rows), static_cast<std::uint32_t>(rows)};
}

CommandList::CommandList(Device& device, const Queue& queue, std::string name, Timing timing)
    : device_(device),
      name_(std::move(name)),
      timing_(timing),
      givesWay_(queue.policy() != QueuePolicy::latency && !device.instance().validates()) {
  const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .pNext = nullptr,
                                         .flags = 0,
                                         .queueFamilyIndex = queue.family()};
  device.check(device.vk().vkCreateCommandPool(device.handle(), &poolInfo, nullptr, &pool_), "vkCreateCommandPool");
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .pNext = nullptr,
                                         .commandPool = pool_,
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  device.check(device.vk().vkAllocateCommandBuffers(device.handle(), &info, &commands_), "vkAllocateCommandBuffers");
  device.nameObject(VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<std::uint64_t>(commands_), name_);
  if (timing_ != Timing::none) timer_ = std::make_unique<GpuTimer>(device, queue.family());
}

CommandList::~CommandList() { device_.vk().vkDestroyCommandPool(device_.handle(), pool_, nullptr); }

void CommandList::begin() {
  device_.check(device_.vk().vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
  const VkCommandBufferBeginInfo info{
      .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, .pNext = nullptr, .flags = 0, .pInheritanceInfo = nullptr};
  device_.check(device_.vk().vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
  submitted_ = false;
  drew_ = false;
  sectionTimers_.clear();
  passes_.clear();
  passTimers_.clear();
  if (timer_) timer_->reset(commands_);
  openLabel(name_);
}

void CommandList::end() {
  // Later lists wait for compute and copies, not for draws, so draws are ordered before those here.
  memoryBarrier(
      device_, commands_, before(drew_),
      {VK_PIPELINE_STAGE_2_HOST_BIT | (drew_ ? kWork : 0), VK_ACCESS_2_HOST_READ_BIT | (drew_ ? kReads | kWrites : 0)});
  closeLabel();
  device_.check(device_.vk().vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

void CommandList::orderAfterPrevious(Size size) {
  waits_ = false;
  if (independent_ == Overlap::yes) return;
  // Only passes that read their size from memory wait in the indirect stage: on an H200 that barrier takes 3.8 us, the
  // other one 1.8. The first pass of an independent scope waits for everything that any pass in it may need.
  const bool reads = size == Size::inMemory || independent_ == Overlap::first;
  if (independent_ == Overlap::first) independent_ = Overlap::yes;
  memoryBarrier(device_, commands_, before(drew_),
                {kWork | (reads ? VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT : 0),
                 kReads | kWrites | (reads ? VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT : 0)});
  drew_ = false;
  waits_ = true;
}

void CommandList::orderDraw(const DrawTargets& targets) {
  PALPATE_CHECK(independent_ == Overlap::no);
  const Scope from = before(drew_), to{kDrawing, kShaders | kDrawingReads | kDrawingWrites};
  std::vector<VkImageMemoryBarrier2> cleared;
  if (targets.clearDepth) cleared.push_back(toGeneralLayout(*targets.depth, from, to));
  for (const Attachment* color : targets.colors)
    if (targets.clearColors) cleared.push_back(toGeneralLayout(*color, from, to));
  memoryBarrier(device_, commands_, from, to, cleared);
  drew_ = true;
  waits_ = true;
}

void CommandList::dispatchBytes(const ComputePipeline& pipeline, std::uint64_t threads, std::span<const std::byte> args,
                                VkDescriptorSet images) {
  if (threads == 0) return;
  PALPATE_CHECK_EQ(images != VK_NULL_HANDLE, pipeline.imageLayout() != VK_NULL_HANDLE);
  const std::uint64_t size = pipeline.workgroupSize(), groups = (threads + size - 1) / size;
  const std::uint32_t largestAxis = device_.properties().limits.maxComputeWorkGroupCount[0];
  const std::uint64_t slice = std::max(pipeline.sliceThreads() / size, (groups + kMaxSlices - 1) / kMaxSlices);
  const bool slices =
      givesWay_ && device_.hasUrgentWork() && independent_ == Overlap::no && groups > slice && slice <= largestAxis;
  const GroupGrid grid =
      slices ? GroupGrid{static_cast<std::uint32_t>(slice), static_cast<std::uint32_t>((groups + slice - 1) / slice)}
             : groupGrid(groups, largestAxis);
  orderAfterPrevious(Size::known);
  openPass(pipeline.name(), threads, args.size());
  bind(pipeline, args);
  if (images)
    device_.vk().vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout(), 1, 1, &images, 0,
                                         nullptr);
  device_.vk().vkCmdDispatch(commands_, grid.x, slices ? 1 : grid.y, 1);
  for (std::uint32_t row = 1; slices && row < grid.y; ++row) {
    orderAfterPrevious(Size::known);
    device_.vk().vkCmdDispatchBase(commands_, 0, row, 0, grid.x, 1, 1);
  }
  closePass();
}

void CommandList::dispatchIndirectBytes(const ComputePipeline& pipeline, const Buffer& groups,
                                        std::span<const std::byte> args, std::uint64_t offset) {
  PALPATE_CHECK_LE(offset + sizeof(VkDispatchIndirectCommand), groups.bytes());
  orderAfterPrevious(Size::inMemory);
  openPass(pipeline.name(), 0, args.size());
  bind(pipeline, args);
  device_.vk().vkCmdDispatchIndirect(commands_, groups.handle(), offset);
  closePass();
}

void CommandList::drawBytes(const GraphicsPipeline& pipeline, const DrawTargets& targets, std::uint32_t vertices,
                            std::span<const std::byte> args) {
  PALPATE_CHECK_EQ(args.size(), pipeline.pushBytes());
  PALPATE_CHECK_EQ(targets.colors.size(), pipeline.colors());
  PALPATE_CHECK(targets.depth != nullptr);
  std::vector<VkRenderingAttachmentInfo> colors;
  for (const Attachment* color : targets.colors)
    colors.push_back(target(*color, targets.clearColors, {.color = {.float32 = {0, 0, 0, 0}}}));
  const VkRenderingAttachmentInfo depth = target(*targets.depth, targets.clearDepth, {.depthStencil = {1, 0}});
  const UVec2 size = targets.depth->size_px();
  const VkRect2D area{.offset = {0, 0}, .extent = {size.x, size.y}};
  const VkViewport viewport{0, 0, static_cast<float>(size.x), static_cast<float>(size.y), 0, 1};
  const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                             .pNext = nullptr,
                             .flags = 0,
                             .renderArea = area,
                             .layerCount = 1,
                             .viewMask = 0,
                             .colorAttachmentCount = static_cast<std::uint32_t>(colors.size()),
                             .pColorAttachments = colors.data(),
                             .pDepthAttachment = &depth,
                             .pStencilAttachment = nullptr};
  orderDraw(targets);
  openPass(pipeline.name(), vertices, args.size());
  device_.vk().vkCmdBeginRendering(commands_, &info);
  if (vertices > 0) {
    device_.vk().vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.handle());
    device_.vk().vkCmdSetViewport(commands_, 0, 1, &viewport);
    device_.vk().vkCmdSetScissor(commands_, 0, 1, &area);
    device_.vk().vkCmdPushConstants(commands_, pipeline.layout(), GraphicsPipeline::kStages, 0, pipeline.pushBytes(),
                                    args.data());
    if (pipeline.readsBlock()) bindBlock(VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.layout());
    device_.vk().vkCmdDraw(commands_, vertices, 1, 0, 0);
  }
  device_.vk().vkCmdEndRendering(commands_);
  closePass();
}

void CommandList::use(const ConstantBlock& block, std::uint32_t slot) {
  block_ = block.handle();
  blockOffset_ = block.offset(slot);
}

void CommandList::bindBlock(VkPipelineBindPoint at, VkPipelineLayout layout) {
  PALPATE_CHECK(block_ != VK_NULL_HANDLE);
  device_.vk().vkCmdBindDescriptorSets(commands_, at, layout, 0, 1, &block_, 1, &blockOffset_);
}

void CommandList::bind(const ComputePipeline& pipeline, std::span<const std::byte> args) {
  PALPATE_CHECK_EQ(args.size(), pipeline.pushBytes());
  device_.vk().vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle());
  device_.vk().vkCmdPushConstants(commands_, pipeline.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, pipeline.pushBytes(),
                                  args.data());
  if (pipeline.readsBlock()) bindBlock(VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout());
}

void CommandList::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t fromOffset,
                       std::uint64_t toOffset) {
  if (bytes == 0) return;
  PALPATE_CHECK_LE(fromOffset + bytes, from.bytes());
  PALPATE_CHECK_LE(toOffset + bytes, to.bytes());
  orderAfterPrevious(Size::known);
  openPass("copy " + from.name(), 0, bytes);
  const VkBufferCopy region{fromOffset, toOffset, bytes};
  device_.vk().vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
  closePass();
}

void CommandList::show(const Buffer& picture, VkImage image, const UVec2& size_px) {
  PALPATE_CHECK_LE(std::uint64_t{4} * size_px.x * size_px.y, picture.bytes());
  PALPATE_CHECK(independent_ == Overlap::no);
  constexpr Scope kCopies{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
  const std::array taken{imageBarrier(image, VK_IMAGE_ASPECT_COLOR_BIT,
                                      {VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL},
                                      {kCopies.stages, 0}, kCopies)};
  memoryBarrier(device_, commands_, before(drew_), {kWork, kReads | kWrites}, taken);
  drew_ = false;
  waits_ = true;
  openPass("show " + picture.name(), 0, std::uint64_t{4} * size_px.x * size_px.y);
  const VkBufferImageCopy region{.bufferOffset = 0,
                                 .bufferRowLength = 0,
                                 .bufferImageHeight = 0,
                                 .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
                                                      .mipLevel = 0,
                                                      .baseArrayLayer = 0,
                                                      .layerCount = 1},
                                 .imageOffset = {0, 0, 0},
                                 .imageExtent = {size_px.x, size_px.y, 1}};
  device_.vk().vkCmdCopyBufferToImage(commands_, picture.handle(), image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                                      &region);
  closePass();
  const std::array given{imageBarrier(image, VK_IMAGE_ASPECT_COLOR_BIT,
                                      {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR}, kCopies,
                                      {VK_PIPELINE_STAGE_2_NONE, 0})};
  memoryBarrier(device_, commands_, {kWork, kWrites}, {kWork, kReads | kWrites}, given);
}

void CommandList::fill(const Buffer& buffer, std::uint32_t pattern, std::uint64_t bytes, std::uint64_t offset) {
  if (bytes == 0) return;
  PALPATE_CHECK_LE(offset + bytes, buffer.bytes());
  orderAfterPrevious(Size::known);
  openPass("fill " + buffer.name(), 0, bytes);
  device_.vk().vkCmdFillBuffer(commands_, buffer.handle(), offset, bytes, pattern);
  closePass();
}

void CommandList::openPass(const std::string& name, std::uint64_t threads, std::uint64_t bytes) {
  passes_.push_back({.section = section_, .name = name, .threads = threads, .bytes = bytes, .waits = waits_});
  openLabel(name);
  if (timing_ == Timing::passes && passes_.size() <= kTimedPasses) passTimers_.push_back(timer_->open(commands_));
}

void CommandList::closePass() {
  if (passTimers_.size() == passes_.size()) timer_->close(commands_, passTimers_.back());
  closeLabel();
}

void CommandList::openLabel(const std::string& name) {
  if (!device_.instance().hasDebugUtils()) return;
  const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                   .pNext = nullptr,
                                   .pLabelName = name.c_str(),
                                   .color = {0, 0, 0, 0}};
  vkCmdBeginDebugUtilsLabelEXT(commands_, &label);
}

void CommandList::closeLabel() {
  if (device_.instance().hasDebugUtils()) vkCmdEndDebugUtilsLabelEXT(commands_);
}

CommandList::Section::Section(CommandList& list, const std::string& name) : list_(list), outer_(list.section_) {
  list_.section_ = outer_.empty() ? name : outer_ + "/" + name;
  list_.openLabel(name);
  if (list_.timing_ == Timing::passes || (list_.timing_ == Timing::sections && outer_.empty())) {
    timer_ = list_.timer_->open(list_.commands_);
    list_.sectionTimers_.emplace_back(list_.section_, *timer_);
  }
}

CommandList::Section::~Section() {
  if (timer_) list_.timer_->close(list_.commands_, *timer_);
  list_.closeLabel();
  list_.section_ = outer_;
}

double CommandList::sectionTime_us(std::string_view name) const {
  if (!submitted_) return 0;
  for (const auto& [section, timer] : sectionTimers_)
    if (section == name) return timer_->time_us(timer);
  return 0;
}

std::vector<PassRecord> CommandList::passes() const {
  std::vector<PassRecord> passes = passes_;
  for (std::size_t i = 0; submitted_ && i < passTimers_.size(); ++i) passes[i].gpu_us = timer_->time_us(passTimers_[i]);
  return passes;
}

}  // namespace palpate
