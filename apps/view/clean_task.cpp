#include "apps/view/clean_task.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/view/selection.hpp"
#include "engine/cloud/estimated_normals.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/shortest_rotation.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/select/move_points.hpp"
#include "engine/select/normal_signs.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "engine/select/small_holes.hpp"
#include "haptics/session/settings.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

namespace {

std::string nameOf(const CleanModel& command) {
  if (command.normals) return "normals";
  for (const auto& setting : settingsOf<Preparation>()) {
    Preparation without = command.step;
    copySetting(setting, Preparation{}, without);
    if (without != command.step && !setting.flag.empty()) return std::string(setting.flag.substr(2));
  }
  return "cleaning";
}

// A saved file would still state the old one.
void requireFreeUp(const PointCloud& cloud) {
  const auto stated = upSaidIn(cloud.storedAs.comments);
  if (stated && *stated != UpAxis::z)
    throw Error("the file states that {} is up, which cannot change here; use palpate convert --upright {}",
                palpate::nameOf(*stated), palpate::nameOf(*stated));
}

}  // namespace

/// The points as they are, and those that may change.
struct CleanTask::Given {
  CleanModel command;
  PointCloud present;
  std::vector<PointState> states;      // of all points, by number
  std::vector<std::uint64_t> numbers;  // of the present ones
  PointBits changeable;
  FieldOptions fields;
  ViewSettings::ShownLength lengths;
  Cleaners cleaners;
};

void CleanTask::begin(const WindowSession& session, const CleanModel& command, const ViewSettings& view,
                      const Context& context) {
  if (isRunning()) throw Error("{} is still running; Esc cancels it", stage());
  session.session().require(Action::select, "clean");
  Given given{.command = command,
              .present = editedCloud(session.model().cloud, session.history().points(), session.attributes().fields()),
              .states = {session.history().points().begin(), session.history().points().end()},
              .numbers = {},
              .changeable = changeable(session),
              .fields = {.mm_per_unit = session.model().scale.toMm(1),
                         .up = view.upOf(session.model()),
                         .threads = context.threads(),
                         .progress = [this](double share) { share_ = share; }},
              .lengths = view.shownLength(session),
              .cleaners = {}};
  if (given.present.size() >= Cleaners::kFewestOnGpu && context.hasRealGpu()) {
    // One of its own: the session uses the queues of the other one.
    const auto own = std::make_shared<std::unique_ptr<Device>>();
    given.cleaners = cleanersOn([&context, own]() -> Device& {
      if (!*own) *own = context.deviceApart();
      return **own;
    });
  }
  for (const PointState& state : given.states)
    if (!state.gone) given.numbers.push_back(state.number);
  const PointSet locked = session.attributes().lock(session.model().cloud, given.states).points;
  const PointBits shown = selectable(session);
  if ((PointBits(session.attributes().mask(MaskRole::selected), shown.size()) & shown).count() == 0)
    given.changeable = shown - PointBits(locked, shown.size());
  const bool rotates = command.step.upright || command.step.level, fills = command.step.fillHoles_mm > 0;
  if (rotates || command.normals) session.session().require(Action::sculpt, "clean");
  if (fills) session.session().require(Action::insertPoints, "clean");
  if (rotates) {
    requireFreeUp(session.model().cloud);
    if (!locked.empty()) throw Error("the model cannot be rotated while points are locked");
  }
  command_ = command;
  session_ = &session;
  edits_ = session.edits();
  isStopped_ = false;
  share_ = kUnknown;
  since_ = Stopwatch();
  running_ = std::async(std::launch::async, [this, given = std::move(given)] {
    const JobStopScope stops({.flag = &isStopped_, .mayCut = true});
    return find(given);
  });
}

void CleanTask::cancel() {
  if (!isRunning()) return;
  stop();
  running_.wait();
  running_ = {};
}

std::string CleanTask::stage() const { return fmt::format("{}: {:.0f} s", nameOf(command_), since_.elapsed_s()); }

CleanTask::Found CleanTask::find(const Given& given) {
  const CleanModel& command = given.command;
  if (command.normals) return findNormals(given);
  if (command.step.upright || command.step.level) return findPose(given);
  return command.step.fillHoles_mm > 0 ? findHoles(given) : findSuperfluous(given);
}

