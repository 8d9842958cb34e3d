// The fields of the C options that are settings of a session: each pair is named once, and gives the field's default
// and its reader.
#pragma once

#include <palpate/palpate.h>

#include <tuple>
#include <utility>

#include "haptics/session/session_config.hpp"

namespace palpate::library {

inline constexpr auto kForceFields =
    std::make_tuple(std::pair{&pp_contact_options::stiffness_N_per_mm, &ForceOptions::stiffness_N_per_mm},
                    std::pair{&pp_contact_options::damping_N_s_per_mm, &ForceOptions::damping_N_s_per_mm},
                    std::pair{&pp_contact_options::max_force_N, &ForceOptions::maxForce_N},
                    std::pair{&pp_contact_options::hand_gain, &ForceOptions::handGain});
inline constexpr auto kSurfaceFields =
    std::make_tuple(std::pair{&pp_contact_options::friction, &SurfaceConfig::friction});
inline constexpr auto kToolFields =
    std::make_tuple(std::pair{&pp_tool::points, &ToolConfig::points},
                    std::pair{&pp_tool::size_mm, &ToolConfig::size_mm}, std::pair{&pp_tool::axis, &ToolConfig::axis});
inline constexpr auto kBrushFields = std::make_tuple(
    std::pair{&pp_brush::falloff, &BrushConfig::falloff},
    std::pair{&pp_brush::yield_depth_mm, &BrushConfig::yieldDepth_mm},
    std::pair{&pp_brush::push_rate, &BrushConfig::pushRate}, std::pair{&pp_brush::radius_mm, &BrushConfig::radius_mm},
    std::pair{&pp_brush::strength, &BrushConfig::strength}, std::pair{&pp_brush::color, &BrushConfig::color},
    std::pair{&pp_brush::resample, &BrushConfig::resample}, std::pair{&pp_brush::accumulate, &BrushConfig::accumulate});
inline constexpr auto kSessionFields =
    std::make_tuple(std::pair{&pp_session_options::rate_Hz, &SessionConfig::rate_Hz});
inline constexpr auto kUndoFields =
    std::make_tuple(std::pair{&pp_session_options::undo_memory_MiB, &UndoConfig::memory_MiB});
inline constexpr auto kStreamFields = std::make_tuple(std::pair{&pp_stream_options::speed, &StreamConfig::speed});

// Conversions between a field and a setting.
template <class To, class From>
requires std::is_arithmetic_v<To> && std::is_arithmetic_v<From>
void assign(To& to, const From& from) {
  if constexpr (std::is_same_v<To, bool>)
    to = from != 0;
  else
    to = static_cast<To>(from);
}
inline void assign(double (&to)[3], const DVec3& from) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}
inline void assign(DVec3& to, const double (&from)[3]) { to = {from[0], from[1], from[2]}; }
inline void assign(std::uint8_t (&to)[4], const std::array<std::uint8_t, 3>& from) {
  for (std::size_t k = 0; k < 3; ++k) to[k] = from[k];
  to[3] = 255;
}
inline void assign(std::array<std::uint8_t, 3>& to, const std::uint8_t (&from)[4]) { to = {from[0], from[1], from[2]}; }

/// Writes a section's settings into the fields of C options.
void toFields(const auto& fields, auto& options, const auto& section) {
  std::apply([&](const auto&... each) { (assign(options.*each.first, section.*each.second), ...); }, fields);
}
/// Reads them back.
void fromFields(const auto& fields, const auto& options, auto& section) {
  std::apply([&](const auto&... each) { (assign(section.*each.second, options.*each.first), ...); }, fields);
}

}  // namespace palpate::library
