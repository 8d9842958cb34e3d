// Settings of the window that are kept from start to start.
#pragma once

#include <optional>

#include "apps/view/screen_places.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

/// One "name value" a line in $XDG_STATE_HOME/palpate/window (or as RecentFiles). Without that file the first steps are
/// shown. If it cannot be read or written, they last as long as the program.
struct KeptSettings {
  bool dark = true;
  int text_percent = 100;
  bool firstSteps = true;
  std::optional<DesktopPlace> place;  ///< of the window, when it was closed

  static KeptSettings of(const ViewSettings& view) { return {view.dark, view.text_percent, view.firstSteps, {}}; }
  /// Nothing: there is no such file.
  static std::optional<KeptSettings> read();
  void write() const;
  bool operator==(const KeptSettings&) const = default;
};

}  // namespace palpate
