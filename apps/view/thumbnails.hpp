// Small pictures of the models that were opened last, for the start screen.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "engine/core/vec.hpp"
#include "engine/io/image_file.hpp"
#include "engine/render/image.hpp"

namespace palpate {

/// PNG files in $XDG_STATE_HOME/palpate/pictures (or as RecentFiles), named by a hash of the model's path: at most
/// kMax, the oldest are removed. A folder that cannot be read or written only means that there are no pictures.
class Thumbnails {
 public:
  static constexpr std::uint32_t kWidth = 120, kHeight = 75;  ///< pixels; a file has at most 36 kB
  static constexpr std::size_t kMax = 24;

  /// Keeps a picture of the window as that of the model, which is shown from `free_px.x` to `free_px.y`, from the left;
  /// a model that cannot be found again by its name is ignored.
  void keep(const std::string& model, const Image& picture, const DVec2& free_px);
  /// Null: there is none. Read once, and valid until keep().
  const ColorImage* of(const std::string& model);

 private:
  std::map<std::string, std::optional<ColorImage>> read_;
};

}  // namespace palpate
