#include "apps/view/selection.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

#include "apps/cli/run_program.hpp"
#include "apps/cli/system_places.hpp"
#include "engine/cloud/las_classes.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/start_thread.hpp"
#include "engine/io/saving.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "engine/select/surface_select.hpp"

namespace palpate {

namespace {

constexpr double kStep = 1.5;   // of grow and shrink, spacings
constexpr double kReach = 2.5;  // between connected points, spacings
constexpr double kBlur = 3;     // of a lock whose rims have no width of their own, spacings

std::span<const PointState> pointsOf(const WindowSession& session) { return session.history().points(); }

PointBits maskOf(const WindowSession& session, MaskRole role) {
  return {session.attributes().mask(role), pointsOf(session).size()};
}

// Those that no command may change.
PointBits lockedIn(const WindowSession& session) {
  const std::vector<std::uint8_t> weights = session.session().lockWeights();
  return PointBits::where(weights.size(), 0, [&](std::size_t i) { return weights[i] == PointLock::kWhole; });
}

std::vector<std::uint8_t> inverted(std::vector<std::uint8_t> weights) {
  for (std::uint8_t& weight : weights) weight = static_cast<std::uint8_t>(PointLock::kWhole - weight);
  return weights;
}

void requireSelect(const WindowSession& session) { session.session().require(Action::select, "select"); }

PointBits selectedIn(const WindowSession& session) {
  requireSelect(session);
  PointBits selected = maskOf(session, MaskRole::selected) & selectable(session);
  if (selected.count() == 0) throw Error("no points are selected");
  return selected;
}

// Locks the selected points, with a rim, beside what is locked.
void lockSelected(WindowSession& session, double rim) {
  std::vector<std::uint8_t> weights = session.session().lockWeights();
  const std::vector<std::uint8_t> added =
      withRim(pointsOf(session), shownPoints(pointsOf(session), {}), selectedIn(session), rim);
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = std::max(weights[i], added[i]);
  session.setLockWeights(weights);
}

PointBits changeableIn(const WindowSession& session) {
  selectedIn(session);  // throws without any
  PointBits selected = changeable(session);
  if (selected.count() == 0) throw Error("all selected points are locked");
  return selected;
}

PointBits removableIn(const WindowSession& session) {
  PointBits selected = changeableIn(session);
  if (selected.count() == session.history().points().present())
    throw Error("all points are selected; a model needs at least one");
  return selected;
}

std::string removed(WindowSession& session) {
  const PointBits selected = removableIn(session);
  const std::size_t count = selected.count();
  session.changePoints(selected.set(), RemovePoints());
  return fmt::format("{} removed; Ctrl+Z restores them", counted(count, "point"));
}

template <class T>
T valueOf(const std::string& name, const std::string& text) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && last == end) return value;
  if constexpr (std::is_floating_point_v<T>)
    throw Error("{}: '{}' is not a number", name, text);
  else
    throw Error("{}: '{}' is not a whole number from {} to {}", name, text, +std::numeric_limits<T>::min(),
                +std::numeric_limits<T>::max());
}

// As it is, or as fieldNamed() makes it; classes as LAS has them, which a file without any lacks.
ScalarType typeOf(const WindowSession& session, const std::string& name) {
  if (const auto number = session.attributes().fieldNamed(name))
    return session.attributes().fields()[*number].values.type;
  for (const Attribute& attribute : session.model().cloud.extra)
    if (attribute.name == name) return attribute.type;
  constexpr std::string_view kTaken[]{"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"};
  const auto isOfName = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  if (name.empty() || !std::ranges::all_of(name, isOfName))
    throw Error("'{}' cannot name a field: use letters, digits and _", name);
  if (std::ranges::count(kTaken, name)) throw Error("{} cannot be set as a field", name);
  return name == kClassification ? ScalarType::u8 : ScalarType::f32;
}

}  // namespace

PointBits selectable(const WindowSession& session) {
  return shownPoints(pointsOf(session), session.attributes().mask(MaskRole::hidden));
}

PointBits changeable(const WindowSession& session) {
  return (maskOf(session, MaskRole::selected) & selectable(session)) - lockedIn(session);
}

void moveChangeable(WindowSession& session, const MovePoints& move) {
  session.changePoints(changeableIn(session).set(), move);
}

