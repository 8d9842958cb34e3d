#include "engine/matter/gpu_matter_world.hpp"

#include <algorithm>
#include <numeric>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/matter/gpu_tools.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kMaxListedInWater = 128, kMaxListedInSand = 64;
constexpr const char* kMatterStep = "step";
constexpr std::uint32_t kSwiftSteps = 16;  // after the start, and after a step that needed lists at least twice

float listed_m(const MatterScene& scene, const MatterPlan& plan) {
  return (reachOf(scene.matter).neighbour_spacings + kListedFarther_spacings) * static_cast<float>(plan.spacing_m);
}

// Maximum displacement of a particle until its lists must be rebuilt.
float allowed_m(const MatterPlan& plan) { return kListedFarther_spacings * static_cast<float>(plan.spacing_m) / 2; }

shared::MatterCells particleCells(const MatterScene& scene, const MatterPlan& plan) {
  return cellsOf({.size = scene.box_mm * 1e-3, .periodic = scene.periodic}, listed_m(scene, plan));
}

MatterSizes sizesOf(const MatterSimulation& world, const BoundaryBody& ball, std::size_t tools) {
  const auto particles = static_cast<std::uint32_t>(world.particles());
  return {.particles = particles,
          .blocks = static_cast<std::uint32_t>(blocksOf(particles)),
          .cells = static_cast<std::uint32_t>(countOf(particleCells(world.scene(), world.plan()))),
          .tools = static_cast<std::uint32_t>(tools),
          .bodyPoints = ball.size(),
          .bodyCells = static_cast<std::uint32_t>(countOf(ball.grid().cells())),
          .modelNodes = world.model() != nullptr ? static_cast<std::uint32_t>(world.model()->nodes().size()) : 0,
          .substeps = world.plan().substeps,
          .mostListed = world.scene().matter == Matter::sand ? kMaxListedInSand : kMaxListedInWater,
          .remembers = world.scene().matter == Matter::sand};
}

shared::MatterSetting settingOf(const MatterSimulation& world, const BoundaryBody& ball, const MatterSizes& sizes) {
  const MatterScene& scene = world.scene();
  const MatterPlan& plan = world.plan();
  const auto spacing = static_cast<float>(plan.spacing_m);
  const auto support = static_cast<float>(kSupport_spacings * plan.spacing_m);
  return {.cells = particleCells(scene, plan),
          .bodyCells = ball.grid().cells(),
          .water = waterRules(scene, plan),
          .grains = grainRules(scene, plan),
          .spring = springOnGpu(scene, plan),
          .model = world.model() != nullptr ? world.model()->field() : shared::ModelField{},
          .modelMiddle = world.model() != nullptr ? Vec3(world.model()->middle()) : Vec3(0),
          .bodyMiddle = ball.middle(),
          .bodyReach = ball.extent() + support,
          .fall = scene.gravity_m_s2 * plan.substep_s,
          .bodySupport = support,
          .ballRadius = static_cast<float>(scene.tool.radius_mm * 1e-3),
          .bodyKept = ball.kept(),
          .bodyPush = ball.push(),
          .listed = listed_m(scene, plan),
          .allowed = allowed_m(plan),
          .nearest = reachOf(scene.matter).wall_spacings * spacing,
          .step = static_cast<float>(plan.substep_s),
          .mass = static_cast<float>(plan.mass_kg),
          .mostKinetic = static_cast<float>(plan.mostKinetic_J(sizes.particles)),
          .bodyPoints = sizes.bodyPoints,
          .mostListed = sizes.mostListed};
}

std::vector<Vec4> widened(const std::vector<Vec3>& values) {
  std::vector<Vec4> wide;
  wide.reserve(values.size());
  for (const Vec3& value : values) wide.emplace_back(value, 0);
  return wide;
}

CommandList::Timing timingOf(const MatterOptions& options) {
  return options.timesPasses ? CommandList::Timing::passes : CommandList::Timing::sections;
}

template <class T>
std::vector<T> copyOf(std::span<const T> values) {
  return {values.begin(), values.end()};
}

}  // namespace

GpuMatterWorld::GpuMatterWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options)
    : GpuMatterWorld(device, queue, scene, options,
                     placesAtRest(scene, onMachine(options, device.ownMemory()).memory_bytes)) {}

GpuMatterWorld::GpuMatterWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                               std::vector<Vec3> places)
    : MatterSimulation(scene, onMachine(options, device.ownMemory()), std::move(places)),
      device_(device),
      queue_(queue),
      ball_(ballBody(scene, plan())),
      sizes_(sizesOf(*this, ball_, tools())),
      memory_(device, sizes_),
      passes_(device, scene.matter),
      calm_(device, queue, "calm matter", timingOf(options)),
      swift_(device, queue, "swift matter", timingOf(options)) {
  std::vector<Vec4> bodyPoints = copyOf(ball_.points());
  if (model() != nullptr) bodyPoints.insert(bodyPoints.end(), model()->nodes().begin(), model()->nodes().end());
  upload(device_, queue_, memory_.bodyPoints, bodyPoints);
  upload(device_, queue_, memory_.bodyFirsts, copyOf(ball_.grid().firsts()));
  takeParameters();
  reset();
}

void GpuMatterWorld::takeParameters() {
  memory_.setting.mapped<shared::MatterSetting>()[0] = settingOf(*this, ball_, sizes_);
  sizes_.substeps = plan().substeps;
  record(calm_, false);
  record(swift_, true);
}

