// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/eval/MapPicture.h>
#include <dyslam/report/RunPage.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "../RunOutput.h"
#include "SmoothedTracks.h"

namespace dyslam
{
namespace
{
constexpr const char* html = "report.html";
constexpr const char* png = "map.png";

PageScan scanOf(const Frame& frame)
{
  const auto moving = std::count(frame.moving.begin(), frame.moving.end(), true);
  return {frame.index, frame.cloud.size(), static_cast<std::size_t>(moving), frame.motion.converged,
          frame.is_keyframe};
}

/** `map.png`, the map from above, and `report.html`, the run in a browser. */
class PageOutput : public RunOutput
{
 public:
  explicit PageOutput(const RunOutputContext& context)
      : RunOutput(context, {html, png}),
        options_(context.config.get<RunPageOptions>("report")),
        config_(context.config),
        folder_(context.settings.output_folder),
        input_(context.settings.rawlog)
  {
  }

  void open() override { settings_ = config_.effective().toIni(); }

  void add(const Frame& frame) override
  {
    for (const TrackedObject& object : frame.objects)
    {
      if (object.reported && object.dynamic)
      {
        moving_[object.id].emplace_back(scans_.size(), object);
      }
    }
    odometry_.push_back(frame.scan.stamp, frame.T_odom_vehicle);
    scans_.push_back(scanOf(frame));
  }

  void exchangeState(StateArchive& archive) override
  {
    archive(odometry_, scans_, moving_);
    open();
  }

  void finish(const RunResults& results) override
  {
    RunPage page = pageOf(results);
    page.picture = renderMapPicture(pictureOf(page));
    if (!page.picture.empty())
    {
      writeWhole(path(png), std::string_view(reinterpret_cast<const char*>(page.picture.data()),
                                             page.picture.size()));
    }
    page.files.emplace_back(png);
    const std::string page_template = readWhole(findGivenOrShared("page.html", "report", ".html"));
    writeWhole(path(html), renderRunPage(page, page_template, options_));
  }

 private:
  [[nodiscard]] RunPage pageOf(const RunResults& results) const
  {
    RunPage page;
    page.title = std::filesystem::absolute(folder_).lexically_normal().filename().string();
    page.input = input_;
    page.settings = settings_;
    page.method = results.report.method;
    page.failure = results.report.failure;
    page.warnings = results.report.warnings;
    page.files = results.report.files;
    page.odometry_failed = results.report.odometry_failed;
    page.stage_ms = results.stage_ms;
    page.scans = scans_;
    page.trajectory = results.trajectory;
    page.odometry = odometry_;
    page.reference = results.reference;
    page.loops = loopsOf(*results.backend);
    page.objects = objectsOf(results);
    if (results.map != nullptr)
    {
      page.map_points = &results.map_points.points;
      page.map_intensity = &results.map_points.intensity;
    }
    return page;
  }

  static std::vector<PageLoop> loopsOf(const Backend& backend)
  {
    std::vector<PageLoop> loops;
    for (const Loop& loop : backend.loops())
    {
      if (loop.verdict == LoopVerdict::accepted)
      {
        const auto& keyframes = backend.keyframes();
        loops.push_back({keyframes[loop.from].T_map_vehicle.translation(),
                         keyframes[loop.to].T_map_vehicle.translation(), loop.by_appearance});
      }
    }
    return loops;
  }

  [[nodiscard]] std::vector<PageObject> objectsOf(const RunResults& results) const
  {
    std::vector<PageObject> objects;
    for (const auto& [id, reports] : moving_)
    {
      PageObject object{id, reports.back().second.object_class, {}};
      for (const auto& [scan, reported] : reports)
      {
        // Loops closed since have moved the odometry frame of each scan.
        const Pose T_map_odom = results.trajectory[scan].pose * odometry_[scan].pose.inverse();
        TrackedObject state = reported;
        if (const SmoothedObject* smoothed = findSmoothed(results.objects, scans_[scan].index, id))
        {
          state = smoothedTrack(reported, *smoothed, T_map_odom.inverse());
        }
        object.states.push_back(
            {scan, transformed(state.box, T_map_odom), T_map_odom.linear() * state.velocity});
      }
      objects.push_back(std::move(object));
    }
    return objects;
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
        drawn.path.push_back(state.box.center);
      }
      content.objects.push_back(std::move(drawn));
    }
    return content;
  }

  RunPageOptions options_;
  const ConfigLoader& config_;  // other parts of the run load theirs until open()
  std::string folder_;
  std::string input_;
  std::string settings_;
  Trajectory odometry_;
  std::vector<PageScan> scans_;
  /** By id: position of the scan, and the object as it was reported there, odometry frame. */
  std::map<int, std::vector<std::pair<std::size_t, TrackedObject>>> moving_;
};
}  // namespace

std::unique_ptr<RunOutput> makePageOutput(const RunOutputContext& context)
{
  return std::make_unique<PageOutput>(context);
}
}  // namespace dyslam
