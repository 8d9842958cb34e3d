#pragma once

#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// How the neighbours of the probe are found (thesis section 4.3). All methods find the same points; all but brute,
/// which visits them in another order, give bitwise identical results.
enum class QueryMethod {
  brute,     ///< visits every point
  twoStep,   ///< counts on the GPU, then the host launches buckets x largest count threads
  naive,     ///< one launch by the GPU for each bucket
  indirect,  ///< the GPU lists the buckets and makes one launch for all (array-based dynamic parallelism)
  fused,     ///< gather, surface and proxy in one dispatch
};

/// The names of all methods.
inline constexpr std::array<std::pair<std::string_view, QueryMethod>, 5> kQueryMethods{{
    {"fused", QueryMethod::fused},
    {"indirect", QueryMethod::indirect},
    {"naive", QueryMethod::naive},
    {"two-step", QueryMethod::twoStep},
    {"brute", QueryMethod::brute},
}};
/// The methods that this palpate was built with, the default first: fused, and those of PALPATE_STUDY.
const std::vector<std::pair<std::string_view, QueryMethod>>& builtMethods();
/// Throws UsageError for an unknown name, and for a method that this palpate was built without.
QueryMethod queryMethodNamed(std::string_view name);

}  // namespace palpate
