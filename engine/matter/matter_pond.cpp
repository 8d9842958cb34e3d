#include "engine/matter/matter_pond.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

namespace {

// Time constants: held water reaches its known position in kComes_s, and takes the velocity for that in kFollows_s.
// Known velocities are not used: each particle jitters by more than water can be compressed.
constexpr float kComes_s = 0.02f, kFollows_s = 0.0005f;
constexpr std::uint32_t kMaxBetweenNews = 50;  // steps
// A delayed update arrives together with the next one. Particles that moved meanwhile must not jump in one step, which
// would press grains into one another.
constexpr std::uint32_t kFewestBetweenNews = 8;
// Below this speed (spacings per second) a ball is considered to be where it is known to be.
constexpr double kRests_spacings_s = 2;
// Two successive known states differ by a jump if more than the share kElsewhere of the particles moved farther than
// kElsewhere_spacings, which is more than particles can move.
constexpr double kElsewhere_spacings = 3, kElsewhere = 0.5;

Vec4 heldWater(const Vec3& velocity, const Vec3& way, float held, float step_s) {
  // Implicit, so that it is stable at any substep.
  const float goes = held * step_s / kFollows_s;
  return Vec4(velocity + goes / (1 + goes) * (way / kComes_s - velocity), 0);
}

// Grains carry a load by overlaps of a hundredth of their size, so a hold weaker than the load of all grains would give
// way, and no load would build up before it. So held grains move the whole displacement in a substep and interactions
// do not push them off it: friction takes this motion into account, but would not see a later correction.
Vec4 heldSand(const Vec3& velocity, const Vec3& way, float held, float step_s) {
  return Vec4(glm::mix(velocity, way / step_s, held), held);
}

PondSpace spaceOf(const MatterScene& scene, const MatterPlan& plan) {
  return {.reach = pondReach(scene, plan),
          .spacing_m = static_cast<float>(plan.spacing_m),
          .fastest_m_s = static_cast<float>(plan.speedOfSound_m_s),
          .box_m = scene.box_mm * 1e-3};
}

}  // namespace

MatterPond::MatterPond(const MatterScene& scene, const MatterOptions& options, MatterNews news)
    : MatterWorld(scene, options, std::vector<Vec3>{}),
      news_(std::move(news)),
      rules_(spaceOf(this->scene(), plan())),
      reach_(pondReach(this->scene(), plan())) {}

// The positions of the hands are known with the next step.
void MatterPond::begin() {
  MatterWorld::begin();
  members_.clear();
}

void MatterPond::placeToolAt(std::size_t tool, const HandPose& hand) {
  MatterWorld::placeToolAt(tool, hand);
  isPlaced_ = true;
}

std::vector<DVec3> MatterPond::balls() const {
  std::vector<DVec3> places(tools());
  for (std::size_t k = 0; k < places.size(); ++k) places[k] = ball(k).place;
  return places;
}

// Whether the known state jumps, as after a restart of the remote simulation.
bool MatterPond::isElsewhere() const {
  std::size_t compared = 0, gone = 0;
  auto there = known_.ids.begin();
  for (const PondMember& member : members_) {
    there = std::lower_bound(there, known_.ids.end(), member.id);
    if (there == known_.ids.end()) break;
    if (*there != member.id || !member.isKnown) continue;
    const Vec3& place = known_.positions[static_cast<std::size_t>(there - known_.ids.begin())];
    ++compared;
    gone += static_cast<double>(glm::distance(place, member.knownPlace)) > kElsewhere_spacings * plan().spacing_m;
  }
  return static_cast<double>(gone) > kElsewhere * static_cast<double>(compared);
}

// Share of the path from the held positions to the known ones, so that particles move evenly between updates.
float MatterPond::gone() const {
  return std::min(1.0f, static_cast<float>(sinceNews_) / static_cast<float>(betweenNews_));
}

void MatterPond::hear() {
  ++sinceNews_;
  const bool isNew = news_(known_);
  if (isNew) {
    ++counts_.news;
    for (PondMember& member : members_) member.heldAt = glm::mix(member.heldAt, member.knownPlace, gone());
    betweenNews_ = std::clamp(sinceNews_, kFewestBetweenNews, kMaxBetweenNews);
    sinceNews_ = 0;
    knownAt_s_ = known_.time_s;
    if (isElsewhere()) empty();
  }
  if (isNew || isPlaced_) renew();
}

void MatterPond::renew() {
  take();
  std::vector<PondMember> members = members_;
  const std::vector<DVec3> around = balls();
  if (std::exchange(isPlaced_, false))
    std::erase_if(members, [&](const PondMember& member) {
      return static_cast<double>(PondMembers::distance(member.place, around)) < reach_.within;
    });
  std::vector<std::uint8_t> rests;
  for (std::size_t k = 0; k < tools(); ++k)
    rests.push_back(glm::length(ball(k).velocity) < kRests_spacings_s * plan().spacing_m);
  if (rules_.renew(known_, around, rests, members))
    set(std::move(members));
  else
    empty();
}

