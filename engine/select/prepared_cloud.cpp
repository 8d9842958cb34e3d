#include "engine/select/prepared_cloud.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numeric>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/units.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/cleaning.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/field_rule.hpp"
#include "engine/select/gaussian_centers.hpp"
#include "engine/select/move_points.hpp"
#include "engine/select/small_holes.hpp"

namespace palpate {

namespace {

std::string conditionOf(const Corners& corners) {
  const DVec3 low = glm::min((*corners)[0], (*corners)[1]), high = glm::max((*corners)[0], (*corners)[1]);
  std::string text;
  for (int k = 0; k < 3; ++k)
    text += fmt::format("{0}{1} >= {2} && {1} <= {3}", k == 0 ? "" : " && ", "xyz"[k], low[k], high[k]);
  return text;
}

constexpr std::uint32_t kNew = ~0u;  // in place of a number

/// Does the steps, and keeps account of the points.
class Preparer {
 public:
  /// `noun`: what the points are.
  Preparer(PointCloud cloud, std::string_view noun, std::size_t steps, const FieldOptions& options,
           const std::function<void(const PreparedStep&)>& report)
      : noun_(noun), steps_(steps), options_(options), report_(report), up_(options.up) {
    result_.cloud = std::move(cloud);
    result_.numbers.resize(result_.cloud.size());
    std::iota(result_.numbers.begin(), result_.numbers.end(), 0u);
  }

  void keep(std::string_view name, const PointSet& which, const std::string& dropped = {}) {
    const std::size_t before = cloud().size();
    std::vector<std::uint32_t> numbers;
    numbers.reserve(which.count());
    which.forEach([&](std::uint64_t point) { numbers.push_back(result_.numbers[point]); });
    if (numbers.size() < before) {
      result_.cloud = chosenPoints(cloud(), which, options_.threads);
      result_.numbers = std::move(numbers);
    }
    done(name, before, fmt::format("keeps {} of {}{}", cloud().size(), counted(before, noun_), dropped));
  }
  void dropOutliers(const Preparation& preparation, const DistanceMaker& distances) {
    const PointSet which = statisticalOutliers(cloud(), static_cast<std::uint32_t>(preparation.outlierNeighbours),
                                               preparation.outlierSigma, options_.threads, distances,
                                               [this](double share) { progressed(share); });
    keep("prepare.outlier_neighbours", othersThan(which, cloud().size()),
         ", and drops " + outlierShare(which.count(), cloud().size()));
  }
  void drop(std::string_view name, const PointSet& which) { keep(name, othersThan(which, cloud().size())); }
  void where(std::string_view name, std::string_view condition, bool holds = true) {
    CloudFields fields(cloud(), options_);
    const PointSet which = pointsWhere(name, condition, fields);
    holds ? keep(name, which) : drop(name, which);
  }
  void set(const std::string& rule) {
    const RuleEffect effect = applyRule("prepare.set", rule, result_.cloud, options_);
    std::string what = fmt::format("\"{}\" sets {}", rule, counted(effect.set, noun_));
    if (effect.notFinite > 0) what += fmt::format(", {} of them to inf or nan", effect.notFinite);
    done("prepare.set", cloud().size(), std::move(what));
  }
  void fillHoles(double widest) {
    const std::size_t before = cloud().size();
    const HoleFilling filling = palpate::fillHoles(cloud(), widest, options_.threads);
    addPoints(result_.cloud, filling.points);
    result_.numbers.resize(cloud().size(), kNew);
    done("prepare.fill_holes_mm", before, inWords(filling, options_.mm_per_unit));
  }
  void rotateUp(UpAxis up) {
    rotateToZ(result_.cloud, directionOf(up));
    setUp(result_.cloud.storedAs.comments, UpAxis::z);
    up_ = UpAxis::z;
    done("prepare.upright", cloud().size(), fmt::format("rotates {} to z", nameOf(up)));
  }
  void level() {
    const auto ground = findGround(cloud(), up_);
    if (!ground)
      throw ConfigError(
          "prepare.level",
          "no ground was found: no plane below the rest has a twentieth of the surface; state the up axis, "
          "or crop to the part that stands on the ground");
    rotateToZ(result_.cloud, ground->normal);
    setUp(result_.cloud.storedAs.comments, UpAxis::z);
    done("prepare.level", cloud().size(),
         fmt::format("rotates by {:.3f} degrees; the ground has {:.0f} % of the surface",
                     angleBetween_deg(ground->normal, DVec3(0, 0, 1)), 100 * ground->share));
  }

