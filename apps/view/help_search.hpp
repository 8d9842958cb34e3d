// What the help lists: keys, commands and settings, filtered by typed words.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/view/key_table.hpp"
#include "apps/view/selection.hpp"

namespace palpate {

struct HelpEntry {
  std::string keys;  ///< or the section of the panel, and the name there
  std::string effect;
  std::vector<KeyAction> actions = {};  ///< what it does if it is chosen
  std::optional<WindowTool> tool = {};  ///< that the actions are of; empty: of the present one
  std::string_view section = {};        ///< that is opened if it is chosen; empty: none

  bool isCommand() const { return !actions.empty() || !section.empty(); }
};

/// A button about the selected points, for the panel and the help.
struct SelectButton {
  const char* name;
  SelectCommand command;
  std::uint64_t SelectionCounts::*needs;  ///< this many points; null: nothing
  const char* help;
};
std::span<const SelectButton> selectButtons();

/// The entries that contain all words of `words`, in any case; without words the keys of the present tool.
std::vector<HelpEntry> helpFor(WindowTool tool, std::string_view words);

}  // namespace palpate
