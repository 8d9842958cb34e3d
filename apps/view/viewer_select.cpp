// The part of Viewer that selects, and sets the range of the colours.
#include "apps/view/viewer.hpp"
#include "engine/core/error.hpp"
#include "engine/select/expression.hpp"

namespace palpate {

void Viewer::carryOut(SelectCommand command) {
  select_.carryOut(command, settings_.select, pointed());
  if (command >= SelectCommand::closeOutline || !document_.session()) return;
  const std::string remark = palpate::carryOut(command, *document_.session(), settings_.brush);
  if (!remark.empty()) messages_.say(remark);
}

void Viewer::carryOutVolume(const ViewCommand& command) {
  const SelectShape shape = settings_.select.shape;
  VolumeTool& volume = select_.volume();
  const auto* select = std::get_if<SelectVolume>(&command);
  if (select && isVolume(shape)) volume.select(shape, select->how, pointed());
  const auto* set = std::get_if<SetVolume>(&command);
  if (set) volume.set(shape, set->numbers, pointed());
  if (std::holds_alternative<FlipPlane>(command)) volume.flip();
  if (std::holds_alternative<MirrorAtPlane>(command)) {
    settings_.brush.symmetry = drawnVolume().numbers;
    std::ranges::replace(settings_.brush.symmetry, ':', ',');
    settings_.tool = WindowTool::sculpt;
    messages_.say("brushes are mirrored at the plane; symmetry in Sculpt ends that");
  }
  if (const auto* move = std::get_if<MoveSelection>(&command))
    messages_.say(moveSelection(*document_.session(), *move));
}

void Viewer::carryOut(const SelectWhere& command) {
  WindowSession& session = *document_.session();
  const Combine how = combineBy(command.adds, command.removes);
  if (!command.condition) {
    const ColoredField* const field = shown_.field();
    if (!field) throw Error("no range is shown: choose a field in Colours first");
    return select(session, pointsInRange(field->field(), selectable(session), field->range(settings_.view.color)), how);
  }
  try {
    whereError_.clear();
    select(session, pointsWhere(session, *command.condition, settings_.view.upOf(session.model())), how);
  } catch (const ExpressionError& error) {
    whereError_ = error.what();
  }
}

void Viewer::followCleaning(WindowSession& session) {
  const auto done = clean_.follow(session);
  if (!done) return;
  messages_.say(done->remark);
  if (!done->isUpright) return;
  settings_.view.up = UpAxis::z;
  settings_.view.front.reset();
}

void Viewer::carryOut(const SetColorRange& command) {
  if (!shown_.field()) return;
  ColorConfig next = settings_.view.color;
  next.range = command.text;
  shown_.field()->range(next);  // refuses what is not a range
  settings_.view.color = next;
}

}  // namespace palpate
