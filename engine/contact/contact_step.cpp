#include "engine/contact/contact_step.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/clocked.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// Number of a patch's points that do not fit into a workgroup's shared memory.
std::uint64_t spilledPoints(std::uint64_t points, std::uint32_t held) {
  const std::uint64_t most = std::min<std::uint64_t>(points, shared::kMaxPatchPoints);
  return most - std::min<std::uint64_t>(most, held);
}

// Number of a patch's points in shared memory: 24 bytes each, and 4 for the id of a moving one, beside some 6 KiB for
// everything else. The remaining points stay in global memory, with bitwise identical results.
std::uint32_t sharedPatch(const Device& device, bool pointsMove) {
  constexpr std::uint32_t kPointBytes = 24, kIdBytes = 4, kElse = 6 * 1024, kStep = 128;
  const std::uint32_t bytes = kPointBytes + (pointsMove ? kIdBytes : 0);
  const std::uint32_t room = (sharedBytes(device) - kElse) / bytes / kStep * kStep;
  return std::min(room, shared::kMaxSharedPatch);
}

// Number of polls for its question by a waiting step: some 20 ms on a GPU. A software driver needs our cores for it,
// and silently stops a shader after 65,535 rounds; GPU-assisted validation adds rounds at each access.
std::uint32_t pollsOn(Device& device) {
  if (device.instance().validates()) return 50;
  return device.isCpu() ? 2'000 : 30'000;
}

// The forms of the fused step that a session may need. The answer before a tick determines its form, except for cells
// so small that one workgroup would need many rounds for them.
std::vector<std::uint32_t> fusedForms(const ContactOptions& options, std::uint32_t cells) {
  if (options.probes > 1) return {shared::kGatherAlone};
  if (options.split) return {*options.split ? shared::kGatherSplit : shared::kGatherAlone};
  if (cells >= shared::kSplitCells) return {shared::kGatherSplit};
  return {shared::kGatherAlone, shared::kGatherSplit};
}

constexpr std::size_t kLineWords = 16;  // of a processor's cache

// A head and the questions, in whole lines.
std::size_t questionBytes(std::uint32_t probes) {
  constexpr std::size_t kLineBytes = kLineWords * sizeof(std::uint32_t);
  const std::size_t bytes = sizeof(shared::QuestionHead) + probes * sizeof(shared::ContactQuestion);
  return (bytes + kLineBytes - 1) / kLineBytes * kLineBytes;
}

// Two slots per probe for each point that does not fit into shared memory. Several probes have room for the points of
// one round-limited gather, a single probe for the largest possible gather.
std::uint32_t spillSlots(const Device& device, const ContactOptions& options, std::uint32_t cells,
                         std::uint64_t points) {
  std::uint64_t most = points;
  if (options.probes > 1)
    most = std::min<std::uint64_t>(points, std::uint64_t{gatherRounds(cells)} * shared::kPatchRoundCandidates);
  return 2 * static_cast<std::uint32_t>(spilledPoints(most, sharedPatch(device, options.pointsMove)));
}

PipelineOptions stepOptions(const Device& device, const ContactOptions& options) {
  return {.workgroupSize = shared::kContactWorkgroup,
          .pushBytes = sizeof(shared::ContactStepArgs),
          .constants = {static_cast<std::uint32_t>(options.surface), options.localRadius ? VK_TRUE : VK_FALSE,
                        std::bit_cast<std::uint32_t>(static_cast<float>(options.friction)),
                        options.probes > 1 ? VK_TRUE : VK_FALSE,
                        std::bit_cast<std::uint32_t>(static_cast<float>(options.widening)),
                        sharedPatch(device, options.pointsMove), options.pointsMove ? VK_TRUE : VK_FALSE,
                        options.normalsTurn ? VK_TRUE : VK_FALSE}};
}

}  // namespace

double smallestCell(double radius) {
  // A gather spans 2 (1 + slack) radii, and one cell more for its offset within the cells.
  const double cellsPerSide = std::floor(std::cbrt(shared::kPatchMaxCells)) - 1.0;
  return 1.01 * 2.0 * (1.0 + static_cast<double>(shared::kPatchSlack)) * radius / cellsPerSide;
}

