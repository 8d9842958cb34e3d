// The C interface: clouds whose points are selected, cleaned and measured.
#include "engine/cloud/gaussian_records.hpp"
#include "engine/core/named_values.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/point_bits.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/options.hpp"
#include "haptics/library/watch.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

FieldOptions fieldOptions(const PointCloud& cloud, const pp_prepare_options& given) {
  FieldOptions options{.mm_per_unit = mmPerUnit(cloud, given.mm_per_unit), .up = {}, .threads = 0};
  if (given.up) {
    options.up = valueNamed(kUpAxes, given.up);
    if (!options.up) throw UsageError("up: {}", unknownName("axis", given.up, namesOf(kUpAxes)));
  }
  if (!(given.mm_per_unit >= 0 && std::isfinite(given.mm_per_unit)))
    throw UsageError("mm_per_unit: {} is not a length", given.mm_per_unit);
  return options;
}

void requireCount(std::uint64_t count, const PointCloud& cloud) {
  if (count != cloud.size()) throw UsageError("count: is {}, but the cloud has {} points", count, cloud.size());
}

}  // namespace

pp_status pp_cloud_prepare(pp_cloud cloud, const pp_prepare_options* options, uint8_t* kept, uint64_t count,
                           pp_cloud* result) {
  clear(result);
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    const pp_prepare_options given = optionsFrom(options, "options");
    if (kept) requireCount(count, found->cloud);
    const Preparation preparation = given.steps ? parsePreparation(given.steps) : Preparation{};
    Watch watch(given.watch);
    PreparedCloud prepared;
    const auto prepare = [&](PointCloud from) {
      const FieldOptions fields = fieldOptions(from, given);
      watch.runCut([&] { prepared = palpate::prepared(std::move(from), preparation, fields); });
    };
    const bool hasGaussians = gaussiansOf(found->cloud) != nullptr;
    if (kept) {
      PointCloud points = found->cloud;
      forgetGaussians(points);  // a mask is of points
      prepare(std::move(points));
      std::fill_n(kept, count, std::uint8_t{0});
      for (const std::uint32_t point : prepared.numbers) kept[point] = 1;
    }
    if (!result) return;
    if (!kept || hasGaussians) prepare(found->cloud);
    ModelConfig source = found->source;
    const bool repeats = !source.prepare && !given.up && given.mm_per_unit == 0;
    if (repeats && preparation != Preparation{}) source.prepare = preparation;
    if (!repeats) source = {.file = "the cloud"};
    *result = opened<pp_cloud>(std::make_shared<CloudObject>(std::move(prepared.cloud), std::move(source)));
  });
}

pp_status pp_cloud_choose(pp_cloud cloud, const uint8_t* mask, uint64_t count, pp_cloud* result) {
  clear(result);
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    required(result, "result");
    requireCount(count, found->cloud);
    if (count > 0) required(mask, "mask");
    const PointSet chosen = PointBits::where(count, 0, [&](std::size_t i) { return mask[i] != 0; }).set();
    *result = opened<pp_cloud>(std::make_shared<CloudObject>(chosenPoints(found->cloud, chosen)));
  });
}

pp_status pp_cloud_compute(pp_cloud cloud, const char* number, const pp_prepare_options* options, double* values,
                           uint64_t count) {
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    const pp_prepare_options given = optionsFrom(options, "options");
    const std::string text = &required(number, "number");
    requireCount(count, found->cloud);
    if (count > 0) required(values, "values");
    Watch watch(given.watch);
    watch.runCut([&] {
      CloudFields fields(found->cloud, fieldOptions(found->cloud, given));
      std::ranges::copy(valuesOf("number", text, fields), values);
    });
  });
}
