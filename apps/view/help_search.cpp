#include "apps/view/help_search.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

std::string lowered(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::vector<std::string> split(std::string_view text, std::string_view between) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(between, at), text.size());
    if (end > at) parts.emplace_back(text.substr(at, end - at));
    at = end + between.size();
  }
  return parts;
}

// A row with several keys is several entries where each key has its effect: its first bindings are in that order. Enter
// does what has one meaning.
void addRow(std::vector<HelpEntry>& entries, const KeyRow& row, WindowTool tool) {
  const std::vector<std::string> keys = split(row.keys, ";  "), effects = split(row.effect, ";  ");
  const bool isEach = keys.size() == effects.size() && keys.size() <= row.bindings.size();
  if (!isEach) {
    const bool isOne = row.bindings.size() == 1 && row.bindings.front().release.empty();
    entries.push_back({row.keys, row.effect, isOne ? row.bindings.front().press : std::vector<KeyAction>(), tool});
    return;
  }
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const KeyBinding& binding = row.bindings[k];
    entries.push_back({keys[k], effects[k], binding.release.empty() ? binding.press : std::vector<KeyAction>(), tool});
  }
}

template <class Section>
void addSettings(std::vector<HelpEntry>& entries, std::string_view section) {
  for (const Setting<Section>& setting : settingsOf(static_cast<const Section*>(nullptr)))
    if (!setting.flag.empty())
      entries.push_back(
          {fmt::format("{}: {}", section, setting.flag.substr(2)), std::string(setting.help), {}, {}, section});
}

constexpr std::array<std::pair<const char*, const char*>, 6> kLook{
    {{"Look: theme", "dark or light panels"},
     {"Look: text size", "size of the panels and their text"},
     {"Look: guides", "box with lengths, axes with coordinates, grid on the ground, compass"},
     {"Look: views", "sides of the model, and views that you give a name"},
     {"Look: unit", "unit of the file's lengths, and the up axis"},
     {"Look: triangles", "the surface as triangles, and their export as a mesh"}}};

}  // namespace

std::span<const SelectButton> selectButtons() {
  constexpr auto kSelected = &SelectionCounts::selected, kLocked = &SelectionCounts::locked;
  static constexpr SelectButton kButtons[]{
      {"All", SelectCommand::all, nullptr, "Ctrl+A"},
      {"None", SelectCommand::none, kSelected, "Ctrl+Shift+A"},
      {"Invert", SelectCommand::invert, nullptr, "Ctrl+I"},
      {"Grow", SelectCommand::grow, kSelected, "+: by one and a half spacings of the points"},
      {"Shrink", SelectCommand::shrink, kSelected, "-"},
      {"Connected", SelectCommand::connected, kSelected, "J: everything that is connected with the selected points"},
      {"Hide", SelectCommand::hide, kSelected, "H"},
      {"Isolate", SelectCommand::isolate, kSelected, "I: hides all others"},
      {"Show all", SelectCommand::showAll, &SelectionCounts::hidden, "Shift+H"},
      {"Lock", SelectCommand::lock, kSelected, "Ctrl+M: brushes leave locked points as they are"},
      {"Unlock all", SelectCommand::unlockAll, kLocked, "Ctrl+Shift+M: no point is locked"},
      {"Invert lock", SelectCommand::invertLock, nullptr, "what is locked is free, and what is free is locked"},
      {"Soften lock", SelectCommand::softenLock, kLocked, "widens the rim outwards: brushes change its points in part"},
      {"Sharpen lock", SelectCommand::sharpenLock, kLocked, "makes the rim half as wide"},
      {"Delete", SelectCommand::remove, kSelected, "Delete: removes the selected points"},
      {"Only here", SelectCommand::within, kSelected, "brushes change only these points"},
      {"Anywhere", SelectCommand::everywhere, &SelectionCounts::within, "brushes change all points"},
      {"Colour", SelectCommand::paint, kSelected, "gives them the colour of the brush paint"},
  };
  return kButtons;
}

std::vector<HelpEntry> helpFor(WindowTool tool, std::string_view words) {
  std::vector<HelpEntry> entries;
  const std::vector<std::string> wanted = split(lowered(words), " ");
  for (const KeyRow& row : keyRows())
    if (row.appliesTo(tool)) addRow(entries, row, tool);
  if (wanted.empty()) return entries;
  for (const KeyRow& row : keyRows())
    if (!row.appliesTo(tool)) addRow(entries, row, row.tools.front());
  for (const SelectButton& button : selectButtons())
    entries.push_back(
        {fmt::format("Select: {}", button.name), button.help, {ViewCommand(button.command)}, WindowTool::select});
  addSettings<BrushConfig>(entries, "Tool");
  addSettings<Preparation>(entries, "Clean");
  addSettings<ColorConfig>(entries, "Colours");
  addSettings<SurfaceConfig>(entries, "Feel");
  addSettings<ForceOptions>(entries, "Feel");
  addSettings<LightConfig>(entries, "Look");
  for (const auto& [keys, effect] : kLook) entries.push_back({keys, effect, {}, {}, "Look"});
  std::erase_if(entries, [&](const HelpEntry& entry) {
    const std::string text = lowered(entry.keys + " " + entry.effect);
    return std::ranges::any_of(wanted, [&](const std::string& word) { return text.find(word) == text.npos; });
  });
  return entries;
}

}  // namespace palpate
