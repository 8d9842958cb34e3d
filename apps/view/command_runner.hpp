// Carries out the commands that keys, panels and scripts post.
#pragma once

#include "apps/view/clean_task.hpp"
#include "apps/view/hands.hpp"
#include "apps/view/named_texts.hpp"
#include "apps/view/viewer_parts.hpp"

namespace palpate {

class CommandRunner {
 public:
  CommandRunner(const ViewerParts& parts, Hands& hands) : parts_(parts), hands_(hands) {}

  /// In order; a failure of one is reported, and the next one is carried out. A stroke that is taken back ends the
  /// list.
  void carryOut(const ViewCommands& commands);
  /// Throws its failure.
  void carryOut(const ViewCommand& command);
  /// Whether the user has asked to close the window since the last call.
  bool takeClosing() { return std::exchange(isClosing_, false); }
  /// Shows the whole model.
  void fitCamera();
  /// Called once per frame: takes the result of a step that cleans.
  void followCleaning(WindowSession& session);
  CleanTask& cleaning() { return clean_; }
  const CleanTask& cleaning() const { return clean_; }

  const NamedTexts& views() const { return views_; }
  /// What is wrong with the condition of the last selection; empty: nothing.
  const std::string& whereError() const { return whereError_; }
  void forgetWhereError() { whereError_.clear(); }

 private:
  void carryOutVolume(const ViewCommand& command);
  void carryOut(WindowCommand command);
  void carryOut(const FileCommand& command);
  void carryOut(DeviceCommand command);
  void carryOut(TryExample example);
  void carryOut(SelectCommand command);
  void carryOut(const SelectWhere& command);
  void carryOut(const SetColorRange& command);
  void carryOut(const NamedViewCommand& command);
  void carryOut(const MeasureCommand& command);
  void copyPlaces();
  void exportMesh(const std::string& file);
  void savePicture();
  void saveMeasures();
  void turnModel();

  ViewerParts parts_;
  Hands& hands_;
  NamedTexts views_{"views", "view"};
  CleanTask clean_;
  std::string whereError_;
  bool isClosing_ = false;
};

}  // namespace palpate
