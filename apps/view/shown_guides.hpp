// Guides beside the model in the window.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "haptics/session/guides.hpp"

namespace palpate {

class ShownGuides {
 public:
  /// Called once per frame, and when another model is opened (forget()).
  void follow(const Model& model, UpAxis up, LengthUnit unit, const GuideConfig& config);
  void forget() { *this = {}; }
  const PictureGuides& guides() const { return guides_; }
  /// `lines`, not null, and the guides; the same list while nothing changes.
  std::shared_ptr<const std::vector<SpaceLine>> linesWith(const std::shared_ptr<const std::vector<SpaceLine>>& lines,
                                                          const Camera& camera, const UVec2& size_px);

 private:
  struct MadeOf {
    GuideConfig config;
    UpAxis up = UpAxis::y;
    LengthUnit unit = LengthUnit::unknown;
    bool operator==(const MadeOf&) const = default;
  };
  struct ListOf {
    std::shared_ptr<const std::vector<SpaceLine>> lines;
    MadeOf guides;
    std::optional<Camera> camera;  // of the compass
    UVec2 size_px{0};
    bool operator==(const ListOf&) const = default;
  };

  MadeOf madeOf_;
  PictureGuides guides_;
  ListOf listOf_;
  std::shared_ptr<const std::vector<SpaceLine>> list_;
};

}  // namespace palpate