ContactStep::ContactStep(Device& device, const ContactOptions& options, const HashGrid& grid, std::uint32_t points)
    : options_(options),
      cells_(cellsPerGather(grid, options.radius)),
      spillSlots_(spillSlots(device, options, cells_, points)),
      gather_(makeGather(device, options.method, grid, options.radius, points)),
      forms_(fusedForms(options, cells_)),
      step_(device, shader_code::contact_contact_step, stepOptions(device, options)),
      await_(device, shader_code::contact_await_question,
             {.workgroupSize = options.probes > 1 ? shared::kContactWorkgroup : std::max(32u, device.subgroupSize()),
              .pushBytes = sizeof(shared::AwaitQuestionArgs)}),
      put_(questionBytes(options.probes) / sizeof(std::uint32_t)),
      pose_(device, questionBytes(options.probes), Memory::upload, "contact pose"),
      taken_(device, questionBytes(options.probes), Memory::device, "questions taken"),
      state_(Buffer::of<shared::ContactState>(device, options.probes, Memory::device, "contact state")),
      sample_(device, sizeof(shared::StepTicks) + options.probes * sizeof(shared::ContactSample), Memory::readback,
              "contact sample"),
      spill_(Buffer::of<Vec4>(device, std::uint64_t{spillSlots_} * options.probes, Memory::device, "patch spill")),
      patch_(makeGatheredPatch(
          device, gather_ ? gather_->slots() : std::uint64_t{gatherRounds(cells_)} * shared::kPatchRoundCandidates)) {
  PALPATE_CHECK_LT(0.0, options.radius);
  PALPATE_CHECK_LE(1u, options.probes);
  PALPATE_CHECK(options.probes == 1 || !gather_);
  PALPATE_CHECK_LE(smallestCell(options.radius) * static_cast<double>(grid.inverseCell), 1.0 + 1e-5);
  if (waitsAlone(waiting(0)))
    waiting_.emplace(device,
                     device.hasClock() ? shader_code::clocked_contact_waiting_step : shader_code::contact_waiting_step,
                     stepOptions(device, options));
  upload(device, state_, std::vector<shared::ContactState>(options.probes));
  write(offsetof(shared::QuestionHead, polls) / sizeof(std::uint32_t), std::array{pollsOn(device)});
  for (std::uint32_t probe = 0; probe < options.probes; ++probe) put({}, probe);
  std::ranges::fill(sample_.mapped<std::uint32_t>(), 0);
}

std::uint32_t ContactStep::lists() const {
  if (gather_) return gather_->submissions();
  return (canWait() ? 2 : 1) * static_cast<std::uint32_t>(forms_.size());
}

void ContactStep::record(CommandList& commands, std::uint32_t list, const shared::CloudView& cloud,
                         DeviceAddress logHead, DeviceAddress velocities) const {
  PALPATE_CHECK(velocities != 0 || !options_.pointsMove);
  const shared::ContactStepArgs args{.cloud = cloud, .logHead = logHead, .velocities = velocities};
  const bool awaitsFirst = waits(list) && !waitsAlone(list);
  if (awaitsFirst) recordAwait(commands);
  const auto section = commands.section("contact");
  if (waitsAlone(list)) return recordSolve(commands, *waiting_, args, pose_, shared::kGatherAlone);
  if (!gather_) return recordSolve(commands, step_, args, awaitsFirst ? taken_ : pose_, forms_[list % forms_.size()]);
  {
    const auto gathering = commands.section("gather");
    gather_->record(commands, list,
                    {.cloud = cloud,
                     .pose = pose_.address(),
                     .state = state_.address(),
                     .patch = patch_.address(),
                     .radius = static_cast<float>(options_.radius)});
  }
  if (list + 1 < gather_->submissions()) return;
  const auto solving = commands.section("solve");
  recordSolve(commands, step_, args, pose_, shared::kGatherGiven);
}

void ContactStep::recordAwait(CommandList& commands) const {
  commands.dispatch(
      await_, await_.workgroupSize(),
      shared::AwaitQuestionArgs{.question = pose_.address(), .taken = taken_.address(), .probes = options_.probes});
}

void ContactStep::withdraw(std::uint32_t tick) {
  for (std::uint32_t probe = 0; probe < options_.probes; ++probe)
    put({.pose = {.hip = Vec3(0), .tick = tick}, .withdrawn = 1}, probe);
}

void ContactStep::put(shared::ContactQuestion question, std::uint32_t probe) {
  constexpr std::size_t kWords = sizeof(shared::ContactQuestion) / sizeof(std::uint32_t);
  static_assert(kWords == shared::kQuestionWords);
  auto words = std::bit_cast<std::array<std::uint32_t, kWords>>(question);
  words[shared::kQuestionSealAt] = 0;
  for (std::uint32_t i = 0; canWait() && i < shared::kQuestionSealAt; ++i)
    words[shared::kQuestionSealAt] += shared::questionShare(words[i], i);
  write(shared::kQuestionHeadWords + std::size_t{probe} * kWords, words);
  question_ = question.pose;
}

