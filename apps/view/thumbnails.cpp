#include "apps/view/thumbnails.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "apps/view/recent_files.hpp"
#include "engine/core/checksum.hpp"

namespace palpate {

namespace {

std::filesystem::path pictureFile(const std::string& model) {
  const std::string name = lastingName(model);
  const std::filesystem::path folder = stateFile("pictures");
  if (name.empty() || folder.empty()) return {};
  Checksum sum;
  sum.add(std::as_bytes(std::span(name)));
  return folder / fmt::format("{:016x}.png", sum.value());
}

// All of that range; each pixel is the mean of those that it covers. Beyond the edge the picture continues as there.
Image shrunk(const Image& picture, const DVec2& free_px) {
  constexpr std::uint32_t kWidth = Thumbnails::kWidth, kHeight = Thumbnails::kHeight;
  const double step = std::max((free_px.y - free_px.x) / kWidth, 1.0 * picture.height / kHeight);
  const DVec2 corner(0.5 * (free_px.x + free_px.y - step * kWidth), 0.5 * (picture.height - step * kHeight));
  const auto covered = [step](double from, std::uint32_t k, std::uint32_t end) {
    const auto at = [&](double edge) { return static_cast<std::uint32_t>(std::clamp(edge, 0.0, end - 1.0)); };
    const std::uint32_t first = at(from + step * k);
    return std::pair(first, std::max(first + 1, at(from + step * (k + 1))));
  };
  Image small{kWidth, kHeight, std::vector<std::array<std::uint8_t, 4>>(std::size_t{kWidth} * kHeight)};
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const auto columns = covered(corner.x, x, picture.width), rows = covered(corner.y, y, picture.height);
      std::array<std::uint32_t, 3> sums{};
      for (std::uint32_t j = rows.first; j < rows.second; ++j)
        for (std::uint32_t i = columns.first; i < columns.second; ++i)
          for (std::size_t c = 0; c < 3; ++c) sums[c] += picture.at(i, j)[c];
      const std::uint32_t count = (rows.second - rows.first) * (columns.second - columns.first);
      auto& pixel = small.rgba[std::size_t{y} * kWidth + x];
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(sums[c] / count);
      pixel[3] = 255;
    }
  return small;
}

void removeOldest(const std::filesystem::path& folder) {
  std::vector<std::pair<std::filesystem::file_time_type, std::filesystem::path>> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".png") files.emplace_back(entry.last_write_time(), entry.path());
  std::ranges::sort(files, std::greater());
  for (std::size_t k = Thumbnails::kMax; k < files.size(); ++k) std::filesystem::remove(files[k].second);
}

}  // namespace

void Thumbnails::keep(const std::string& model, const Image& picture, const DVec2& free_px) {
  const std::filesystem::path file = pictureFile(model);
  if (file.empty() || picture.width == 0 || picture.height == 0) return;
  try {
    std::filesystem::create_directories(file.parent_path());
    writeImage(file, shrunk(picture, free_px));
    removeOldest(file.parent_path());
    read_.erase(model);
  } catch (const std::exception&) {  // not important enough for an error
  }
}

const ColorImage* Thumbnails::of(const std::string& model) {
  const auto [at, isNew] = read_.try_emplace(model);
  if (const std::filesystem::path file = isNew ? pictureFile(model) : std::filesystem::path(); !file.empty()) {
    std::error_code ignored;
    try {
      if (std::filesystem::exists(file, ignored)) at->second = readColorImage(file, kWidth);
    } catch (const std::exception&) {  // damaged: as if there were none
    }
  }
  return at->second && !at->second->rgb.empty() ? &*at->second : nullptr;
}

}  // namespace palpate
