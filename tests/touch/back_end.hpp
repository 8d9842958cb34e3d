// The back end of this test program: the CPU in tests_touch, the GPU in tests_touch_gpu, which runs the cases of the
// same files (both_back_ends in tests/rooms.cmake). A bound that depends on the back end is onCpuOrGpu(one, other).
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <optional>
#include <ostream>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/index_options.hpp"
#include "engine/core/tool_shape.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/touch/touch_backend.hpp"
#include "tests/on_gpu.hpp"

namespace palpate {

/// What a case asks of its back end.
struct TouchWanted {
  double radius = 0, friction = 0;
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);
  std::optional<BrushOptions> brush = {};
  CloudSource* source = nullptr;
  IndexFollow index = IndexFollow::incremental;
  bool paintable = false;  // keeps colours for a brush that paints later
  unsigned threads = 1;    // of the CPU; 0: one per core
};

/// How a GPU is validated: as requested, without the search for every access of a shader, or not at all, because other
/// cases run the same code under validation.
enum class Validated { fully, core, none };

/// Fixture of a case that runs on each back end, which a failure names. On a GPU a validation message fails the case.
class OnBackEnd : private doctest::detail::ContextScopeBase {
 public:
  explicit OnBackEnd(Validated validated = Validated::fully) : validated_(validated) {}
  ~OnBackEnd() override;
  std::unique_ptr<TouchBackend> make(const PointCloud& cloud, const TouchWanted& wanted) const;

 private:
  void stringify(std::ostream* out) const override { *out << (kOnGpu ? "on the GPU" : "on the CPU"); }

  Validated validated_;
};
struct OnBackEndInCore : OnBackEnd {
  OnBackEndInCore() : OnBackEnd(Validated::core) {}
};
struct OnPlainBackEnd : OnBackEnd {
  OnPlainBackEnd() : OnBackEnd(Validated::none) {}
};

}  // namespace palpate
