#include "engine/io/camera_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/list_lines.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr double kRounding = 0.02;  // tolerance of a matrix's or quaternion's entries: four decimals, or many products
constexpr double kLastRow = 1e-6;

glm::dmat3 turnOf(const std::array<double, 16>& rows) {
  glm::dmat3 turn;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      turn[column][row] = rows[4 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column)];
  return turn;
}

double farthestFromRotation(const glm::dmat3& turn) {
  const glm::dmat3 square = glm::transpose(turn) * turn;
  double farthest = 0;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      farthest = std::max(farthest, std::abs(square[column][row] - (row == column ? 1 : 0)));
  return farthest;
}

/// The orthogonal factor of the polar decomposition, by Newton's iteration (Higham 1986, section 3).
glm::dmat3 nearestRotation(glm::dmat3 turn) {
  constexpr int kSteps = 8;  // four steps suffice for errors up to a fiftieth
  for (int step = 0; step < kSteps; ++step) turn = 0.5 * (turn + glm::inverse(glm::transpose(turn)));
  return turn;
}

using Json = nlohmann::json;

constexpr std::size_t kMaxCameraFile = std::size_t{1} << 20;  // bytes

[[noreturn]] void failType(const char* name, const Json& json) {
  throw Error("\"{}\" cannot be {}", name, json.dump().substr(0, 40));
}

std::optional<double> numberIn(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) return std::nullopt;
  if (!found->is_number() || !std::isfinite(found->get<double>())) failType(name, *found);
  return found->get<double>();
}

/// `brief`: another name of it.
double needed(const Json& json, const char* name, const char* brief = nullptr) {
  auto value = numberIn(json, name);
  if (!value && brief) value = numberIn(json, brief);
  if (!value) throw Error("has no \"{}\"", name);
  return *value;
}

template <std::size_t count>
std::array<double, count> numbersOf(const char* name, const Json& json) {
  if (!json.is_array() || json.size() != count) throw Error("\"{}\" is not a list of {} numbers", name, count);
  std::array<double, count> numbers;
  for (std::size_t k = 0; k < count; ++k) {
    if (!json[k].is_number()) failType(name, json[k]);
    numbers[k] = json[k].get<double>();
  }
  return numbers;
}

std::uint32_t sideIn(const Json& json, const char* name, const char* brief) {
  const double side = needed(json, name, brief);
  if (!(side >= 1 && side <= kLongestImageSide) || side != std::floor(side))
    throw Error("\"{}\" is {}; expected a whole number of pixels from 1 to {}", name, side, kLongestImageSide);
  return static_cast<std::uint32_t>(side);
}

void check(const DepthCamera& camera) {
  if (!(camera.fx > 0 && camera.fy > 0))
    throw Error("the focal lengths are {} and {} pixels; both must be above 0", camera.fx, camera.fy);
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) throw Error("the principal point is not finite");
}

DepthCamera cameraIn(const Json& json) {
  DepthCamera camera{.width = sideIn(json, "width", "w"), .height = sideIn(json, "height", "h")};
  if (const auto matrix = json.find("intrinsic_matrix"); matrix != json.end()) {
    const auto columns = numbersOf<9>("intrinsic_matrix", *matrix);
    camera.fx = columns[0], camera.fy = columns[4], camera.cx = columns[6], camera.cy = columns[7];
    if (columns[8] != 1 || columns[2] != 0 || columns[5] != 0)
      throw Error("the last row of \"intrinsic_matrix\" is not 0 0 1; the matrix is stored column by column");
    if (columns[3] != 0 || columns[1] != 0) throw Error("\"intrinsic_matrix\" has a skew, which is not supported");
  } else {
    camera.fx = needed(json, "fx"), camera.fy = needed(json, "fy");
    camera.cx = needed(json, "cx"), camera.cy = needed(json, "cy");
  }
  check(camera);
  return camera;
}

/// All numbers of a text; nothing if there are other words.
std::optional<std::vector<double>> numbersOf(const std::filesystem::path& file) {
  std::vector<double> numbers;
  for (ListLines lines(file); lines.next();)
    while (true) {
      const std::string_view word = takeWord(lines.rest());
      if (word.empty()) break;
      const auto number = textNumber<double>(word);
      if (!number) return std::nullopt;
      numbers.push_back(*number);
    }
  return numbers;
}

DepthCamera cameraOf(const std::vector<double>& numbers, ImageSize size) {
  DepthCamera camera{.width = size.width, .height = size.height};
  if (numbers.size() == 4) {
    camera.fx = numbers[0], camera.fy = numbers[1], camera.cx = numbers[2], camera.cy = numbers[3];
  } else if (numbers.size() == 9 || numbers.size() == 16) {
    const std::size_t row = numbers.size() == 9 ? 3 : 4;
    if (numbers[2 * row] != 0 || numbers[2 * row + 1] != 0 || numbers[2 * row + 2] != 1)
      throw Error("the third row of the matrix of intrinsics does not begin with 0 0 1");
    if (numbers[1] != 0 || numbers[row] != 0)
      throw Error("the matrix of intrinsics has a skew, which is not supported");
    camera.fx = numbers[0], camera.fy = numbers[row + 1], camera.cx = numbers[2], camera.cy = numbers[row + 2];
  } else {
    throw Error("has {} numbers; intrinsics are a 3x3 or 4x4 matrix, or fx, fy, cx and cy", numbers.size());
  }
  check(camera);
  if (!(camera.cx >= 0 && camera.cx < size.width && camera.cy >= 0 && camera.cy < size.height))
    throw Error(
        "the principal point {}, {} lies beside the pictures of {} x {} pixels; these are the intrinsics of "
        "another camera",
        camera.cx, camera.cy, size.width, size.height);
  return camera;
}

}  // namespace

