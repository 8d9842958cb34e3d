#include "engine/io/colmap_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxModelLine = std::size_t{1} << 28;  // an image's observations are one line
constexpr std::size_t kLongestName = 4096;
constexpr std::string_view kBlanks = " \t";

/// Indexed by their numbers in binary files (COLMAP 4.1).
constexpr std::array<CameraModel, 18> kCameraModels{{{"SIMPLE_PINHOLE", 3},
                                                     {"PINHOLE", 4},
                                                     {"SIMPLE_RADIAL", 4},
                                                     {"RADIAL", 5},
                                                     {"OPENCV", 8},
                                                     {"OPENCV_FISHEYE", 8},
                                                     {"FULL_OPENCV", 12},
                                                     {"FOV", 5},
                                                     {"SIMPLE_RADIAL_FISHEYE", 4},
                                                     {"RADIAL_FISHEYE", 5},
                                                     {"THIN_PRISM_FISHEYE", 12},
                                                     {"RAD_TAN_THIN_PRISM_FISHEYE", 16},
                                                     {"SIMPLE_DIVISION", kUnknownCount},
                                                     {"DIVISION", kUnknownCount},
                                                     {"SIMPLE_FISHEYE", kUnknownCount},
                                                     {"FISHEYE", kUnknownCount},
                                                     {"EUCM", kUnknownCount},
                                                     {"EQUIRECTANGULAR", kUnknownCount}}};
constexpr CameraModel kUnknownModel{"unknown", kUnknownCount};

class BinaryModelRows final : public ColmapRows {
 public:
  /// `unknownParameters`: number of parameters of a camera whose model is unknown.
  BinaryModelRows(const std::filesystem::path& path, std::function<void(double)> progress,
                  std::size_t unknownParameters)
      : file_(path), unknownParameters_(unknownParameters) {
    file_.onProgress(std::move(progress));
    count_ = take<std::uint64_t>("the number of rows");
  }

  bool next() override {
    if (done_ == count_) {
      if (!file_.peek(1).empty()) fail(fmt::format("unexpected data after the last of {} rows", count_));
      return false;
    }
    ++done_;
    return true;
  }
  double real(std::string_view what) override { return take<double>(what); }
  std::uint64_t whole(std::string_view what) override { return take<std::uint64_t>(what); }
  std::uint32_t id(std::string_view what) override { return take<std::uint32_t>(what); }
  std::uint8_t channel() override { return take<std::uint8_t>("a colour"); }
  const CameraModel& cameraModel() override {
    const auto number = take<std::int32_t>("the model of a camera");
    if (number < 0) fail(fmt::format("camera model {}; expected a number of 0 or more", number));
    const auto model = static_cast<std::size_t>(number);
    const CameraModel& known = model < kCameraModels.size() ? kCameraModels[model] : kUnknownModel;
    if (known.parameters == kUnknownCount && unknownParameters_ == kUnknownCount) throw UnknownModel(number);
    return known;
  }
  bool hasParameter(std::size_t taken) override { return taken < unknownParameters_; }
  std::string name() override {
    std::string name;
    while (const char c = take<char>("the name of an image")) {
      if (name.size() == kLongestName) fail(fmt::format("a name of more than {} bytes", kLongestName));
      name += c;
    }
    return name;
  }
  void skipObservations() override {
    constexpr std::uint64_t kBytes = 24, kMax = std::numeric_limits<std::uint64_t>::max() / kBytes;
    const auto count = take<std::uint64_t>("the number of observations");
    if (count > kMax || !file_.skip(kBytes * count))
      fail(fmt::format("the file ends within the {} observations of an image", count));
  }
  std::uint64_t track() override { return take<std::uint64_t>("the length of a track"); }
  void endRow() override {}
  [[noreturn]] void fail(std::string_view what) const override {
    throw FileError::atByte(file_.path(), file_.offset(), what);
  }
  std::uint64_t count() override { return count_; }

 private:
  template <class T>
  T take(std::string_view what) {
    static_assert(std::endian::native == std::endian::little, "the files are little-endian");
    const auto bytes = file_.peek(sizeof(T));
    if (bytes.size() < sizeof(T))
      fail(fmt::format("the file ends where {} should be, in row {} of {}", what, done_, count_));
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    file_.consume(sizeof value);
    return value;
  }

  ChunkedFile file_;
  std::size_t unknownParameters_;
  std::uint64_t count_ = 0, done_ = 0;
};

