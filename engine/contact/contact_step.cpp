#include "engine/contact/contact_step.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
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

// Two slots per probe for each point that does not fit into shared memory. Several probes have room for the points of
// one round-limited gather, a single probe for the largest possible gather.
std::uint32_t spillSlots(const Device& device, const ContactOptions& options, std::uint32_t cells,
                         std::uint64_t points) {
  std::uint64_t most = points;
  if (options.probes > 1)
    most = std::min<std::uint64_t>(points, std::uint64_t{gatherRounds(cells)} * shared::kPatchRoundCandidates);
  return 2 * static_cast<std::uint32_t>(spilledPoints(most, sharedPatch(device, options.pointsMove)));
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
      step_(device, shader_code::contact_contact_step,
            {.workgroupSize = shared::kContactWorkgroup,
             .pushBytes = sizeof(shared::ContactStepArgs),
             .constants = {static_cast<std::uint32_t>(options.surface), options.localRadius ? VK_TRUE : VK_FALSE,
                           std::bit_cast<std::uint32_t>(static_cast<float>(options.friction)),
                           options.probes > 1 ? VK_TRUE : VK_FALSE,
                           std::bit_cast<std::uint32_t>(static_cast<float>(options.widening)),
                           sharedPatch(device, options.pointsMove), options.pointsMove ? VK_TRUE : VK_FALSE,
                           options.normalsTurn ? VK_TRUE : VK_FALSE}}),
      polls_(pollsOn(device)),
      await_(device, shader_code::contact_await_question,
             {.workgroupSize = shared::kContactWorkgroup / (options.probes > 1 ? 1 : 8),
              .pushBytes = sizeof(shared::AwaitQuestionArgs)}),
      pose_(Buffer::of<shared::ContactQuestion>(device, options.probes, Memory::upload, "contact pose")),
      lastTick_(Buffer::of<std::uint32_t>(device, 1, Memory::upload, "last question")),
      taken_(Buffer::of<shared::ContactQuestion>(device, options.probes, Memory::device, "questions taken")),
      state_(Buffer::of<shared::ContactState>(device, options.probes, Memory::device, "contact state")),
      sample_(Buffer::of<shared::ContactSample>(device, options.probes, Memory::readback, "contact sample")),
      spill_(Buffer::of<Vec4>(device, std::uint64_t{spillSlots_} * options.probes, Memory::device, "patch spill")),
      patch_(makeGatheredPatch(
          device, gather_ ? gather_->slots() : std::uint64_t{gatherRounds(cells_)} * shared::kPatchRoundCandidates)) {
  PALPATE_CHECK_LT(0.0, options.radius);
  PALPATE_CHECK_LE(1u, options.probes);
  PALPATE_CHECK(options.probes == 1 || !gather_);
  PALPATE_CHECK_LE(smallestCell(options.radius) * static_cast<double>(grid.inverseCell), 1.0 + 1e-5);
  upload(device, state_, std::vector<shared::ContactState>(options.probes));
  for (std::uint32_t probe = 0; probe < options.probes; ++probe) {
    put({}, probe);
    sample_.mapped<shared::ContactSample>()[probe] = {};
  }
}

std::uint32_t ContactStep::lists() const {
  if (gather_) return gather_->submissions();
  return (canWait() ? 2 : 1) * static_cast<std::uint32_t>(forms_.size());
}

void ContactStep::record(CommandList& commands, std::uint32_t list, const shared::CloudView& cloud,
                         DeviceAddress logHead, DeviceAddress velocities) const {
  PALPATE_CHECK(velocities != 0 || !options_.pointsMove);
  const shared::ContactStepArgs args{.cloud = cloud, .logHead = logHead, .velocities = velocities};
  if (waits(list)) recordAwait(commands);
  const auto section = commands.section("contact");
  if (!gather_) return recordSolve(commands, args, waits(list) ? taken_ : pose_, forms_[list % forms_.size()]);
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
  recordSolve(commands, args, pose_, shared::kGatherGiven);
}

void ContactStep::recordAwait(CommandList& commands) const {
  commands.dispatch(await_, await_.workgroupSize(),
                    shared::AwaitQuestionArgs{.question = pose_.address(),
                                              .taken = taken_.address(),
                                              .lastTick = lastTick_.address(),
                                              .polls = polls_,
                                              .probes = options_.probes});
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
  // A waiting GPU may be polling: every word is written once, and the fence flushes the processor's write buffers.
  volatile std::uint32_t* to = pose_.mapped<std::uint32_t>().data() + std::size_t{probe} * kWords;
  for (std::size_t i = 0; i < kWords; ++i) to[i] = words[i];
  if (canWait()) std::atomic_thread_fence(std::memory_order_seq_cst);
  question_ = question.pose;
}

void ContactStep::recordSolve(CommandList& commands, const shared::ContactStepArgs& args, const Buffer& pose,
                              std::uint32_t gather) const {
  const std::uint32_t workgroups = gather == shared::kGatherSplit ? shared::kSplitWorkgroups : options_.probes;
  commands.dispatch(step_, workgroups * shared::kContactWorkgroup,
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
  const volatile std::uint32_t* from = sample_.mapped<const std::uint32_t>().data() + std::size_t{probe} * kWords;
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