void GpuMatterWorld::record(CommandList& step, bool swift) {
  step.begin();
  {
    const auto section = step.section(kMatterStep);
    for (std::uint32_t substep = 0; substep < sizes_.substeps; ++substep)
      passes_.record(step, memory_, sizes_, substep, swift ? 1 : substep == 0 ? sizes_.substeps : 0);
    step.copy(memory_.state, memory_.stateRead, memory_.state.bytes());
  }
  step.end();
}

void GpuMatterWorld::begin() {
  const std::vector<Vec4> places = widened(beginning());
  std::vector<std::uint32_t> ids(places.size());
  std::iota(ids.begin(), ids.end(), 0u);
  upload(device_, queue_, memory_.particles.positions, places);
  upload(device_, queue_, memory_.sorted.places, places);
  upload(device_, queue_, memory_.particles.ids, ids);
  CommandList clear(device_, queue_, "matter begin");
  clear.begin();
  for (const Buffer* buffer : {&memory_.state, &memory_.particles.places, &memory_.particles.velocities,
                               &memory_.pressed, &memory_.contactCounts})
    clear.fill(*buffer, 0, buffer->bytes());
  clear.copy(memory_.state, memory_.stateRead, memory_.state.bytes());
  clear.end();
  queue_.run(clear);
  swiftSteps_ = kSwiftSteps;
}

void GpuMatterWorld::placeToolAt(std::size_t tool, const HandPose&) {
  putToHand(device_, queue_, memory_.state, MatterMemory::kTools, tool);
}

MatterSimulation::StepReport GpuMatterWorld::run(std::span<const HandPose> from, std::span<const HandPose> to) {
  const std::span<shared::HandStep> hands =
      memory_.hands.mapped<shared::HandStep>().first(std::size_t{sizes_.substeps} * sizes_.tools);
  writeHandSteps(from, to, plan().substep_s, hands);
  for (std::size_t k = 0; k < hands.size() && tools() > 0; ++k)
    hands[k].grown = static_cast<float>(grown_m(k % tools()));
  const shared::MatterControl before = control();
  ran_ = swiftSteps_ > 0 || areSwift(from, to) ? &swift_ : &calm_;
  queue_.wait(queue_.submit(*ran_), device_.defaultWait());
  choose(before);
  const auto& sums = *reinterpret_cast<const shared::MatterSums*>(
      memory_.stateRead.mapped<const std::byte>().subspan(MatterMemory::kSums).data());
  StepReport report{.state = static_cast<MatterState>(control().state),
                    .gravity = gravityOf(control().substeps),
                    .onWalls = sums.onWalls,
                    .onModel = sums.onModel,
                    .turnOfModel = sums.turnOfModel,
                    .totals = {.kinetic_J = static_cast<double>(sums.kinetic),
                               .momentum = sums.momentum,
                               .maxCompression = static_cast<double>(sums.mostCompression)}};
  const auto* balls = reinterpret_cast<const shared::ToolState*>(
      memory_.stateRead.mapped<const std::byte>().subspan(MatterMemory::kTools).data());
  for (std::size_t tool = 0; tool < tools(); ++tool) report.tools.push_back(reportOf(balls[tool], to[tool]));
  return report;
}

// Whether a hand moves matter in a step farther than the lists allow.
bool GpuMatterWorld::areSwift(std::span<const HandPose> from, std::span<const HandPose> to) const {
  for (std::size_t tool = 0; tool < tools(); ++tool)
    if (growsBall(tool) || glm::length(to[tool].place_m - from[tool].place_m) > allowed_m(plan())) return true;
  return false;
}

// Chooses the kind of the next step from the results of this one: deterministic for the same scene and hands.
void GpuMatterWorld::choose(const shared::MatterControl& before) {
  if (control().late != before.late || control().lists - before.lists > 1) {
    swiftSteps_ = kSwiftSteps;
  } else if (swiftSteps_ > 0) {
    --swiftSteps_;
  }
}

std::optional<double> GpuMatterWorld::gpuTime_us() const {
  const double time_us = ran_->sectionTime_us(kMatterStep);
  return time_us > 0 ? std::optional(time_us) : std::nullopt;
}

std::vector<Vec3> GpuMatterWorld::byId(const Buffer& slots, std::uint64_t firstSlot) const {
  std::vector<Vec4> values(particles());
  downloadBytes(device_, queue_, slots, std::as_writable_bytes(std::span(values)), firstSlot * sizeof(Vec4));
  const auto ids = download<std::uint32_t>(device_, queue_, memory_.particles.ids, particles());
  std::vector<Vec3> ordered(particles());
  for (std::size_t slot = 0; slot < ordered.size(); ++slot) ordered[ids[slot]] = Vec3(values[slot]);
  return ordered;
}

std::vector<Vec3> GpuMatterWorld::positionsById() const { return byId(memory_.particles.positions, 0); }
std::vector<Vec3> GpuMatterWorld::velocitiesById() const {
  return byId(memory_.particles.velocities, std::uint64_t{control().parity} * particles());
}

void GpuMatterWorld::setVelocities(std::span<const Vec3> byId) {
  PALPATE_CHECK_EQ(byId.size(), particles());
  const auto ids = download<std::uint32_t>(device_, queue_, memory_.particles.ids, particles());
  std::vector<Vec4> halves(2 * particles());
  for (std::size_t slot = 0; slot < ids.size(); ++slot)
    halves[slot] = halves[slot + particles()] = Vec4(byId[ids[slot]], 0);
  upload(device_, queue_, memory_.particles.velocities, halves);
}

std::vector<Vec4> GpuMatterWorld::pressedPlaces() const {
  return download<Vec4>(device_, queue_, memory_.pressed, particles());
}

}  // namespace palpate
