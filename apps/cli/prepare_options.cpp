#include "apps/cli/prepare_options.hpp"

#include <filesystem>

#include "apps/cli/parse_list.hpp"
#include "apps/cli/setting_options.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

namespace {

// A whole number and, behind a comma, a length or a factor.
void readPair(const std::string& option, const std::string& text, const char* form, std::size_t& count, double& value,
              const Range& range) {
  const auto [first, second] = parseList<double, 2>(text, ',', option, form);
  if (!(first >= 1 && first <= bounds::kMaxNeighbours && first == static_cast<double>(static_cast<int>(first))))
    throw UsageError("{}: '{}' is not {}: the number is not a whole number from 1 to {}", option, text, form,
                     bounds::kMaxNeighbours);
  if (!(second >= range.min && second <= range.max))
    throw UsageError("{}: '{}' is not {}: {} is not a number from {} to {}", option, text, form, second, range.min,
                     range.max);
  count = static_cast<std::size_t>(first);
  value = second;
}

}  // namespace

std::optional<Preparation> PrepareOptions::given() const {
  Preparation all = preparation;
  if (!crop.empty()) all.crop = cornersIn(crop, "--crop");
  if (!cropOutside.empty()) all.cropOutside = cornersIn(cropOutside, "--crop-outside");
  if (!outliers.empty()) {
    const bool isPair = outliers.find(',') != std::string::npos;
    readPair("--outliers", isPair ? outliers : outliers + ",1", "K or K,SIGMA, as in 8,1", all.outlierNeighbours,
             all.outlierSigma, settingNamed<Preparation>("outlier_sigma").range);
  }
  if (!radiusOutliers.empty())
    readPair("--radius-outliers", radiusOutliers, "N,MM, as in 4,2.5", all.radiusNeighbours, all.radius_mm,
             settingNamed<Preparation>("radius_mm").range);
  if (all == Preparation{}) return std::nullopt;
  validate(all);
  return all;
}

void joinOutliers(std::vector<std::string>& arguments) {
  // Also those that given() refuses, unless there is such a file.
  const auto isNumbers = [](const std::string& word) {
    if (word.empty()) return false;
    if (word.find_first_not_of("0123456789.,-") == word.npos) return true;
    const bool begins = word[0] >= '0' && word[0] <= '9' && word.find(',') != word.npos;
    return begins && !std::filesystem::exists(word);
  };
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    if (arguments[i] != settingNamed<Preparation>("outlier_neighbours").flag || !isNumbers(arguments[i + 1])) continue;
    arguments[i] += "=" + arguments[i + 1];
    arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
}

void addPrepareOptions(Options& command, PrepareOptions& options) {
  const auto text = [&](const char* name, std::string& value, const char* form) {
    return addSettingFor<Preparation>(command, value, name).typeName(form);
  };
  // The number of neighbours, which given() checks.
  const Check neighbours{[](const std::string&) { return std::string(); }, "",
                         inWords(settingNamed<Preparation>("outlier_neighbours").range)};
  text("crop", options.crop, "X,Y,Z:X,Y,Z");
  text("crop_outside", options.cropOutside, "X,Y,Z:X,Y,Z");
  addSetting(command, options.preparation, "where").typeName("CONDITION");
  addSetting(command, options.preparation, "drop_duplicates");
  const Setting<Preparation>& outliers = settingNamed<Preparation>("outlier_neighbours");
  command.addFlag(std::string(outliers.flag), options.outliers, "8", std::string(outliers.help))
      .check(neighbours)
      .typeName("K,SIGMA");
  text("radius_neighbours", options.radiusOutliers, "N,MM").check(neighbours);
  addSetting(command, options.preparation, "fill_holes_mm");
  addSetting(command, options.preparation, "subsample_mm");
  addSetting(command, options.preparation, "random");
  addSetting(command, options.preparation, "seed").showDefault();
  addSetting(command, options.preparation, "set").repeatable().typeName("RULE");
  addSetting(command, options.preparation, "upright");
  addSetting(command, options.preparation, "level");
}

}  // namespace palpate