// Updates the members' positions and velocities from the simulation.
void MatterPond::take() {
  for (std::size_t slot = 0; slot < matter().size(); ++slot) {
    PondMember& member = members_[matter().ids()[slot]];
    member.place = std::as_const(*this).matter().positions()[slot];
    member.velocity = Vec3(std::as_const(*this).matter().velocities()[slot]);
  }
  for (std::uint32_t number = 0; number < members_.size(); ++number) members_[number].was = number;
}

void MatterPond::set(std::vector<PondMember> members) {
  std::vector<Vec3> places, velocities;
  std::vector<std::uint32_t> was;
  for (const PondMember& member : members) {
    places.push_back(member.place);
    velocities.push_back(member.velocity);
    was.push_back(member.was);
  }
  members_ = std::move(members);
  setParticles(std::move(places), velocities, was);
}

// Removes all members until the next update, and places the balls at the hands.
void MatterPond::empty() {
  ++counts_.restarts;
  set({});
  for (std::size_t k = 0; k < tools(); ++k) placeTool(k);
}

void MatterPond::beforeSubstep() {
  balls_ = balls();
  const auto step_s = static_cast<float>(plan().substep_s);
  const float way = gone();
  const auto hold = scene().matter == Matter::sand ? heldSand : heldWater;
  const std::span<const Vec3> places = std::as_const(*this).matter().positions();
  for (std::size_t slot = 0; slot < places.size(); ++slot) {
    const PondMember& member = members_[matter().ids()[slot]];
    const float held = member.isKnown ? rules_.held(PondMembers::distance(places[slot], balls_)) : 0;
    if (held == 0) continue;
    const Vec3 velocity(std::as_const(*this).matter().velocities()[slot]);
    const Vec3 should = glm::mix(member.heldAt, member.knownPlace, way);
    const Vec4 goes = hold(velocity, should - places[slot], held, step_s);
    matter().setVelocity(slot, Vec3(goes), goes.w);
  }
}

MatterSimulation::StepReport MatterPond::run(std::span<const HandPose> from, std::span<const HandPose> to) {
  hear();
  StepReport report = MatterWorld::run(from, to);
  if (report.state != MatterState::running) {
    // A local failure does not affect the remote simulation; members are taken from there again.
    empty();
    report = {};
    for (std::size_t k = 0; k < tools(); ++k) report.tools.push_back({.place_m = to[k].place_m});
    return report;
  }
  lend(report, from, to);
  return report;
}

// A time-domain passivity controller (Hannaford, Ryu 2002) for each hand.
void MatterPond::lend(StepReport& report, std::span<const HandPose> from, std::span<const HandPose> to) const {
  for (std::size_t k = 0; k < report.tools.size(); ++k) {
    const double gain = to[k].felt * scene().gain;
    if (!(gain > 0)) continue;
    ToolReport& tool = report.tools[k];
    const double owed_J = -kLent_J - portEnergy_J(k) - gain * tool.portWork_J;
    const DVec3 way = to[k].place_m - from[k].place_m;
    const double way_m = glm::length(way);
    if (!(owed_J > 0) || !(tool.portWork_J < 0) || !(way_m > 0)) continue;
    const double back_J = std::min(owed_J / gain, -tool.portWork_J);
    tool.springImpulse += back_J * kMatterStep_s / (way_m * way_m) * way;
    tool.portWork_J += back_J;
  }
}

std::vector<std::uint32_t> MatterPond::othersKnown() const {
  std::vector<std::uint32_t> others;
  auto member = members_.begin();
  for (std::uint32_t i = 0; i < known_.size(); ++i) {
    while (member != members_.end() && member->id < known_.ids[i]) ++member;
    const bool isHere = member != members_.end() && member->id == known_.ids[i];
    // A known particle near a ball that is not a member has no room here: it is inside a ball, or overlaps a member.
    if (!isHere && static_cast<double>(PondMembers::distance(known_.positions[i], balls_)) >= reach_.end)
      others.push_back(i);
  }
  return others;
}

std::vector<Vec3> MatterPond::positionsById() const {
  std::vector<Vec3> places = MatterWorld::positionsById();
  for (const std::uint32_t i : othersKnown()) places.push_back(known_.positions[i]);
  return places;
}

std::vector<Vec3> MatterPond::velocitiesById() const {
  std::vector<Vec3> velocities = MatterWorld::velocitiesById();
  for (const std::uint32_t i : othersKnown()) velocities.push_back(known_.velocities[i]);
  return velocities;
}

}  // namespace palpate
