// Two places of the model that a person has picked, and how far apart they are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

class Measure {
 public:
  /// The first place or the second; a third one is the first of another two. Model units relative to the cloud's
  /// origin.
  void take(const DVec3& place);
  /// Of the model in that file: what was measured on another one is forgotten.
  void belongTo(const std::string& file);
  /// That model is saved in another file.
  void beCalled(const std::string& file) { file_ = file; }
  void forget();

  std::span<const DVec3> places() const { return places_; }
  /// Model units; nothing before there are two.
  std::optional<double> distance() const;
  std::uint64_t version() const { return version_; }  ///< another one after each change

  /// Millimetres per model unit, with which what was measured has the length that `text` says in mm. Throws Error.
  double scaleFor(const std::string& text) const;

 private:
  std::string file_;
  std::vector<DVec3> places_;
  std::uint64_t version_ = 0;
};

}  // namespace palpate
