// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Words.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanTable.h>
#include <dyslam/plot/MapPicture.h>
#include <dyslam/report/RunPage.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "../results/ReportedObjects.h"
#include "../results/RunHistory.h"
#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* png = "map.png";

/** `map.png`, the map from above, and `report.html`, the run in a browser. */
class PageOutput : public RunOutput
{
 public:
  explicit PageOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::page, png}),
        options_(context.config.get<RunPageOptions>("report")),
        config_(context.config),
        folder_(context.settings.output_folder),
        input_(context.settings.rawlog),
        sensor_(context.settings.sensor),
        truth_(poseOrigin(groundTruthFolder(context.settings.rawlog)))
  {
  }

  void open() override { settings_ = config_.effective().toIni(); }

  void exchangeState(StateArchive& /*archive*/) override { open(); }

  void finish(const RunResults& results) override
  {
    RunPage page = pageOf(results);
    page.picture = renderMapPicture(pictureOf(page));
    std::string failures;
    if (!page.picture.empty())
    {
      writeUnlessFailing(png, bytesOf(page.picture), failures);
    }
    page.files.emplace_back(png);
    const std::string page_template = readWhole(findGivenOrShared("page.html", "report", ".html"));
    writeUnlessFailing(run_files::page, renderRunPage(page, page_template, options_), failures);
    if (!failures.empty())
    {
      throw UserError(failures);
    }
  }

 private:
  /** Writes a file; where it cannot be written, the other one of this output is all the same. */
  void writeUnlessFailing(const char* name, std::string_view content, std::string& failures) const
  {
    try
    {
      writeWhole(path(name), content);
    }
    catch (const UserError& error)
    {
      appendWord(failures, error.what(), "; ");
    }
  }

  [[nodiscard]] RunPage pageOf(const RunResults& results) const
  {
    RunPage page;
    page.title = nameOfFile(folder_);
    page.input = input_;
    page.sensor = sensor_;
    page.reference_origin = truth_.text();
    page.difference_to = truth_.differenceTo();
    page.settings = settings_;
    page.method = results.report.method;
    page.verdict = results.report.verdict;
    page.failure = results.report.failure;
    page.warnings = results.report.warnings;
    page.files = results.report.files;
    page.stage_ms = results.stage_ms;
    page.run_time = results.runTime();
    page.recording_time = results.report.recording_time;
    page.parts = partsOf(results.report.files);
    for (const PastScan& scan : results.history->scans())
    {
      page.scans.push_back(
          {scan.index, scan.points, scan.moving_points, scan.registered, scan.keyframe});
      page.odometry.push_back(scan.stamp, scan.T_odom_vehicle);
    }
    page.trajectory = results.trajectory;
    page.reference = results.reference;
    page.loops = loopsOf(*results.backend);
    page.loops_left_out = results.report.loops_left_out;
    page.georeference = results.report.georeference;
    page.gravity = results.report.gravity;
    page.prior_map = results.report.prior_map;
    page.objects = objectsOf(results);
    page.reported_tracks = results.report.reported_tracks;
    if (results.map != nullptr)
    {
      page.map_points = &results.map_points.points;
      page.map_intensity = &results.map_points.intensity;
      page.map_size = results.report.map_points;
    }
    return page;
  }

  /** Scans of further lidars, if there are any; their table is complete before the page.
   * \param files of the run */
  [[nodiscard]] std::vector<PageScanPart> partsOf(const std::vector<std::string>& files) const
  {
    std::vector<PageScanPart> parts;
    if (std::find(files.begin(), files.end(), run_files::scan_parts) != files.end())
    {
      for (ScanPartRow& row : readScanParts(folder_ + "/" + run_files::scan_parts))
      {
        parts.push_back({row.frame, std::move(row.sensor_label), row.stamp, row.points});
      }
    }
    return parts;
  }

  /** Loops in use, without those that the rest of the graph contradicts. */
  static std::vector<PageLoop> loopsOf(const Backend& backend)
  {
    const FactorGraph& graph = backend.factorGraph();
    std::vector<PageLoop> loops;
    for (const FactorGraph::FactorId id : graph.usedLoops())
    {
      const std::vector<Key>& keys = graph.factor(id).keys();
      loops.push_back({graph.pose(keys[0]).translation(), graph.pose(keys[1]).translation()});
    }
    return loops;
  }

  static std::vector<PageObject> objectsOf(const RunResults& results)
  {
    std::map<int, PageObject> objects;
    forEachReported(results,
                    [&](const ReportedObject& state)
                    {
                      if (!state.object.dynamic)
                      {
                        return;
                      }
                      PageObject& object = objects[state.object.id];
                      object.id = state.object.id;
                      object.object_class = state.object.object_class;
                      object.states.push_back({state.scan_number,
                                               transformed(state.object.box, state.T_map_odom),
                                               state.T_map_odom.linear() * state.object.velocity});
                    });
    std::vector<PageObject> result;
    for (auto& [id, object] : objects)
    {
      result.push_back(std::move(object));
    }
    return result;
  }

  static MapPictureContent pictureOf(const RunPage& page)
  {
    MapPictureContent content;
    content.points = page.map_points;
    for (const auto& [stamp, pose] : page.trajectory)
    {
      content.path.emplace_back(pose.translation());
    }
    for (const PageLoop& loop : page.loops)
    {
      content.loops.emplace_back(loop.from, loop.to);
    }
    for (const PageObject& object : page.objects)
    {
      PictureObject drawn{object.object_class, {}, object.states.back().box};
      for (const PageObjectState& state : object.states)
      {
        drawn.path.push_back(state.box.centre);
      }
      content.objects.push_back(std::move(drawn));
    }
    return content;
  }

  RunPageOptions options_;
  const ConfigLoader& config_;  // other parts of the run load sections until open()
  std::string folder_;
  std::string input_;
  std::string sensor_;
  PoseOrigin truth_;
  std::string settings_;
};
}  // namespace

std::unique_ptr<RunOutput> makePageOutput(const RunOutputContext& context)
{
  return std::make_unique<PageOutput>(context);
}
}  // namespace dyslam
