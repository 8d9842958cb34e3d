// What a person should know about the brush in the hand.
#pragma once

#include <cstdint>
#include <string>

#include "apps/view/settings.hpp"

namespace palpate {

class Messages;

class BrushNotes {
 public:
  /// Another model comes.
  void forget() { *this = {}; }
  /// A brush that edits nothing is said to, once, and again with each press of it.
  void noteSize(const WindowSession& session, const ViewSettings& view, std::uint64_t presses, Messages& messages);
  /// What is painted is to be seen: the colours change, and it is said.
  void notePaint(const WindowSession& session, ViewSettings& view, Messages& messages);

 private:
  std::string tooSmall_;
  std::uint64_t presses_ = 0;
  bool inStroke_ = false;
};

}  // namespace palpate