void select(WindowSession& session, const PointBits& found, Combine how) {
  requireSelect(session);
  const PointBits had = maskOf(session, MaskRole::selected);
  const PointBits next = how == Combine::set      ? found
                         : how == Combine::add    ? had | found
                         : how == Combine::remove ? had - found
                                                  : had & found;
  session.setMask(MaskRole::selected, next.set());
}

std::string carryOut(SelectCommand command, WindowSession& session, const BrushSettings& brush, double rim_mm) {
  const std::span<const PointState> points = pointsOf(session);
  const double spacing = std::max(session.model().spacing, session.model().wideSpacing);
  const double rim = session.model().scale.toUnits(rim_mm);
  requireSelect(session);
  switch (command) {
    case SelectCommand::all:
      select(session, selectable(session), Combine::set);
      break;
    case SelectCommand::none:
      session.setMask(MaskRole::selected, {});
      break;
    case SelectCommand::invert:
      select(session, selectable(session) - maskOf(session, MaskRole::selected), Combine::set);
      break;
    case SelectCommand::grow:
      select(session, grown(points, selectable(session), selectedIn(session), kStep * spacing), Combine::set);
      break;
    case SelectCommand::shrink:
      select(session, shrunk(points, selectable(session), selectedIn(session), kStep * spacing), Combine::set);
      break;
    case SelectCommand::connected:
      select(session, connectedWith(points, selectable(session), selectedIn(session), kReach * spacing), Combine::set);
      break;
    case SelectCommand::hide:
      session.setMask(MaskRole::hidden, (maskOf(session, MaskRole::hidden) | selectedIn(session)).set());
      break;
    case SelectCommand::isolate:
      session.setMask(MaskRole::hidden, (shownPoints(points, {}) - selectedIn(session)).set());
      break;
    case SelectCommand::showAll:
      session.setMask(MaskRole::hidden, {});
      break;
    case SelectCommand::lock:
      lockSelected(session, rim);
      break;
    case SelectCommand::unlockAll:
      session.setMask(MaskRole::locked, {});
      break;
    case SelectCommand::invertLock:
      session.setLockWeights(inverted(session.session().lockWeights()));
      break;
    case SelectCommand::softenLock:
      session.setLockWeights(softened(points, session.session().lockWeights(), rim > 0 ? rim : kBlur * spacing));
      break;
    case SelectCommand::sharpenLock:
      session.setLockWeights(sharpened(session.session().lockWeights()));
      break;
    case SelectCommand::within:
      session.setMask(MaskRole::within, selectedIn(session).set());
      break;
    case SelectCommand::everywhere:
      session.setMask(MaskRole::within, {});
      break;
    case SelectCommand::remove:
      return removed(session);
    case SelectCommand::paint: {
      const auto& [red, green, blue] = brush.color;
      session.changePoints(changeableIn(session).set(), PaintPoints{packedColor({red, green, blue, 255})});
      break;
    }
    case SelectCommand::closeOutline:
    case SelectCommand::takeBack:
    case SelectCommand::cancelOutline:
    case SelectCommand::holdOutline:
    case SelectCommand::letOutlineGo:
      break;
  }
  return {};
}

namespace {

// Returns the remark.
std::string setValue(WindowSession& session, const PointSet& points, const SetValue& set) {
  const std::size_t count = points.count();
  const ScalarType type = typeOf(session, set.field);
  std::vector<std::byte> values(count * sizeOf(type));
  double number = 0;
  visitScalar(type, [&]<class T>(std::type_identity<T>) {
    const T value = valueOf<T>(set.field, set.value);
    number = static_cast<double>(value);
    for (std::size_t i = 0; i < count; ++i) std::memcpy(values.data() + i * sizeof value, &value, sizeof value);
  });
  const bool isNew = !session.attributes().fieldNamed(set.field) &&
                     std::ranges::count(session.model().cloud.extra, set.field, &Attribute::name) == 0;
  session.setField(set.field, type, points, std::move(values));
  return fmt::format("{}{} of {} is {}", set.field, isNew ? ", a new field," : "", counted(count, "point"),
                     set.field == kClassification ? lasClassText(number) : set.value);
}

}  // namespace

std::string carryOut(const SetValue& command, WindowSession& session) {
  return setValue(session, changeableIn(session).set(), command);
}

