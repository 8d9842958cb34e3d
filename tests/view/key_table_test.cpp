// With each tool of the window a key has one meaning, and the help names each.
#define GLFW_INCLUDE_NONE
#include "apps/view/key_table.hpp"

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

namespace palpate::key_table_test {

namespace {

constexpr WindowTool kTools[]{WindowTool::sculpt, WindowTool::select, WindowTool::look};

std::vector<const KeyBinding*> meaningsOf(WindowTool tool, int key, bool control, bool shift) {
  std::vector<const KeyBinding*> found;
  for (const KeyRow& row : keyRows())
    for (const KeyBinding& binding : row.bindings)
      if (row.appliesTo(tool) && binding.matches(key, control, shift)) found.push_back(&binding);
  return found;
}

template <class Command>
bool posts(WindowTool tool, int key, bool control, bool shift, Command command) {
  for (const KeyBinding* const meaning : meaningsOf(tool, key, control, shift))
    for (const KeyAction& action : meaning->press)
      if (const auto* const posted = std::get_if<ViewCommand>(&action))
        if (const auto* const of = std::get_if<Command>(posted); of && *of == command) return true;
  return false;
}

}  // namespace

TEST_CASE("with no tool a key has two meanings") {
  std::size_t meanings = 0;
  for (const WindowTool tool : kTools)
    for (int key = 0; key <= GLFW_KEY_LAST; ++key)
      for (const bool control : {false, true})
        for (const bool shift : {false, true}) {
          CAPTURE(key);
          CAPTURE(control);
          CAPTURE(shift);
          const std::size_t found = meaningsOf(tool, key, control, shift).size();
          CHECK(found <= 1);
          meanings += found;
        }
  CHECK(meanings > 200);
}

TEST_CASE("each row of the help has keys, an effect and a tool, and each key does something") {
  for (const KeyRow& row : keyRows()) {
    CAPTURE(row.keys);
    CHECK_FALSE(row.keys.empty());
    CHECK_FALSE(row.effect.empty());
    CHECK_FALSE(row.tools.empty());
    for (const KeyBinding& binding : row.bindings) CHECK_FALSE(binding.press.empty());
  }
}

TEST_CASE("while sculpting all keys do what they did before there were tools") {
  constexpr WindowTool kSculpt = WindowTool::sculpt;
  for (const bool shift : {false, true}) {
    CHECK(posts(kSculpt, GLFW_KEY_SPACE, false, shift, StylusCommand::hold));
    CHECK(posts(kSculpt, GLFW_KEY_SPACE, true, shift, StylusCommand::hold));
    CHECK(posts(kSculpt, GLFW_KEY_T, false, shift, StylusCommand::lockOrUnlock));
    CHECK(posts(kSculpt, GLFW_KEY_R, false, shift, WindowCommand::resetView));
    CHECK(posts(kSculpt, GLFW_KEY_P, false, shift, WindowCommand::screenshot));
    CHECK(posts(kSculpt, GLFW_KEY_BACKSPACE, false, shift, WindowCommand::switchForces));
    CHECK(posts(kSculpt, GLFW_KEY_Q, true, shift, WindowCommand::quit));
    CHECK(posts(kSculpt, GLFW_KEY_Y, true, shift, ModelCommand::redo));
    CHECK(posts(kSculpt, GLFW_KEY_ESCAPE, false, shift, StylusCommand::putAway));
    for (const int key : {GLFW_KEY_H, GLFW_KEY_D, GLFW_KEY_M, GLFW_KEY_F, GLFW_KEY_C, GLFW_KEY_TAB,
                          GLFW_KEY_LEFT_BRACKET, GLFW_KEY_RIGHT_BRACKET, GLFW_KEY_1, GLFW_KEY_8})
      CHECK(meaningsOf(kSculpt, key, false, shift).size() == 1);
  }
  // But for F, which changes the size of the brush, as in other programs; Ctrl+F hides the cameras.
  CHECK(posts(kSculpt, GLFW_KEY_F, false, false, BrushCommand::dragSize));
  CHECK(posts(kSculpt, GLFW_KEY_F, false, true, BrushCommand::dragStrength));
  for (const WindowTool tool : kTools) CHECK(meaningsOf(tool, GLFW_KEY_F, true, false).size() == 1);
  CHECK(posts(kSculpt, GLFW_KEY_ESCAPE, false, false, BrushCommand::cancelStroke));
  CHECK(posts(kSculpt, GLFW_KEY_Z, true, false, ModelCommand::undo));
  CHECK(posts(kSculpt, GLFW_KEY_S, true, false, ModelCommand::save));
  CHECK(meaningsOf(kSculpt, GLFW_KEY_DELETE, false, false).empty());
  CHECK(meaningsOf(kSculpt, GLFW_KEY_A, true, false).empty());
}

TEST_CASE("numbers choose a brush and sculpt with any tool, and brackets resize only the brush of the tool") {
  for (const WindowTool tool : kTools) {
    WindowSettings settings;
    settings.tool = tool;
    const auto press = [&](int key) {
      for (const KeyBinding* const meaning : meaningsOf(tool, key, false, false))
        for (const KeyAction& action : meaning->press)
          if (const auto* const set = std::get_if<std::function<void(WindowSettings&)>>(&action)) (*set)(settings);
    };
    const WindowSettings before = settings;
    press(GLFW_KEY_RIGHT_BRACKET);
    CHECK((settings.brush.radius_mm > before.brush.radius_mm) == (tool == WindowTool::sculpt));
    CHECK((settings.select.brush_mm > before.select.brush_mm) == (tool == WindowTool::select));
    press(GLFW_KEY_3);
    CHECK(settings.tool == WindowTool::sculpt);
    CHECK(settings.brush.sculpts);
    CHECK(settings.brush.kind == BrushKind::carve);
  }
}

TEST_CASE("choosing a tool or a brush by a key ends measuring, and Shift+S and Shift+D have no other meaning") {
  for (const WindowTool tool : kTools)
    for (const auto& [key, shift] : {std::pair{GLFW_KEY_S, true}, {GLFW_KEY_V, false}, {GLFW_KEY_2, false}}) {
      WindowSettings settings;
      settings.tool = tool;
      settings.view.measures = true;
      for (const KeyBinding* const meaning : meaningsOf(tool, key, false, shift))
        for (const KeyAction& action : meaning->press)
          if (const auto* const set = std::get_if<std::function<void(WindowSettings&)>>(&action)) (*set)(settings);
      CHECK_FALSE(settings.view.measures);
    }
  for (const WindowTool tool : kTools) CHECK(meaningsOf(tool, GLFW_KEY_D, false, true).size() == 1);
}

TEST_CASE("with Ctrl each brush does something else, or says what to do instead") {
  for (const BrushTraits& brush : kBrushes) {
    CAPTURE(brush.name);
    CHECK(brush.inverse.has_value() == (std::string_view(brush.withoutInverse) == ""));
    CHECK(brush.inverse != brush.kind);
  }
}

}  // namespace palpate::key_table_test
