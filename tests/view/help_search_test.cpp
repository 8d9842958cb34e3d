// The help finds keys, commands and settings by their words.
#include "apps/view/help_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace palpate::help_search_test {

namespace {

bool posts(const std::vector<HelpEntry>& entries, SelectCommand command) {
  return std::ranges::any_of(entries, [&](const HelpEntry& entry) {
    return std::ranges::any_of(entry.actions, [&](const KeyAction& action) {
      const auto* const posted = std::get_if<ViewCommand>(&action);
      const auto* const of = posted ? std::get_if<SelectCommand>(posted) : nullptr;
      return of && *of == command;
    });
  });
}

}  // namespace

TEST_CASE("without words the help lists the keys of the tool, and with words whatever contains all of them") {
  for (const auto& [name, tool] : kWindowTools) {
    const auto all = helpFor(tool, "");
    CHECK(all.size() > 20);
    for (const HelpEntry& entry : all) CHECK_FALSE(entry.effect.empty());
  }
  const auto found = helpFor(WindowTool::sculpt, "HIDE others");
  REQUIRE_FALSE(found.empty());
  for (const HelpEntry& entry : found) {
    CHECK((entry.keys + entry.effect).find("ide") != std::string::npos);
    CHECK((entry.keys + entry.effect).find("others") != std::string::npos);
  }
  CHECK(helpFor(WindowTool::look, "xyzzy").empty());
  CHECK(helpFor(WindowTool::look, "undo").size() < helpFor(WindowTool::look, "d").size());
}

TEST_CASE("a found command is one meaning, of the tool that has it, and a setting names its section") {
  const auto isolate = helpFor(WindowTool::sculpt, "hides all others");
  REQUIRE(isolate.size() == 1);
  CHECK(isolate[0].tool == WindowTool::select);
  CHECK(posts(isolate, SelectCommand::isolate));
  // A row of several keys with an effect each is several commands.
  const auto lasso = helpFor(WindowTool::select, "lasso");
  REQUIRE(lasso.size() == 1);
  CHECK(lasso[0].keys == "L");
  WindowSettings settings;
  std::get<std::function<void(WindowSettings&)>>(lasso[0].actions.at(0))(settings);
  CHECK(settings.select.shape == SelectShape::lasso);
  for (const auto& [words, command] : {std::pair{"grow the selection", SelectCommand::grow},
                                       {"shrink it", SelectCommand::shrink},
                                       {"connected with it", SelectCommand::connected}}) {
    const auto found = helpFor(WindowTool::select, words);
    REQUIRE_FALSE(found.empty());
    CHECK(posts({found[0]}, command));
  }
  // Keys that are held are not commands, and rows with several meanings are not either.
  for (const HelpEntry& entry : helpFor(WindowTool::sculpt, "hold Space"))
    if (entry.keys == "hold Space") CHECK_FALSE(entry.isCommand());
  const auto material = helpFor(WindowTool::sculpt, "look: material");
  REQUIRE_FALSE(material.empty());
  CHECK(material[0].keys == "Look: material");
  CHECK(material[0].section == "Look");
  for (const HelpEntry& entry : helpFor(WindowTool::sculpt, "e"))
    if (!entry.section.empty()) CHECK(std::ranges::count(kSections, entry.section) == 1);
}

}  // namespace palpate::help_search_test