  const PointCloud& cloud() const { return result_.cloud; }
  double toUnits(double length_mm) const { return length_mm / options_.mm_per_unit; }
  PreparedCloud result() {
    result_.numbers.erase(std::ranges::find(result_.numbers, kNew), result_.numbers.end());
    return std::move(result_);
  }

 private:
  void done(std::string_view name, std::size_t before, std::string what) {
    progressed(1);
    result_.steps.push_back({name, before, cloud().size(), std::move(what)});
    if (report_) report_(result_.steps.back());
  }
  // `share`: of the present step.
  void progressed(double share) const {
    const auto done = static_cast<double>(result_.steps.size()) + share;
    if (options_.progress) options_.progress(done / static_cast<double>(steps_));
  }

  std::string_view noun_;
  std::size_t steps_;  // number of them
  const FieldOptions& options_;
  const std::function<void(const PreparedStep&)>& report_;
  std::optional<UpAxis> up_;
  PreparedCloud result_;
};

}  // namespace

Corners cornersIn(std::string_view text, std::string_view name) {
  const auto wrong = [&] {
    return UsageError("{}: '{}' is not two corners of a box, as in 0,0,0:1.5,2,1", name, text);
  };
  std::array<DVec3, 2> corners;
  const char *at = text.data(), *const end = at + text.size();
  for (int k = 0; k < 6; ++k) {
    const auto [next, error] = std::from_chars(at, end, corners[static_cast<std::size_t>(k / 3)][k % 3]);
    const char* const separator = k == 2 ? ":" : ",";
    if (error != std::errc() || (k < 5 ? next == end || *next != *separator : next != end)) throw wrong();
    at = next + (k < 5 ? 1 : 0);
  }
  if (!isFinite(corners[0]) || !isFinite(corners[1])) throw wrong();
  return corners;
}

std::string cornersText(const Corners& corners) {
  if (!corners) return {};
  const auto& [a, b] = *corners;
  return fmt::format("{},{},{}:{},{},{}", a.x, a.y, a.z, b.x, b.y, b.z);
}

namespace {

double touchScaleOf(const PointCloud& cloud) {
  if (const auto scale = touchScaleSaidIn(cloud.storedAs.comments)) return *scale;
  return ModelScale::fitting(coreBoundsOf(cloud).longestSide()).mm_per_unit;
}

}  // namespace

double mmPerUnit(const PointCloud& cloud, double given) {
  if (given > 0) return given;
  const std::vector<std::string>& comments = cloud.storedAs.comments;
  if (const auto scale = scaleSaidIn(comments)) return *scale;
  if (const auto mm = mmIn(unitSaidIn(comments))) return *mm;
  return touchScaleOf(cloud);
}

namespace {

PreparedCloud preparedPoints(PointCloud cloud, std::string_view noun, const Preparation& preparation,
                             const FieldOptions& options, const std::function<void(const PreparedStep&)>& report,
                             const DistanceMaker& distances) {
  std::size_t steps = preparation.set.size();
  for (const bool isWanted :
       {preparation.crop.has_value(), preparation.cropOutside.has_value(), !preparation.where.empty(),
        preparation.dropDuplicates, preparation.outlierNeighbours > 0, preparation.radiusNeighbours > 0,
        preparation.fillHoles_mm > 0, preparation.subsample_mm > 0, preparation.random > 0,
        preparation.upright.has_value(), preparation.level})
    steps += isWanted ? 1 : 0;
  Preparer preparer(std::move(cloud), noun, steps, options, report);
  const unsigned threads = options.threads;
  if (preparation.crop) preparer.where("prepare.crop", conditionOf(preparation.crop));
  if (preparation.cropOutside) preparer.where("prepare.crop_outside", conditionOf(preparation.cropOutside), false);
  if (!preparation.where.empty()) preparer.where("prepare.where", preparation.where);
  if (preparation.dropDuplicates) preparer.drop("prepare.drop_duplicates", duplicatePoints(preparer.cloud(), threads));
  if (preparation.outlierNeighbours > 0) preparer.dropOutliers(preparation, distances);
  if (preparation.radiusNeighbours > 0)
    preparer.drop("prepare.radius_neighbours",
                  radiusOutliers(preparer.cloud(), static_cast<std::uint32_t>(preparation.radiusNeighbours),
                                 preparer.toUnits(preparation.radius_mm), threads));
  if (preparation.fillHoles_mm > 0) preparer.fillHoles(preparer.toUnits(preparation.fillHoles_mm));
  if (preparation.subsample_mm > 0)
    preparer.keep("prepare.subsample_mm",
                  onePointPerCell(preparer.cloud(), preparer.toUnits(preparation.subsample_mm), threads));
  if (preparation.random > 0)
    preparer.keep("prepare.random", randomPoints(preparer.cloud().size(), preparation.random, preparation.seed));
  for (const std::string& rule : preparation.set) preparer.set(rule);
  if (preparation.upright) preparer.rotateUp(*preparation.upright);
  if (preparation.level && !preparer.cloud().empty()) preparer.level();
  return preparer.result();
}

PreparedCloud preparedAll(PointCloud cloud, const Preparation& preparation, const FieldOptions& options,
                          const std::function<void(const PreparedStep&)>& report, const DistanceMaker& distances,
                          SplatSurface surface) {
  const Preparation rotating{.upright = preparation.upright, .level = preparation.level};
  Preparation selecting = preparation;
  selecting.upright.reset(), selecting.level = false;
  const GaussianRecords* const gaussians = gaussiansOf(cloud);
  if (!gaussians || selecting == Preparation{})
    return preparedPoints(std::move(cloud), "point", preparation, options, report, distances);
  if (preparation.fillHoles_mm > 0) throw ConfigError("prepare.fill_holes_mm", "{}", kGaussiansKeepHoles);
  const bool namesFields = !preparation.where.empty() || !preparation.set.empty();
  const GaussianCenters centers = centersOf(*gaussians, namesFields, options.threads);
  PreparedCloud result = preparedPoints(centers.cloud, "Gaussian", selecting, options, report, distances);
  auto changed = changedGaussians(*gaussians, centers, result.cloud, result.numbers, options.threads);
  result.numbers.clear();
  if (surface == SplatSurface::none && rotating == Preparation{}) {
    result.cloud = {};
    result.cloud.storedAs = cloud.storedAs;
    result.cloud.storedAs.baggage = std::move(changed);
    return result;
  }
  result.cloud = surfacePointsOf(std::move(changed), cloud.storedAs, options.threads);
  if (rotating == Preparation{}) return result;
  PreparedCloud rotated = preparedPoints(std::move(result.cloud), "point", rotating, options, report, {});
  result.cloud = std::move(rotated.cloud);
  std::ranges::move(rotated.steps, std::back_inserter(result.steps));
  return result;
}

bool removesPoints(Preparation preparation) {
  preparation.fillHoles_mm = 0;
  preparation.set.clear();
  preparation.upright.reset();
  preparation.level = false;
  return preparation != Preparation{};
}

}  // namespace

PreparedCloud prepared(PointCloud cloud, const Preparation& preparation, const FieldOptions& options,
                       const std::function<void(const PreparedStep&)>& report, const DistanceMaker& distances,
                       SplatSurface surface) {
  if (!removesPoints(preparation))
    return preparedAll(std::move(cloud), preparation, options, report, distances, surface);
  const Upright upright = findUp(cloud);
  const double touchScale = touchScaleOf(cloud);
  PreparedCloud result = preparedAll(std::move(cloud), preparation, options, report, distances, surface);
  const auto removes = [](const PreparedStep& step) { return step.after < step.before; };
  if (std::ranges::none_of(result.steps, removes)) return result;
  const auto moves = [](const std::string& rule) { return movesPoints("prepare.set", rule); };
  if (std::ranges::any_of(preparation.set, moves)) return result;  // its units may be others
  keepPose(result.cloud.storedAs.comments, touchScale, upright.up);
  if (!preparation.upright && !preparation.level) result.upright = upright;
  return result;
}

}  // namespace palpate
