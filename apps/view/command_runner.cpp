#include "apps/view/command_runner.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/view/layer_commands.hpp"
#include "apps/view/recent_files.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "engine/select/expression.hpp"

namespace palpate {

void CommandRunner::carryOut(const ViewCommands& commands) {
  for (const ViewCommand& command : commands) {
    bool isCancelled = false;
    parts_.messages.tryTo([&] {
      if (const auto* brush = std::get_if<BrushCommand>(&command))
        isCancelled = hands_.carryOut(*brush) && *brush == BrushCommand::cancelStroke;
      else
        carryOut(command);
    });
    if (isCancelled) return;
  }
}

void CommandRunner::carryOut(const ViewCommand& command) {
  if (const auto* window = std::get_if<WindowCommand>(&command)) carryOut(*window);
  if (const auto* model = std::get_if<ModelCommand>(&command)) parts_.document.carryOut(*model);
  if (const auto* stylus = std::get_if<StylusCommand>(&command)) hands_.pointing().carryOut(*stylus, hands_.pointed());
  if (const auto* answer = std::get_if<Answer>(&command)) parts_.document.answer(*answer);
  if (const auto* file = std::get_if<FileCommand>(&command)) carryOut(*file);
  if (const auto* browse = std::get_if<BrowseCommand>(&command)) parts_.panels.browse(browse->task);
  if (const auto* device = std::get_if<DeviceCommand>(&command)) carryOut(*device);
  if (const auto* select = std::get_if<SelectCommand>(&command)) carryOut(*select);
  if (const auto* device = std::get_if<ChooseDevice>(&command)) parts_.held.choose(device->device);
  if (const auto* axes = std::get_if<SetDeviceAxes>(&command)) parts_.held.setAxes(axes->text);
  if (const auto* example = std::get_if<TryExample>(&command)) carryOut(*example);
  if (const auto* copied = std::get_if<CopyText>(&command)) parts_.window.setClipboard(copied->text);
  WindowSession* session = parts_.document.session();
  if (!session) return;
  const UpAxis up = parts_.settings.view.upOf(session->model());
  const DVec3 front = parts_.settings.view.frontFor(session->model());
  if (const auto* side = std::get_if<ModelSide>(&command)) parts_.viewpoint.lookFrom(*side, up, front);
  if (const auto* walk = std::get_if<WalkCommand>(&command)) hands_.carryOut(*walk);
  if (const auto* look = std::get_if<LookAlong>(&command))
    parts_.viewpoint.lookAlong(look->axis, !look->fromBehind, up, front);
  if (const auto* set = std::get_if<SetParameter>(&command)) session->setParameter(set->name, set->value);
  if (const auto* set = std::get_if<SetValue>(&command)) parts_.messages.say(palpate::carryOut(*set, *session));
  carryOutVolume(command);
  if (const auto* keep = std::get_if<KeepSelection>(&command)) parts_.messages.say(palpate::carryOut(*keep, *session));
  if (const auto* layer = std::get_if<LayerCommand>(&command))
    if (const std::string remark = palpate::carryOut(*layer, *session); !remark.empty()) parts_.messages.say(remark);
  if (const auto* where = std::get_if<SelectWhere>(&command)) carryOut(*where);
  if (const auto* clean = std::get_if<CleanModel>(&command))
    clean_.begin(*session, *clean, parts_.settings.view, parts_.context);
  if (const auto* range = std::get_if<SetColorRange>(&command)) carryOut(*range);
  if (const auto* view = std::get_if<NamedViewCommand>(&command)) carryOut(*view);
  if (const auto* measure = std::get_if<MeasureCommand>(&command)) carryOut(*measure);
  if (const auto* length = std::get_if<SetTrueLength>(&command))
    parts_.document.openAtScale(hands_.measure().scaleFor(length->text));
}

void CommandRunner::carryOut(const NamedViewCommand& command) {
  using What = NamedViewCommand::What;
  const std::string& model = parts_.document.file();
  const DVec3& origin = parts_.document.session()->model().cloud.origin;
  if (command.what == What::remember)
    parts_.messages.say("remembered as " +
                        views_.remember(model, {command.name, textOf(parts_.viewpoint.camera(), origin)}));
  if (command.what == What::forget) views_.forget(model, command.name);
  if (command.what != What::show) return;
  for (const NamedText& view : views_.of(model))
    if (view.name == command.name) parts_.viewpoint.set(cameraOf(view.text, origin, parts_.viewpoint.camera()));
  parts_.settings.view.orthographic = parts_.viewpoint.camera().isOrthographic();
}

void CommandRunner::carryOut(const MeasureCommand& command) {
  using What = MeasureCommand::What;
  Measure& measure = hands_.measure();
  if (command.what == What::forget) measure.forget(command.name);
  if (command.what == What::rename && !measure.rename(command.name, command.to))
    throw Error("'{}' is the name of another distance", command.to);
  if (command.what == What::show && measure.choose(command.name)) {
    const auto& ends = measure.chosen()->ends;
    parts_.viewpoint.lookAt(0.5 * (ends[0].place + ends[1].place));
  }
}

void CommandRunner::carryOut(WindowCommand command) {
  if (command == WindowCommand::quit) isClosing_ = true;
  if (command == WindowCommand::stopReading) parts_.document.stopReading(), clean_.stop();
  if (command == WindowCommand::closeErrors) parts_.messages.closeErrors();
  if (command == WindowCommand::endMeasure) hands_.measure().end();
  if (command == WindowCommand::switchForces) {
    parts_.settings.forcesOn = !parts_.settings.forcesOn;
    if (parts_.settings.forcesOn) parts_.messages.say("forces on");
  }
  if (!parts_.document.session()) return;
  if (command == WindowCommand::copyPlaces) copyPlaces();
  if (command == WindowCommand::resetView) fitCamera();
  if (command == WindowCommand::turnModel) turnModel();
  if (command == WindowCommand::screenshot) savePicture();
  if (command == WindowCommand::saveMeasures) saveMeasures();
}

void CommandRunner::carryOut(DeviceCommand command) {
  switch (command) {
    case DeviceCommand::look:
      return parts_.held.lookAround();
    case DeviceCommand::test:
      return parts_.held.beginTest();
    case DeviceCommand::endTest:
      return parts_.held.endTest();
    case DeviceCommand::useStiffness:
      return parts_.held.useStiffness();
    case DeviceCommand::useAxes:
      return parts_.held.useAxes();
    case DeviceCommand::closeResult:
      return parts_.held.closeResult();
    case DeviceCommand::forget:
      return parts_.held.forget();
  }
}

void CommandRunner::carryOut(const FileCommand& command) {
  if (command.file.empty()) throw Error("type the name of a file into the field first");
  if (command.task == FileTask::open) return parts_.document.open(command.file);
  if (!parts_.document.session()) return;
  if (command.task == FileTask::saveAs) parts_.document.saveTo(command.file);
  if (command.task == FileTask::exportMesh) exportMesh(command.file);
  if (command.task == FileTask::exportSelection || command.task == FileTask::separate) {
    parts_.messages.say(exportSelection(*parts_.document.session(), parts_.document.file(), command.file,
                                        command.task == FileTask::separate));
    if (parts_.settings.select.opensBeside) openInAnotherWindow(command.file);
  }
  if (command.task == FileTask::record) parts_.document.record(command.file);
  if (command.task == FileTask::play) parts_.document.play(command.file);
}

// The model is made once, and is a file as any other.
void CommandRunner::carryOut(TryExample example) {
  constexpr std::array<const char*, 3> kShapes{"sphere", "sculpture", "torus"}, kNames{"ball", "sculpture", "ring"};
  const auto number = static_cast<std::size_t>(example);
  const std::filesystem::path file = stateFile((std::string("examples/") + kNames[number] + ".ply").c_str());
  if (file.empty()) throw Error("there is no folder for the made model: set HOME or XDG_STATE_HOME");
  if (!std::filesystem::exists(file)) {
    constexpr std::size_t kPoints = 60'000;
    PointCloud cloud = sampleShape(*makeShape(kShapes[number]), {.count = kPoints});
    markAsOurs(cloud);
    std::filesystem::create_directories(file.parent_path());
    writeCloud(file, cloud);
  }
  WindowSettings& settings = parts_.settings;
  settings.tool = WindowTool::sculpt;
  settings.brush.sculpts = example == TryExample::carve;
  settings.brush.kind = BrushKind::carve;
  settings.view.measures = example == TryExample::measure;
  parts_.document.open(file.string());
}

void CommandRunner::exportMesh(const std::string& file) {
  parts_.screen.waitForLast();
  std::vector<std::string> lost;
  const std::filesystem::path kept = parts_.shown.mesh().write(file, lost);
  if (!lost.empty()) parts_.messages.say(fmt::format("{}: not kept: {}", file, fmt::join(lost, ", ")));
  parts_.messages.say(file + " is written" + (kept.empty() ? "" : "; the old file is kept as " + kept.string()));
}

void CommandRunner::savePicture() {
  WindowSession& session = *parts_.document.session();
  if (!parts_.screen.isVisible()) return;
  parts_.screen.waitForLast();
  session.drawn().closeSurface();
  Camera camera = parts_.viewpoint.camera();
  camera.setDepthRange(session.bounds(), session.longestSide());
  const std::string file = parts_.document.freeName("", "png");
  writeImage(file, parts_.shown.picture(session, camera, parts_.settings.view,
                                        hands_.pointing().isTouching() || session.isPlaying(), parts_.screen.size_px(),
                                        hands_.measure()));
  parts_.messages.say("picture written to " + file);
}

void CommandRunner::saveMeasures() {
  const WindowSession& session = *parts_.document.session();
  const ViewSettings& view = parts_.settings.view;
  const std::string file = parts_.document.freeName("-distances", "csv");
  AtomicFile out(file);
  out.write(
      hands_.measure().csv(resolutionOf(session.bounds()), view.unitOf(session.model()), view.upOf(session.model())));
  out.commit();
  parts_.messages.say("distances written to " + file);
}

void CommandRunner::turnModel() {
  const Model& model = parts_.document.session()->model();
  ViewSettings& view = parts_.settings.view;
  view.front = view.frontFor(model);
  view.up = turnedUp(view.upOf(model), *view.front);
}

// One line per position, in the format of --scale-from and --camera.
void CommandRunner::copyPlaces() {
  const PointCloud& cloud = parts_.document.session()->model().cloud;
  std::string text;
  const double least = resolutionOf(parts_.document.session()->bounds());
  for (const auto& [place, resolution] : hands_.measure().picked())
    text += (text.empty() ? "" : "\n") + coordinateText(cloud.origin + place, std::max(least, resolution), ",");
  if (text.empty()) return parts_.messages.say("no positions to copy: press D and click the model");
  parts_.window.setClipboard(text);
  parts_.messages.say("copied: " + text);
}

void CommandRunner::fitCamera() {
  const DVec2 window_px = glm::max(DVec2(parts_.window.size_px()), DVec2(1));
  const WindowSession& session = *parts_.document.session();
  const PointSet& hidden = session.attributes().mask(MaskRole::hidden);
  PointCloud present;
  if (session.edits() > 0 || !hidden.empty())
    for (const PointState& state : session.history().points())
      if (!state.gone && !hidden.test(state.number)) present.positions.push_back(state.position);
  parts_.viewpoint.fit(session.model(), present.empty() ? nullptr : &present, parts_.settings.view, window_px,
                       parts_.panels.freeWidth_px(parts_.settings.view, window_px.x));
}

void CommandRunner::carryOut(SelectCommand command) {
  hands_.select().carryOut(command, parts_.settings.select, hands_.pointed());
  if (command >= SelectCommand::closeOutline || !parts_.document.session()) return;
  const std::string remark =
      palpate::carryOut(command, *parts_.document.session(), parts_.settings.brush, parts_.settings.select.rim_mm);
  if (!remark.empty()) parts_.messages.say(remark);
}

void CommandRunner::carryOutVolume(const ViewCommand& command) {
  const SelectShape shape = parts_.settings.select.shape;
  VolumeTool& volume = hands_.select().volume();
  const auto* select = std::get_if<SelectVolume>(&command);
  if (select && isVolume(shape)) volume.select(shape, select->how, hands_.pointed());
  const auto* set = std::get_if<SetVolume>(&command);
  if (set) volume.set(shape, set->numbers, hands_.pointed());
  if (std::holds_alternative<FlipPlane>(command)) volume.flip();
  if (std::holds_alternative<MirrorAtPlane>(command)) {
    parts_.settings.brush.symmetry = hands_.drawnVolume().numbers;
    std::ranges::replace(parts_.settings.brush.symmetry, ':', ',');
    parts_.settings.tool = WindowTool::sculpt;
    parts_.messages.say("brushes are mirrored at the plane; symmetry in Sculpt ends that");
  }
  if (const auto* move = std::get_if<MoveSelection>(&command))
    parts_.messages.say(moveSelection(*parts_.document.session(), *move));
}

void CommandRunner::carryOut(const SelectWhere& command) {
  WindowSession& session = *parts_.document.session();
  const Combine how = combineBy(command.adds, command.removes);
  if (!command.condition) {
    const ColoredField* const field = parts_.shown.field();
    if (!field) throw Error("no range is shown: choose a field in Colours first");
    return palpate::select(
        session, pointsInRange(field->field(), selectable(session), field->range(parts_.settings.view.color)), how);
  }
  try {
    whereError_.clear();
    palpate::select(session, pointsWhere(session, *command.condition, parts_.settings.view.upOf(session.model())), how);
  } catch (const ExpressionError& error) {
    whereError_ = error.what();
  }
}

void CommandRunner::followCleaning(WindowSession& session) {
  const auto done = clean_.follow(session);
  if (!done) return;
  parts_.messages.say(done->remark);
  if (!done->isUpright) return;
  parts_.settings.view.up = UpAxis::z;
  parts_.settings.view.front.reset();
}

void CommandRunner::carryOut(const SetColorRange& command) {
  if (!parts_.shown.field()) return;
  ColorConfig next = parts_.settings.view.color;
  next.range = command.text;
  parts_.shown.field()->range(next);  // refuses what is not a range
  parts_.settings.view.color = next;
}

}  // namespace palpate