void ContactStep::write(std::size_t first, std::span<const std::uint32_t> words) {
  // A waiting GPU may be polling: no word is changed but to its new value, and the fence flushes the processor's write
  // buffers. Whole lines, since a part of one crosses the bus in pieces.
  std::ranges::copy(words, put_.begin() + static_cast<std::ptrdiff_t>(first));
  volatile std::uint32_t* to = pose_.mapped<std::uint32_t>().data();
  const std::size_t end = (first + words.size() + kLineWords - 1) / kLineWords * kLineWords;
  for (std::size_t i = first / kLineWords * kLineWords; i < end; ++i) to[i] = put_[i];
  if (canWait()) std::atomic_thread_fence(std::memory_order_seq_cst);
}

void ContactStep::recordSolve(CommandList& commands, const ComputePipeline& step, const shared::ContactStepArgs& args,
                              const Buffer& pose, std::uint32_t gather) const {
  const std::uint32_t workgroups = gather == shared::kGatherSplit ? shared::kSplitWorkgroups : options_.probes;
  commands.dispatch(step, workgroups * shared::kContactWorkgroup,
                    shared::ContactStepArgs{.cloud = args.cloud,
                                            .pose = pose.address(),
                                            .state = state_.address(),
                                            .result = sample_.address(),
                                            .spill = spill_.address(),
                                            .logHead = args.logHead,
                                            .gathered = patch_.address(),
                                            .velocities = args.velocities,
                                            .radius = static_cast<float>(options_.radius),
                                            .gather = gather,
                                            .mostCells = cells_,
                                            .spillSlots = spillSlots_});
}

std::uint64_t ContactStep::predictedBytes(std::uint64_t points) {
  constexpr std::uint64_t kPerPoint = 2 * sizeof(Vec4);  // position and normal
  return kPerPoint * (spilledPoints(points, shared::kMaxSharedPatch) + shared::kPatchRoundCandidates);
}

shared::ContactSample ContactStep::sample(std::uint32_t probe) const {
  // The GPU may write while this reads: every word is read once, from memory.
  constexpr std::size_t kWords = sizeof(shared::ContactSample) / sizeof(std::uint32_t);
  static_assert(kWords == shared::kSampleWords && sizeof(shared::StepTicks) % sizeof(std::uint32_t) == 0);
  const volatile std::uint32_t* from = sample_.mapped<const std::uint32_t>().data() +
                                       sizeof(shared::StepTicks) / sizeof(std::uint32_t) + std::size_t{probe} * kWords;
  std::array<std::uint32_t, kWords> words;
  for (std::size_t i = 0; i < kWords; ++i) words[i] = from[i];
  return std::bit_cast<shared::ContactSample>(words);
}

bool ContactStep::hasAnswered(std::uint32_t tick) const {
  if (seen_.tick != tick) seen_ = {.tick = tick};
  for (; seen_.probes < options_.probes; ++seen_.probes) {
    const shared::ContactSample answer = sample(seen_.probes);
    if (answer.tick != tick || answer.seal != shared::sealOf(answer)) return false;
  }
  return true;
}

void ContactStep::awaitAnother(bool rehearses) {
  write(offsetof(shared::QuestionHead, lastTick) / sizeof(std::uint32_t), std::array{question_.tick});
  write(offsetof(shared::QuestionHead, rehearses) / sizeof(std::uint32_t), std::array{std::uint32_t{rehearses}});
  sample_.mapped<shared::StepTicks>()[0] = {};
}

bool ContactStep::waitsAlone(std::uint32_t list) const {
  return waits(list) && options_.probes == 1 && forms_[list % forms_.size()] == shared::kGatherAlone;
}

double ContactStep::answeringTime_us(std::uint32_t list, double section_us) const {
  if (!waitsAlone(list)) return section_us;
  const auto& ticks = sample_.mapped<const shared::StepTicks>()[0];
  if (ticks.answered == 0) return 0;
  return section_us * ticks.answered / (static_cast<double>(ticks.waited) + ticks.answered);
}

std::uint32_t ContactStep::firstList() const {
  const bool choice = !gather_ && forms_.size() > 1;
  return choice && sample().neighbours >= shared::kSplitNeighbours ? 1 : 0;
}

std::optional<std::uint32_t> ContactStep::nextList(std::uint32_t list) const {
  if (answers(list)) return std::nullopt;
  gather_->resume();
  return list + 1;
}

}  // namespace palpate