CameraPose cameraPose(const std::array<double, 16>& rows) {
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (!std::isfinite(rows[k]))
      throw Error("the pose has {} in row {}, column {}; expected a finite number", rows[k], k / 4 + 1, k % 4 + 1);
  for (std::size_t column = 0; column < 4; ++column)
    if (std::abs(rows[12 + column] - (column == 3 ? 1 : 0)) > kLastRow)
      throw Error("the last row of the pose is {} {} {} {}; expected 0 0 0 1", rows[12], rows[13], rows[14], rows[15]);
  const glm::dmat3 turn = turnOf(rows);
  const double wrong = farthestFromRotation(turn);
  if (!(wrong <= kRounding))
    throw Error("the first three columns of the pose are not a rotation: their products are wrong by {:.3g}", wrong);
  if (glm::determinant(turn) < 0) throw Error("the pose mirrors; its first three columns are not a rotation");
  return {.turn = glm::normalize(glm::quat_cast(nearestRotation(turn))), .centre = {rows[3], rows[7], rows[11]}};
}

CameraPose cameraPose(const DVec3& centre, const DQuat& turn) {
  if (!isFinite(centre)) throw Error("the position of the pose is not finite");
  const double size = std::sqrt(glm::dot(turn, turn));
  if (!(std::abs(size - 1) <= kRounding))
    throw Error("the quaternion of the pose has the length {:.3g}; expected 1", size);
  return {.turn = turn / size, .centre = centre};
}

CameraPose between(const CameraPose& from, const CameraPose& to, double share) {
  return {.turn = glm::normalize(glm::slerp(from.turn, to.turn, share)),
          .centre = glm::mix(from.centre, to.centre, share)};
}

std::string_view takeWord(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

template <std::size_t count>
std::optional<std::array<double, count>> numbersIn(std::string_view line) {
  std::array<double, count> numbers;
  for (double& number : numbers) {
    const auto value = textNumber<double>(takeWord(line));
    if (!value) return std::nullopt;
    number = *value;
  }
  if (!takeWord(line).empty()) return std::nullopt;
  return numbers;
}
template std::optional<std::array<double, 3>> numbersIn<3>(std::string_view);
template std::optional<std::array<double, 4>> numbersIn<4>(std::string_view);
template std::optional<std::array<double, 8>> numbersIn<8>(std::string_view);
template std::optional<std::array<double, 12>> numbersIn<12>(std::string_view);
template std::optional<std::array<double, 16>> numbersIn<16>(std::string_view);

CameraText parseCamera(std::string_view json) {
  Json parsed = Json::parse(json, nullptr, false);
  if (parsed.is_discarded()) throw Error("is not valid JSON");
  if (parsed.is_object() && parsed.contains("camera")) parsed = Json(parsed["camera"]);
  if (!parsed.is_object()) throw Error("is not a JSON object");
  CameraText text{
      .camera = cameraIn(parsed), .depthScale = numberIn(parsed, "depth_scale"), .rate_Hz = numberIn(parsed, "fps")};
  if (!text.depthScale) text.depthScale = numberIn(parsed, "scale");
  if (text.depthScale && !(*text.depthScale >= kMinDepthScale && *text.depthScale <= kMaxDepthScale))
    throw Error("\"depth_scale\" is {}; expected the number of values per metre, {} to {}", *text.depthScale,
                kMinDepthScale, kMaxDepthScale);
  if (text.rate_Hz && !(*text.rate_Hz > 0)) throw Error("\"fps\" is {}; it must be above 0", *text.rate_Hz);
  if (const auto format = parsed.find("format"); format != parsed.end()) {
    if (!format->is_string()) failType("format", *format);
    text.format = format->get<std::string>();
  }
  if (const auto pose = parsed.find("pose"); pose != parsed.end()) text.pose = cameraPose(numbersOf<16>("pose", *pose));
  return text;
}

CameraText readCamera(const std::filesystem::path& file, std::optional<ImageSize> size) {
  try {
    if (const auto numbers = numbersOf(file)) {
      if (!size) throw Error("the size of the pictures is unknown");
      return {.camera = cameraOf(*numbers, *size)};
    }
    ChunkedFile in(file);
    const auto bytes = in.peek(kMaxCameraFile + 1);
    if (bytes.size() > kMaxCameraFile) throw FileError(file, "is too long for the intrinsics of a camera");
    return parseCamera({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } catch (const FileError&) {
    throw;
  } catch (const Error& error) {
    throw FileError(file,
                    fmt::format("{}; expected intrinsics as JSON with width, height, fx, fy, cx, cy", error.what()));
  }
}

}  // namespace palpate
