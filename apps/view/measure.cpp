#include "apps/view/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "engine/cloud/length_text.hpp"
#include "engine/core/error.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

namespace {

// Coordinates of the file, and resolutions, with all digits.
std::string textOf(const MeasuredDistance& distance, const DVec3& origin) {
  std::string text;
  for (const auto& [place, resolution] : distance.ends)
    for (const double value : {origin.x + place.x, origin.y + place.y, origin.z + place.z, resolution})
      text += fmt::format("{}{}", text.empty() ? "" : " ", value);
  return text;
}

std::optional<MeasuredDistance> distanceOf(const NamedText& kept, const DVec3& origin) {
  MeasuredDistance distance{.name = kept.name, .ends = {}};
  std::istringstream in(kept.text);
  for (auto& [place, resolution] : distance.ends) {
    in >> place.x >> place.y >> place.z >> resolution;
    place -= origin;
  }
  return in ? std::optional(distance) : std::nullopt;
}

// As in RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string doubled = "\"";
  for (const char c : text) doubled += c == '"' ? "\"\"" : std::string(1, c);
  return doubled + '"';
}

}  // namespace

double MeasuredDistance::height(UpAxis up) const { return glm::dot(ends[1].place - ends[0].place, directionOf(up)); }

double MeasuredDistance::across(UpAxis up) const {
  const DVec3 way = ends[1].place - ends[0].place;
  return glm::length(way - height(up) * directionOf(up));
}

void Measure::take(const PickedPosition& picked) {
  if (picked_.size() == 2) picked_.clear();
  chosen_.clear();
  picked_.push_back(picked);
  ++version_;
  if (picked_.size() < 2) return;
  distances_.push_back({.name = {}, .ends = {picked_[0], picked_[1]}});
  keep(distances_.back());
  chosen_ = distances_.back().name;
}

void Measure::keep(MeasuredDistance& distance) {
  distance.name = kept_.remember(file_, {distance.name, textOf(distance, origin_)});
}

void Measure::belongTo(const std::string& file, const DVec3& origin) {
  const std::string chosen = file == file_ ? chosen_ : std::string();
  end();
  file_ = file;
  origin_ = origin;
  distances_.clear();
  for (const NamedText& text : kept_.of(file))
    if (const auto distance = distanceOf(text, origin)) distances_.push_back(*distance);
  choose(chosen);
}

void Measure::beCalled(const std::string& file) {
  for (const NamedText& replaced : kept_.of(file)) kept_.forget(file, replaced.name);
  file_ = file;
  for (MeasuredDistance& distance : distances_) keep(distance);
}

void Measure::end() {
  picked_.clear();
  chosen_.clear();
  ++version_;
}

bool Measure::choose(const std::string& name) {
  const auto found = std::ranges::find(distances_, name, &MeasuredDistance::name);
  if (found == distances_.end()) return false;
  chosen_ = name;
  picked_.assign(found->ends.begin(), found->ends.end());
  ++version_;
  return true;
}

bool Measure::rename(const std::string& name, const std::string& to) {
  const auto find = [&](const std::string& of) { return std::ranges::find(distances_, of, &MeasuredDistance::name); };
  const auto found = find(name);
  if (found == distances_.end() || to.empty() || find(to) != distances_.end()) return false;
  // In the order in which they were measured.
  for (MeasuredDistance& distance : distances_) kept_.forget(file_, distance.name);
  found->name = to;
  for (MeasuredDistance& distance : distances_) keep(distance);
  return choose(found->name);
}

void Measure::forget(const std::string& name) {
  if (name == chosen_) end();
  kept_.forget(file_, name);
  std::erase_if(distances_, [&](const MeasuredDistance& distance) { return distance.name == name; });
  ++version_;
}

const MeasuredDistance* Measure::chosen() const {
  const auto found = std::ranges::find(distances_, chosen_, &MeasuredDistance::name);
  return chosen_.empty() || found == distances_.end() ? nullptr : &*found;
}

std::span<const MeasuredDistance> Measure::shown(bool measures) const {
  return measures || chosen() ? distances() : std::span<const MeasuredDistance>();
}

std::vector<PictureLabel> Measure::labelsIn(const Camera& camera, const UVec2& size_px, LengthUnit unit,
                                            bool measures) const {
  std::vector<PictureLabel> labels;
  for (const MeasuredDistance& distance : shown(measures))
    if (const auto at = camera.project(0.5 * (distance.ends[0].place + distance.ends[1].place), DVec2(size_px)))
      labels.push_back({DVec2(*at), distance.name + ": " + lengthText(distance.length(), unit)});
  return labels;
}

std::string Measure::csv(double resolution, LengthUnit unit, UpAxis up) const {
  std::string table =
      "name,from_x,from_y,from_z,to_x,to_y,to_z,length,height,across,unit,length_mm,height_mm,across_mm\n";
  const std::optional<double> mm = mmIn(unit);
  for (const MeasuredDistance& distance : distances_) {
    double coarser = resolution;
    table += quoted(distance.name);
    for (const auto& [place, own] : distance.ends) {
      table += "," + coordinateText(origin_ + place, std::max(resolution, own), ",");
      coarser = std::max(coarser, own);
    }
    const std::array lengths{distance.length(), distance.height(up), distance.across(up)};
    for (const double length : lengths) table += "," + coordinateText(length, coarser);
    table += "," + std::string(nameOf(unit));
    for (const double length : lengths) table += mm ? "," + coordinateText(*mm * length, *mm * coarser) : ",";
    table += '\n';
  }
  return table;
}

double Measure::scaleFor(const std::string& text) const {
  double true_mm = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, true_mm);
  if (error != std::errc() || last != end || !(true_mm > 0))
    throw Error("true length: '{}' is not a positive length in mm", text);
  const MeasuredDistance* const distance = chosen();
  const double units = distance ? distance->length() : 0;
  if (!(units > 0)) throw Error("nothing is measured: click two different positions on the model first");
  const double scale = true_mm / units;
  if (!(scale >= bounds::kMinScale && scale <= bounds::kMaxScale))
    throw Error("{} mm for {:.6g} units are {} mm per unit, which is not between {} and {}", true_mm, units, scale,
                bounds::kMinScale, bounds::kMaxScale);
  return scale;
}

}  // namespace palpate
