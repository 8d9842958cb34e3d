#include "engine/io/camera_pose.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "engine/core/error.hpp"
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

}  // namespace palpate
