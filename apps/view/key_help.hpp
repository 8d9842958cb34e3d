// The keys of the window, for its help and for the reference page.
#pragma once

#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/core/brush.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

inline std::vector<std::pair<std::string, std::string>> keyHelp() {
  return {
      {"hold Space", "the mouse is the stylus: move over the model"},
      {"Space + left button", "press into the model, and sculpt with a brush"},
      {"Space + wheel", "deeper, or less deep"},
      {"T", "keep the stylus without holding Space"},
      {"left drag", "rotate the view about the point under the cursor"},
      {"middle drag, Shift + left", "move the view"},
      {"wheel", "zoom to the cursor"},
      {"double click", "look at the point under the cursor"},
      {"R;  X  Y  Z", "reset the view;  look along an axis (Shift: from behind)"},
      {"U", "turn the model by 90 degrees, clockwise"},
      {"Ctrl+1 to Ctrl+7", "look at the front, back, left, right, top, bottom, or isometric"},
      {fmt::format("1 to {}", kBrushes.size() + 1), fmt::format("{}", fmt::join(namesOf(kBrushKinds, {"feel"}), ", "))},
      {"[  ]", "smaller, larger brush"},
      {"Ctrl+Z,  Ctrl+Shift+Z", "undo, redo"},
      {"Ctrl+S, Ctrl+Shift+S, Ctrl+O", "save;  to another file;  open a file"},
      {"Backspace", "forces off, and on again"},
      {"M", "triangles (marching cubes), or points"},
      {"D,  F", "measure between two positions,  cameras on and off"},
      {"Ctrl+C", "copy the picked positions, with all their digits"},
      {"K,  .", "pause or continue a depth camera;  next frame"},
      {"K,  N", "pause or continue water or sand;  restart it"},
      {"P,  C", "picture of the model to a file,  curves on and off"},
      {"Tab", "panels on and off"},
      {"Esc", "stop reading;  close a list, an error or help;  put the stylus away;  end measuring"},
      {"H,  Q", "this help,  quit"}};
}

}  // namespace palpate
