// SPDX-License-Identifier: BSD-3-Clause
#include "MapCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/MapComparison.h>
#include <dyslam/benchmarks/MapSelf.h>
#include <dyslam/formats/ScanFiles.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "../common/Progress.h"
#include "../common/RangeFlags.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct MapArguments
{
  std::string reference;
  std::string labels;
  std::string distances;      //!< PLY to write
  bool needs_labels = false;  //!< flags were given that need them
  std::vector<std::string> estimates;
  MapMetricsOptions metrics;
  MapSelfArguments self;
  std::vector<std::string> poses_of{"vehicle"};  //!< of all trajectories, or of each one
  std::vector<double> time_offsets{0};           //!< [s], as poses_of
  OutputFlags output;
};

/** Shows on stderr how much of the recording has been read, and what is wrong with it. */
class ReadingProgress : public MapListener
{
 public:
  void beginReading(const std::string& purpose) override { progress_.emplace(purpose); }
  void update(double fraction, std::size_t count) override { progress_->update(fraction, count); }
  void finish(std::size_t count) override
  {
    progress_->finish(count);
    progress_.reset();
  }
  void warn(const std::string& text) override { printNote(printable(text)); }

 private:
  std::optional<Progress> progress_;
};

std::vector<NamedMap> namedMaps(const std::vector<std::string>& paths)
{
  const std::vector<std::string> names = shortNames(paths);
  std::vector<NamedMap> maps;
  for (std::size_t i = 0; i < paths.size(); ++i)
  {
    maps.emplace_back(names[i], paths[i]);
  }
  return maps;
}

/** \throws UserError for a file that distances cannot be written to. */
void requireDistancesFile(const MapArguments& a)
{
  if (!a.distances.empty() && lowerExtension(a.distances) != ".ply")
  {
    throw UserError("--distances " + a.distances + ": the ending must be .ply");
  }
  if (!a.distances.empty() && a.estimates.size() > 1)
  {
    throw UserError("--distances writes the points of one --estimate, but " +
                    std::to_string(a.estimates.size()) + " were given");
  }
}

/** The trajectories of `--self` with the flags of each. \throws UserError. */
std::vector<MapSelfTrajectory> selfTrajectories(const MapArguments& a)
{
  requireOneOrEach("--poses-of", a.poses_of.size(), a.estimates.size(), "trajectories");
  requireOneOrEach("--time-offset", a.time_offsets.size(), a.estimates.size(), "trajectories");
  std::vector<MapSelfTrajectory> result;
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    result.push_back(
        {a.estimates[i], oneOrEach(a.poses_of, i) == "lidar", oneOrEach(a.time_offsets, i)});
  }
  return result;
}

/** `--self`: evaluates trajectories by their maps. */
void runMapSelf(const MapArguments& a)
{
  MapSelfArguments self = a.self;
  self.trajectories = selfTrajectories(a);
  ReadingProgress progress;
  const auto scores = evaluateMapSelf(self, progress);
  const auto names = shortNames(a.estimates);
  a.output.write(mapSelfTable(names, scores), mapSelfJson(self, names, scores));
}

void runMap(const MapArguments& a)
{
  if (!a.self.rawlog.empty())
  {
    runMapSelf(a);
    return;
  }
  if (a.reference.empty())
  {
    throw UserError("map: give --reference MAP, or --self RAWLOG for quality without ground truth");
  }
  requireDistancesFile(a);
  const ReferenceMap reference = readReferenceMap(a.reference);
  const ReferenceLabels labels =
      a.distances.empty() ? readReferenceLabels(reference, a.labels) : ReferenceLabels();
  const bool by_distance = !a.distances.empty() || !labels.missing.empty();
  if (!labels.missing.empty() && a.needs_labels)
  {
    throw UserError(a.reference + ": has no labels (" + labels.missing +
                    "), which --radius and --voxel need; give --labels F.label, or omit them");
  }
  if (!labels.missing.empty())
  {
    printNote(printable(a.reference) + " has no labels (" + labels.missing +
              "): the maps are compared by the distances of their points");
  }
  if (!labels.from_intensity.empty())
  {
    printNote("the intensities of " + printable(a.reference) + " are taken as its labels (" +
              labels.from_intensity + "); if they are none, give --distances FILE.ply");
  }
  const std::vector<NamedMap> maps = namedMaps(a.estimates);
  const MapComparisonReport report =
      by_distance ? compareByDistance(reference, maps, a.distances)
                  : compareByLabels(reference, labels.labels, maps, a.metrics);
  a.output.write(report.table, report.json);
}

