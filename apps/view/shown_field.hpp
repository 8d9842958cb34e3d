// The field that colours the open model's points, in the picture and in the panels.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/view/settings.hpp"

namespace palpate {

class ShownField {
 public:
  /// Called when another model is opened.
  void forget() { shown_.reset(); }
  /// Called once per frame, with the edits since the last one: shows the field that the settings name. Statistics
  /// follow once a frame brings no further edits. Throws Error where the model has no such field.
  void follow(WindowSession& session, const EditBatch& edited, const ViewSettings& view);
  /// Null if points are not coloured by a field.
  const ColoredField* field() const { return shown_ ? &shown_->field : nullptr; }

 private:
  struct Shown {
    ColoredField field;
    std::string by;
    UpAxis up;
    std::optional<std::uint32_t> layer;  // its number there
    bool isStale = false;                // its statistics
  };
  void show(WindowSession& session, const ViewSettings& view);
  void readAll(WindowSession& session);

  std::optional<Shown> shown_;
};

}  // namespace palpate