class TextModelRows final : public ColmapRows {
 public:
  TextModelRows(const std::filesystem::path& path, std::function<void(double)> progress, bool haveObservations)
      : file_(path), haveObservations_(haveObservations) {
    file_.onProgress(std::move(progress));
  }

  bool next() override {
    do {
      const auto line = std::exchange(ahead_, std::nullopt);
      const auto read = line ? line : file_.readLine(kMaxModelLine);
      if (!read) return false;
      rest_ = *read;
    } while (rest_.empty() || rest_.front() == '#');
    return true;
  }
  double real(std::string_view what) override { return number<double>(what); }
  std::uint64_t whole(std::string_view what) override { return number<std::uint64_t>(what); }
  std::uint32_t id(std::string_view what) override { return number<std::uint32_t>(what); }
  std::uint8_t channel() override { return number<std::uint8_t>("a colour from 0 to 255"); }
  const CameraModel& cameraModel() override {
    const std::string_view name = word();
    for (const CameraModel& model : kCameraModels)
      if (model.name == name) return model;
    return kUnknownModel;
  }
  bool hasParameter(std::size_t) override {
    skipBlanks();
    return !rest_.empty();
  }
  std::string name() override {
    skipBlanks();
    std::string name(rest_);
    rest_ = {};
    return name;
  }
  // Observations are on a line of their own, which may be empty; other programs leave it out.
  void skipObservations() override {
    rest_ = {};
    const auto line = file_.readLine(kMaxModelLine);
    if (line && !areObservations(*line)) ahead_ = line;
  }
  std::uint64_t track() override {
    std::uint64_t words = 0;
    for (std::string_view all = rest_; !all.empty();) {
      const std::size_t begin = all.find_first_not_of(kBlanks);
      if (begin == all.npos) break;
      ++words;
      all.remove_prefix(std::min(all.find_first_of(kBlanks, begin), all.size()));
    }
    if (words % 2 != 0)
      fail(fmt::format("a track of {} numbers; expected pairs of an image and a position in it", words));
    return words / 2;
  }
  void endRow() override {
    skipBlanks();
    if (!rest_.empty()) fail(fmt::format("{} follows the last number of a row", inQuotes(rest_)));
  }
  [[noreturn]] void fail(std::string_view what) const override {
    throw FileError::atLine(file_.path(), file_.line(), what);
  }
  std::uint64_t count() override {
    std::uint64_t rows = 0;
    for (; next(); ++rows)
      if (haveObservations_) skipObservations();
    return rows;
  }

 private:
  /// Whether a line behind an image consists of triples of numbers, rather than of the ten words of the next image.
  static bool areObservations(std::string_view line) {
    constexpr unsigned kEnough = 12;  // behind the name of an image, which may be a number
    unsigned words = 0;
    for (; words < kEnough; ++words) {
      const std::string_view found = takeWord(line);
      if (found.empty()) break;
      if (!textNumber<double>(found)) return false;
    }
    return words % 3 == 0;
  }
  void skipBlanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size())); }
  std::string_view word() {
    skipBlanks();
    const std::string_view found = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(found.size());
    return found;
  }
  template <class T>
  T number(std::string_view what) {
    const std::string_view found = word();
    if (found.empty()) fail(fmt::format("the line ends where {} should be", what));
    const auto value = textNumber<T>(found);
    if (!value) fail(fmt::format("found {}, expected {}", inQuotes(found), what));
    return *value;
  }

  ChunkedFile file_;
  bool haveObservations_;
  std::string_view rest_;                  // of the line, valid until the next one is read
  std::optional<std::string_view> ahead_;  // a line that was read, but is of the next row
};

}  // namespace

bool hasColmapFile(const std::filesystem::path& folder, std::string_view stem) {
  for (const std::string_view form : {"bin", "txt"})
    if (isFile(folder / fmt::format("{}.{}", stem, form))) return true;
  return false;
}

std::unique_ptr<ColmapRows> openColmap(const std::filesystem::path& folder, std::string_view stem,
                                       std::function<void(double)> progress, std::size_t unknownParameters) {
  const std::filesystem::path binary = folder / fmt::format("{}.bin", stem);
  const std::filesystem::path text = folder / fmt::format("{}.txt", stem);
  if (isFile(binary)) return std::make_unique<BinaryModelRows>(binary, std::move(progress), unknownParameters);
  if (isFile(text)) return std::make_unique<TextModelRows>(text, std::move(progress), stem == kImages);
  throw FileError(folder, fmt::format("has neither {0}.bin nor {0}.txt, one of which a COLMAP model requires", stem));
}

}  // namespace palpate