CleanTask::Found CleanTask::findNormals(const Given& given) {
  PointCloud cloud = given.present;
  std::string how;
  if (given.command.normals == NormalSource::estimate)
    how = ": " + given.cleaners.estimate(cloud, given.fields.threads, given.fields.up);
  if (given.command.normals == NormalSource::orient) orientNormals(cloud, given.fields.threads, given.fields.up);
  if (given.command.normals == NormalSource::flip) flipNormals(cloud);
  SetPoints set;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    PointState state = given.states[given.numbers[i]];
    if (!given.changeable.test(state.number) || state.normal == cloud.normals[i]) continue;
    state.normal = cloud.normals[i];
    set.states.push_back(state);
  }
  std::string remark = set.states.empty()
                           ? "no normal changes"
                           : counted(set.states.size(), "point has another normal", "points have other normals") + how;
  if (!set.states.empty() && areNormalsEstimated(cloud))
    remark += "; they are not saved, since the file contains no normals";
  return {.superfluous = {}, .points = {}, .action = std::move(set), .done = {.remark = std::move(remark)}};
}

CleanTask::Found CleanTask::findPose(const Given& given) {
  const Preparation& step = given.command.step;
  DVec3 up = directionOf(step.upright.value_or(UpAxis::z));
  std::string remark =
      fmt::format("{} is z now", step.upright ? palpate::nameOf(*step.upright) : "the ground's normal");
  if (step.level) {
    const auto ground = findGround(given.present, given.fields.up);
    if (!ground) throw Error("no ground was found: no plane below the rest has a twentieth of the surface");
    up = ground->normal;
  }
  const DVec3 middle = boundsOf(given.present).center();
  const auto points = PointBits::where(given.states.size(), 0, [&](std::size_t i) { return !given.states[i].gone; });
  return {.superfluous = {},
          .points = points.set(),
          .action = MovePoints::about(middle, shortestRotation(up, DVec3(0, 0, 1)), 1, DVec3(0)),
          .done = {.remark = std::move(remark), .isUpright = true}};
}

CleanTask::Found CleanTask::findHoles(const Given& given) {
  const HoleFilling filling =
      fillHoles(given.present, given.command.step.fillHoles_mm / given.fields.mm_per_unit, given.fields.threads);
  SetPoints set;
  for (const NewPoint& point : filling.points)
    set.states.push_back({.position = point.position,
                          .number = given.states.size() + set.states.size(),
                          .normal = point.normal,
                          .color = given.present.hasColors() ? packedColor(point.color) : 0,
                          .parent = given.numbers[point.parent]});
  return {.superfluous = {},
          .points = {},
          .action = std::move(set),
          .done = {.remark = inWords(filling, given.lengths.perMm * given.fields.mm_per_unit, given.lengths.unit)}};
}

CleanTask::Found CleanTask::findSuperfluous(const Given& given) {
  PointCloud cloud = given.present;
  forgetGaussians(cloud);  // points are selected
  const PreparedCloud left = prepared(std::move(cloud), given.command.step, given.fields, {}, given.cleaners.distances);
  PointBits superfluous(given.states.size());
  auto next = left.numbers.begin();
  for (std::uint32_t i = 0; i < given.numbers.size(); ++i)
    if (next != left.numbers.end() && *next == i)
      ++next;
    else
      superfluous.set(given.numbers[i]);
  std::string share;
  if (given.command.step.outlierNeighbours > 0) share = ", " + outlierShare(superfluous.count(), given.numbers.size());
  return {.superfluous = std::move(superfluous), .points = {}, .action = {}, .done = {.remark = std::move(share)}};
}

std::optional<CleanTask::Done> CleanTask::follow(WindowSession& session) {
  if (!isRunning() || running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  std::future<Found> ready = std::exchange(running_, {});
  Found found;
  try {
    found = ready.get();
  } catch (const Stopped&) {
    return Done{nameOf(command_) + ": stopped; nothing has changed"};
  }
  if (session_ != &session || edits_ != session.edits())
    throw Error("{}: points have changed meanwhile; nothing was done", nameOf(command_));
  const std::string remark = std::exchange(found.done.remark, nameOf(command_) + ": ");
  if (!found.superfluous) {
    session.changePoints(found.points, found.action);
    found.done.remark += remark;
    return found.done;
  }
  const PointBits points = *found.superfluous & selectable(session);
  select(session, points, combineBy(command_.adds, command_.removes));
  found.done.remark += points.count() == 0
                           ? "no point is found"
                           : fmt::format("{} found{}; Delete, while selecting (S), removes what is selected",
                                         counted(points.count(), "point is", "points are"), remark);
  return found.done;
}

}  // namespace palpate