std::string label(WindowSession& session, const PointBits& found, const SetValue& label) {
  session.session().require(Action::field, "label");
  if (label.value.empty()) throw Error("nothing is labelled: choose a class, or type a value of {}", label.field);
  if (found.count() == 0) throw Error("nothing is labelled: the model is not under the ball");
  const std::span<const PointState> points = pointsOf(session);
  const PointBits free =
      found - PointBits(session.attributes().lock(session.model().cloud, points).points, found.size());
  if (free.count() == 0) throw Error("nothing is labelled: all points under the ball are locked");
  return setValue(session, free.set(), label);
}

std::string carryOut(const KeepSelection& command, WindowSession& session) {
  const PointBits selected = selectedIn(session);
  typeOf(session, command.field);  // refuses names that no field can have
  const std::vector<std::string> names = fieldNames(session.model().cloud, session.attributes().fields());
  if (std::ranges::count(names, command.field) > 0)
    throw Error("the model has a field {} already; choose another name for the selection", command.field);
  session.setField(command.field, ScalarType::u8, selected.set(), std::vector(selected.count(), std::byte{1}));
  return fmt::format("{} is 1 of {}, and 0 of all others", command.field, counted(selected.count(), "selected point"));
}

PointBits pointsWhere(const WindowSession& session, const std::string& condition, UpAxis up) {
  requireSelect(session);
  const std::span<const PointState> points = pointsOf(session);
  const PointCloud present = editedCloud(session.model().cloud, points, session.attributes().fields());
  CloudFields fields(present, {.mm_per_unit = mmPerUnit(present, session.config().model.mm_per_unit), .up = up});
  const PointSet found = palpate::pointsWhere("where", condition, fields);
  const PointBits among = selectable(session);
  PointBits bits(points.size());
  std::uint64_t row = 0;  // of the present points, which are in the order of their numbers
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].gone && found.test(row++) && among.test(i)) bits.set(i);
  return bits;
}

std::string exportSelection(WindowSession& session, const std::string& document, const std::string& file,
                            bool separates) {
  std::error_code ignored;
  for (const std::string& own : {session.file(), document})
    if (std::filesystem::equivalent(file, own, ignored))
      throw Error("{} is the file of the open model; choose another one for the selected points", file);
  cloudFormats().toWrite(file, Written::points);
  const PointBits selected = separates ? removableIn(session) : selectedIn(session);
  std::vector<PointState> points(pointsOf(session).begin(), pointsOf(session).end());
  for (std::size_t i = 0; i < points.size(); ++i) points[i].gone = !selected.test(i);
  std::string lost;
  const std::filesystem::path kept =
      saveKeeping(file, editedCloud(session.model().cloud, points, session.attributes().fields()),
                  {.like = session.file(), .notKept = &lost});
  std::string remark = fmt::format("{} in {}", counted(selected.count(), "selected point"), file);
  if (!lost.empty()) remark += ": " + lost;
  if (!kept.empty()) remark += "; the old file is kept as " + kept.string();
  return separates ? remark + "; " + removed(session) : remark;
}

void openInAnotherWindow(const std::string& file) {
  startThread([program = programFile().string(), file] { runProgram(program, {"view", file}); }).detach();
}

const SelectionCounts& CountedSelection::of(const WindowSession& session) {
  const LayerAttributes& attributes = session.attributes();
  const bool isOld = std::exchange(session_, &session) != &session;
  const std::uint64_t version = session.edits() + session.attributeChanges();
  if (std::exchange(version_, version) == version && !isOld) return counts_;
  counts_ = {};
  const bool hasLock = attributes.hasLockField(session.model().cloud);
  if (!attributes.hasMasks() && !hasLock) return counts_;
  const PointBits there = shownPoints(pointsOf(session), {});
  const auto count = [&](MaskRole role) { return (maskOf(session, role) & there).count(); };
  std::uint64_t locked = count(MaskRole::locked), inPart = 0;
  if (hasLock) {
    const std::vector<std::uint8_t> weights = session.session().lockWeights();
    locked = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (!there.test(i)) continue;
      locked += weights[i] > 0;
      inPart += weights[i] > 0 && weights[i] < PointLock::kWhole;
    }
  }
  counts_ = {.selected = ((maskOf(session, MaskRole::selected) & there) - maskOf(session, MaskRole::hidden)).count(),
             .hidden = count(MaskRole::hidden),
             .locked = locked,
             .within = count(MaskRole::within),
             .inPart = inPart};
  return counts_;
}

}  // namespace palpate
