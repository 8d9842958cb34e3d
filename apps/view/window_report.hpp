// The state of the window: for the panels, and for a script.
#pragma once

#include "apps/view/brush_notes.hpp"
#include "apps/view/command_runner.hpp"
#include "apps/view/hands.hpp"
#include "apps/view/picture_pace.hpp"
#include "apps/view/viewer_parts.hpp"

namespace palpate {

class WindowReport {
 public:
  WindowReport(const ViewerParts& parts, Hands& hands, const CommandRunner& commands, const PicturePace& pace,
               const BrushNotes& brushNotes)
      : parts_(parts), hands_(hands), commands_(commands), pace_(pace), brushNotes_(brushNotes) {}

  ViewStatus status();
  /// Writes it to a JSON file. Throws FileError.
  void writeState(const std::string& file);

 private:
  std::vector<std::string> notices();
  void findPlaceInfo();
  void findUnder(ViewStatus& status) const;
  double picture_ms();
  ViewStatus::ScaleBar scaleOfPicture() const;

  ViewerParts parts_;
  Hands& hands_;
  const CommandRunner& commands_;
  const PicturePace& pace_;
  const BrushNotes& brushNotes_;
  CountedSelection selection_;
  struct {
    std::uint64_t version = 0;  // of the measure
    std::optional<PlaceInfo> info;
  } picked_;
  struct {
    std::uint64_t made = 0;
    double next_s = 0, shown_ms = 0;
  } pictures_;
};

}  // namespace palpate