void declareSelf(CLI::App& sub, MapArguments& a)
{
  MapSelfArguments& self = a.self;
  const char* group = "Without ground truth";
  const auto option = [&](const char* name, auto& value, const char* help)
  { return sub.add_option(name, value, help)->group(group)->capture_default_str(); };
  CLI::Option* without_truth =
      option("--self", self.rawlog, "rawlog of the scans; --estimate are then trajectories");
  for (const char* other : {"--reference", "--labels", "--radius", "--voxel", "--distances"})
  {
    without_truth->excludes(other);
  }
  const auto of_self = [&](const char* name, auto& value, const char* help)
  { return option(name, value, help)->needs(without_truth); };
  of_self("-c,--config", self.config, "ini file whose [preprocess] is used");
  of_self("--neighbourhood", self.quality.radius, "radius around a point [m]")->check(positive());
  of_self("--min-neighbours", self.quality.min_neighbours, "points with fewer are left out")
      ->check(CLI::Range(4, 1000000));
  of_self("--points", self.points, "number of points whose neighbourhoods are evaluated")
      ->check(CLI::Range(1, 10000000));
  of_self("--tolerance", self.tolerance,
          "largest difference of time stamps where the pose of a scan cannot be interpolated [s]")
      ->check(notNegative());
  of_self("--poses-of", a.poses_of,
          "body of the poses, vehicle or lidar: of all trajectories, or one for each")
      ->check(CLI::IsMember({"vehicle", "lidar"}));
  of_self("--time-offset", a.time_offsets,
          "added to the time stamps of the poses (TUM) [s]: for clocks that differ; of all "
          "trajectories, or one for each");
  for (CLI::Option* flag : declareScanCount(sub, self.source, "use"))
  {
    flag->group(group)->capture_default_str()->needs(without_truth);
  }
}
}  // namespace

Subcommand mapCommand(CLI::App& app)
{
  const auto a = std::make_shared<MapArguments>();
  CLI::App* sub = app.add_subcommand(
      "map",
      "Static points preserved and dynamic points rejected by a map; of maps without labels, the "
      "distances of their points; with --self, the sharpness of the map of a trajectory, without "
      "ground truth");
  sub->add_option("--reference", a->reference,
                  "map (pcd, ply) of all points; labels in F.label beside it or in its intensity");
  CLI::Option* labels =
      sub->add_option("--labels", a->labels, "SemanticKITTI labels of the reference's points");
  sub->add_option(
         "--estimate", a->estimates,
         "maps to evaluate (pcd, ply), or trajectories (TUM, KITTI) with --self; any number")
      ->required();
  CLI::Option* radius =
      sub->add_option("--radius", a->metrics.point_radius,
                      "largest distance of a map point from a reference point (SA, DA) [m]")
          ->check(positive())
          ->capture_default_str();
  CLI::Option* voxel =
      sub->add_option("--voxel", a->metrics.voxel_size, "side of the voxels (PR, RR) [m]")
          ->check(positive())
          ->capture_default_str();
  addOutputFile(*sub, "--distances", a->distances,
                "compare by distance and write the estimate, coloured by the distance of each "
                "point from the reference, to this PLY file")
      ->excludes(labels)
      ->excludes(radius)
      ->excludes(voxel);
  declareSelf(*sub, *a);
  a->output.declare(*sub);
  return {sub, [a, radius, voxel]
          {
            a->needs_labels = radius->count() + voxel->count() > 0;
            runMap(*a);
          }};
}
}  // namespace dyslam
