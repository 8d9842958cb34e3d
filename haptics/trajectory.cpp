#include "haptics/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <optional>

#include "engine/core/atomic_file.hpp"
#include "haptics/text_lines.hpp"

namespace palpate {
namespace {

constexpr std::size_t kWithoutForces = 4, kWithForces = 7;

bool parts(char c) { return c == ',' || c == ';' || c == '\t' || c == ' '; }

// Blanks beside a comma do not separate, and two commas have an empty field between them.
std::vector<std::string_view> fieldsOf(std::string_view line) {
  const bool byBlanks = line.find_first_of(",;") == std::string_view::npos;
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = byBlanks ? line.find_first_of(" \t") : line.find_first_of(",;");
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line = byBlanks ? trimmed(line.substr(end)) : line.substr(end + 1);
  }
}

bool isNames(std::string_view line) {
  const auto last = std::ranges::find_if(line, parts);
  const std::string_view first = trimmed({line.begin(), last});
  return !first.empty() && (std::isalpha(static_cast<unsigned char>(first.front())) != 0);
}

/// Indices of the columns.
struct Layout {
  std::size_t columns = 0, time = 0;
  std::array<std::size_t, 3> position{1, 2, 3};
  std::optional<std::array<std::size_t, 3>> force;
};

std::optional<std::array<std::size_t, 3>> threeOf(const std::vector<std::string_view>& names,
                                                  std::initializer_list<std::array<std::string_view, 3>> choices) {
  for (const auto& choice : choices) {
    std::array<std::size_t, 3> places{};
    for (std::size_t k = 0; k < 3; ++k)
      places[k] = static_cast<std::size_t>(std::ranges::find(names, choice[k]) - names.begin());
    if (std::ranges::max(places) < names.size()) return places;
  }
  return std::nullopt;
}

Layout named(const std::vector<std::string_view>& names, const TextLines& lines) {
  Layout layout{.columns = names.size()};
  const auto time = std::ranges::find_if(
      names, [](std::string_view name) { return name == "t_s" || name == "t" || name == "time" || name == "time_s"; });
  if (time == names.end()) lines.fail("no column of times; one must be called t_s, t, time or time_s");
  layout.time = static_cast<std::size_t>(time - names.begin());
  const auto position =
      threeOf(names, {{"x", "y", "z"}, {"hip_x", "hip_y", "hip_z"}, {"px", "py", "pz"}, {"pos_x", "pos_y", "pos_z"}});
  if (!position) lines.fail("no columns of positions; they must be called x, y, z or hip_x …, px … or pos_x …");
  layout.position = *position;
  layout.force = threeOf(names, {{"force_x", "force_y", "force_z"}, {"fx", "fy", "fz"}});
  return layout;
}

Layout byCount(std::size_t columns, const TextLines& lines) {
  if (columns == kWithoutForces) return {.columns = columns};
  if (columns == kWithForces) return {.columns = columns, .force = std::array<std::size_t, 3>{4, 5, 6}};
  lines.fail(
      fmt::format("{} columns; without a line of names a sample has 4 (time, position) or 7 (and force)", columns));
}

DVec3 vectorAt(const std::vector<std::string_view>& fields, const std::array<std::size_t, 3>& places,
               const TextLines& lines) {
  return {lines.number(fields[places[0]]), lines.number(fields[places[1]]), lines.number(fields[places[2]])};
}

}  // namespace

Path Trajectory::path() const {
  std::vector<PathKey> keys;
  keys.reserve(samples.size());
  for (const TrajectorySample& sample : samples) keys.push_back({sample.t_s, sample.position});
  return Path(std::move(keys));
}

DVec3 Trajectory::force_N(double t_s) const noexcept {
  const auto after = std::ranges::upper_bound(samples, t_s, {}, &TrajectorySample::t_s);
  if (after == samples.begin()) return samples.front().force_N;
  if (after == samples.end()) return samples.back().force_N;
  const TrajectorySample& from = *(after - 1);
  return from.force_N + (t_s - from.t_s) / (after->t_s - from.t_s) * (after->force_N - from.force_N);
}

Trajectory readTrajectory(const std::filesystem::path& file) {
  TextLines lines(file);
  std::optional<std::string_view> line = lines.next();
  if (!line) lines.fail("the file is empty; a sample is a line of time, position and force");
  std::optional<Layout> layout;
  if (isNames(*line)) {
    layout = named(fieldsOf(*line), lines);
    line = lines.next();
  }
  Trajectory trajectory;
  for (; line; line = lines.next()) {
    const auto fields = fieldsOf(*line);
    if (!layout) layout = byCount(fields.size(), lines);
    if (fields.size() != layout->columns)
      lines.fail(fmt::format("{} columns; the lines before have {}", fields.size(), layout->columns));
    TrajectorySample sample{.t_s = lines.number(fields[layout->time]),
                            .position = vectorAt(fields, layout->position, lines)};
    if (layout->force) sample.force_N = vectorAt(fields, *layout->force, lines);
    if (sample.t_s < 0) lines.fail("the time is negative; a session begins at 0");
    if (!trajectory.samples.empty() && sample.t_s <= trajectory.samples.back().t_s)
      lines.fail(fmt::format("times must ascend, and {} follows {}", sample.t_s, trajectory.samples.back().t_s));
    trajectory.samples.push_back(sample);
  }
  if (trajectory.samples.empty()) lines.fail("no sample follows the names of the columns");
  trajectory.hasForces = layout->force.has_value();
  return trajectory;
}

void writeTrajectory(const std::filesystem::path& file, const Trace& trace) {
  const bool csv = file.extension() == ".csv";
  const std::string_view parting = csv ? "," : " ";
  AtomicFile out(file);
  if (csv) out.write("t_s,x,y,z,force_x,force_y,force_z\n");
  fmt::memory_buffer text;
  for (const TraceRow& row : trace.rows) {
    text.clear();
    fmt::format_to(std::back_inserter(text), "{}", row.time_s + 0.0);  // adding zero turns -0 into 0
    for (const DVec3& v : {row.hip, row.force_N})
      for (int k = 0; k < 3; ++k) fmt::format_to(std::back_inserter(text), "{}{}", parting, v[k] + 0.0);
    text.push_back('\n');
    out.write(std::string_view(text.data(), text.size()));
  }
  out.commit();
}

ForceDifference compareForces(const Trace& trace, const Trajectory& recorded) {
  ForceDifference difference;
  double squares = 0;
  for (const TraceRow& row : trace.rows) {
    if (row.time_s < recorded.samples.front().t_s || row.time_s > recorded.samples.back().t_s) continue;
    const double apart_N = glm::distance(row.force_N, recorded.force_N(row.time_s));
    squares += apart_N * apart_N;
    difference.worst_N = std::max(difference.worst_N, apart_N);
    ++difference.ticks;
  }
  if (difference.ticks > 0) difference.rms_N = std::sqrt(squares / static_cast<double>(difference.ticks));
  return difference;
}

}  // namespace palpate
