#include "apps/view/shown_model.hpp"

#include "apps/cli/probe_overlays.hpp"
#include "apps/view/messages.hpp"

namespace palpate {

namespace {

constexpr std::array<std::uint8_t, 3> kLightBackground{236, 238, 240};

FrameOptions frameOptions(const WindowSession& session, const ViewSettings& view, const ColoredField* field,
                          bool touched) {
  FrameOptions options;
  options.color = view.color.source().value_or(ColorSource::rgb);
  if (field) options.color = field->colors(view.color);
  options.colorMap = view.color.mapOf();
  if (!view.dark) options.background = kLightBackground;
  const Model& model = session.model();
  options.up = directionOf(view.upOf(model));
  options.shown = model.shown;
  options.splatRadius = discRadiusOf(model);
  if (view.discRadius_mm > 0) options.splatRadius = model.scale.toUnits(view.discRadius_mm);
  const RecentTicks& history = session.recentTicks();
  if (touched && !history.rows().empty())
    options.overlays = overlaysOf(history.rows().back(), model.cloud.origin, session.longestSide(), session.heldTool());
  return options;
}

}  // namespace

void ShownModel::forget() {
  mesh_.clear();
  picture_.forget();
  lines_.forget();
  field_.forget();
  edited_ = {};
}

void ShownModel::follow(WindowSession& session, ViewSettings& view, const Measure& measure, Messages& messages) {
  edited_ = session.takeBatch();
  lines_.follow(session, view, measure);
  try {
    field_.follow(session, edited_, view);
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    view.color = {};
    messages.sayError(error.what());
  }
  if (!view.mesh) return mesh_.clear();
  try {
    if (session.config().moves()) throw Error("a moving model cannot be shown as triangles");
    if (!mesh_.follow(session, static_cast<std::uint32_t>(view.resolution), edited_, field(), view.color))
      messages.say("making the triangles");
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    view.mesh = false;
    mesh_.clear();
    messages.sayError(error.what());
  }
}

void ShownModel::takePick() {
  if (picture_.exists()) picture_.takePick();
}

void ShownModel::choosePace(double clock_s, bool inFull) {
  constexpr double kStill_s = 0.2;  // time without motion until full resolution
  if (picture_.hasMoved()) moved_s_ = clock_s;
  picture_.choosePace(inFull || clock_s - moved_s_ > kStill_s);
}

void ShownModel::fit(const UVec2& window_px, const ViewSettings& view) {
  picture_.fit(window_px, view.smoothOutlines ? 2 : 1);
}

bool ShownModel::aim(const WindowSession& session, const Camera& camera, const ViewSettings& view, bool touched,
                     const DVec2& cursor_px) {
  FrameOptions options = frameOptions(session, view, field(), touched);
  options.light = lightOf(view.light, session.model(), {.isSoftware = sight_.isCpu(), .barePoints = false});
  options.lines = lines_.lines();
  return picture_.aim(session, mesh_, camera, options, cursor_px);
}

void ShownModel::record(CommandList& list, WindowSession& session, const UVec2& window_px) {
  picture_.record(list, session, mesh_);
  picture_.recordPick(list, DVec2(window_px));
}

}  // namespace palpate
