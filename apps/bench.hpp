// What the benches share: the models that are measured, a record for every measurement, and tables of them.
#pragma once

#include "apps/backend.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"

namespace palpate {

/// Of `bench touch` alone.
struct TouchBenchOptions {
  std::vector<std::string> surfaces, shapes, conditions;
  std::string truthFile;  ///< the mesh that the models are scans of
  bool quick = false;
};
/// Adds them, and sets them to all that there is.
void addTouchBenchOptions(CLI::App& sub, TouchBenchOptions& options);

/// Of `bench edit` alone.
struct EditBenchOptions {
  std::string brush = "push";
  std::vector<std::string> indexes{"incremental", "rebuild"};
  std::vector<std::int64_t> touched{100, 1000, 10'000};
  double duration_s = 0;  ///< of a stroke in real time; 0: virtual time
  std::optional<std::uint32_t> spareSlots;
};
void addEditBenchOptions(CLI::App& sub, EditBenchOptions& options);

/// Of `bench mesh` alone; its shapes are those of touch.
struct MeshBenchOptions {
  std::vector<std::int64_t> lattices{64, 128, 256};
  std::vector<std::string> surfaces{"sphere"};
  std::int64_t truthPoints = 200'000;
};
void addMeshBenchOptions(CLI::App& sub, MeshBenchOptions& options);

/// Of `bench coexist` alone.
struct CoexistBenchOptions {
  std::vector<std::string> queues, situations;
  std::string sightGpu;         ///< draws; empty: the one that touches
  std::int64_t touched = 1000;  ///< points that an edit is to touch
};
/// Adds them, and sets them to all that there is.
void addCoexistBenchOptions(CLI::App& sub, CoexistBenchOptions& options);

/// Of `bench locality` alone.
struct LocalityBenchOptions {
  std::vector<std::string> clouds, brushes, gestures{"press", "slide"};
  double hold_s = 2, toolRadius_mm = 3, depth_mm = 3;
};
/// Adds them, and sets them to all that there is.
void addLocalityBenchOptions(CLI::App& sub, LocalityBenchOptions& options);

struct BenchOptions {
  std::vector<std::string> names, models, backends{"vulkan"}, methods;
  std::vector<std::string> surfaces{"average"};  ///< of query and step; every back end has the average
  std::vector<std::int64_t> sizes;
  std::vector<std::int64_t> toolPoints;  ///< of step: a tool of so many points is measured, too, for each
  std::string tool = "pad";
  double toolSize_mm = kUsualToolSize_mm;
  std::int64_t repeat = 200;
  double limit_s = 5;
  double rate_Hz = 1e6;
  double movedShare = 0.01;
  std::string plotFile;
  std::string size = "1280x720";                ///< of the pictures of splat
  std::uint32_t samples = 4;                    ///< of a pixel, for splat
  std::vector<std::uint32_t> smooths_px{0};     ///< of splat (FrameOptions::smooth_px)
  std::vector<std::string> rasters{"compute"};  ///< of splat (FrameOptions::raster)
  std::vector<std::int64_t> meshes;             ///< lattices of the meshes that splat compares
  BackendOptions backend;
  TouchBenchOptions touch;
  EditBenchOptions edit;
  MeshBenchOptions mesh;
  CoexistBenchOptions coexist;
  LocalityBenchOptions locality;

  bool wants(std::string_view name) const;  ///< whether a back end is to be measured
};

/// Ticks per second of a stroke in real time: 1000, unless the options say otherwise.
double realtimeRate_Hz(const BenchOptions& options);

/// What is measured: a file, or a sculpture of so many points.
struct Subject {
  std::string name;
  Model model;
};
/// Makes one when it is its turn: a hundred million points are a large part of a machine's memory.
using SubjectMaker = std::function<Subject(Context&)>;

/// One measurement: so many repetitions of one way to do a job on one subject.
struct BenchRecord {
  std::string bench;    ///< build, sort, query or step
  std::string backend;  ///< vulkan, cuda or cpu
  std::string way;      ///< the sort or the query method
  std::string input;    ///< what was done: "file order", "last order", "static", "edited", …
  std::string subject;
  std::size_t points = 0;
  Summary gpu_us;   ///< time on the GPU; no samples where it was not measured
  Summary wall_us;  ///< time on the CPU's clock; no samples where it was not measured
};
Json toJson(const BenchRecord& record);

/// Repeats `once` as the options say: `repeat` times, or until the limit has passed with five samples at least.
template <class Once>
void repeatMeasurement(const BenchOptions& options, Once&& once) {
  constexpr std::int64_t kFewest = 5;
  const Stopwatch watch;
  for (std::int64_t i = 0; i < options.repeat; ++i) {
    if (options.limit_s > 0 && i >= kFewest && watch.elapsed_s() > options.limit_s) return;
    once(i);
  }
}

/// One table in the layout of the thesis (Tables 4.1 and 5.4): models down, by size, and ways across; medians
/// and 99.9th percentiles in us of `time`. Ways that were not measured have no column.
void printTable(std::FILE* out, const std::string& title, const std::vector<BenchRecord>& records,
                Summary BenchRecord::*time);

/// The benches. Each adds what it has measured.
void benchBuild(Context& context, const Subject& subject, const BenchOptions& options,
                std::vector<BenchRecord>& records);
void benchSort(Context& context, const Subject& subject, const BenchOptions& options,
               std::vector<BenchRecord>& records);
void benchQuery(Context& context, const Subject& subject, const BenchOptions& options,
                std::vector<BenchRecord>& records);
void benchStep(Context& context, const Subject& subject, const BenchOptions& options,
               std::vector<BenchRecord>& records);
/// Judges touch on surfaces that are known (apps/touch_judge.hpp), prints tables, and gives the numbers back.
Json benchTouch(Context& context, const BenchOptions& options);
/// What an edited step costs, against the points of the model and against those that the edit touches
/// (apps/edit_cost.hpp). Prints tables, and gives the numbers back.
Json benchEdit(Context& context, const std::vector<SubjectMaker>& subjects, const BenchOptions& options);
/// What a mesh costs, pass by pass, whole and after an edit, and how far it is from shapes that are known. Prints
/// tables, and gives the numbers back.
Json benchMesh(Context& context, const std::vector<SubjectMaker>& subjects, const BenchOptions& options);
/// What a picture costs, pass by pass, and how true it is to shapes that are known (apps/picture_judge.hpp). Prints
/// tables, and gives the numbers back.
Json benchSplat(Context& context, const std::vector<SubjectMaker>& subjects, const BenchOptions& options);
/// How touch fares beside pictures that are drawn as fast as they go, and those beside it. Prints a table, and gives
/// the numbers back.
Json benchCoexist(Context& context, const std::vector<SubjectMaker>& subjects, const BenchOptions& options);
/// What edits change that they may not, on models and on clouds that are uneven in the ways of real ones: strokes of
/// each brush, judged by what is known of the points before and after alone (engine/cloud/edit_judge.hpp). Prints a
/// table, and gives the numbers back; `broken` counts the strokes that broke a promise.
Json benchLocality(Context& context, const BenchOptions& options);
/// What answers in bench touch unless the user says: vulkan on a real GPU; cpu where there is none, or only a software
/// driver, which is slower than the CPU back end by far and feels the same.
std::string ownTouchBackend(Context& context);

}  // namespace palpate
