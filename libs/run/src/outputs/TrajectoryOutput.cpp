// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>

#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
constexpr const char* kitti_poses = "trajectory_kitti.txt";

/** Poses of the recording's vehicle: `odometry_tum.txt` frame by frame; at the end
 * `trajectory_tum.txt`, `trajectory_kitti.txt` and, with ground truth, `reference_tum.txt`. */
class TrajectoryOutput : public RunOutput
{
 public:
  explicit TrajectoryOutput(const RunOutputContext& context)
      : RunOutput(context,
                  {run_files::odometry, run_files::trajectory, kitti_poses, run_files::reference}),
        levelling_(context.config.get<RawlogSourceOptions>("input").levelling())
  {
  }
  void open() override { odometry_.open(path(run_files::odometry)); }
  void add(const Frame& frame) override
  {
    odometry_.write(tumLine(frame.scan.stamp, levelling_.recorded(frame.T_odom_vehicle)));
  }
  void checkpoint(const RunResults& results) override { eachByItself(writers(results)); }
  void exchangeState(StateArchive& archive) override
  {
    odometry_.exchangeState(path(run_files::odometry), archive);
  }
  void finish(const RunResults& results) override
  {
    std::vector<std::function<void()>> all = writers(results);
    all.emplace_back([&] { odometry_.close(); });
    eachByItself(all);
  }

 private:
  [[nodiscard]] std::vector<std::function<void()>> writers(const RunResults& results) const
  {
    return {[&] { writeTum(path(run_files::trajectory), levelling_.recorded(results.trajectory)); },
            [&] { writeKittiPoses(path(kitti_poses), levelling_.recorded(results.trajectory)); },
            [&]
            {
              if (!results.reference.empty())
              {
                writeTum(path(run_files::reference), levelling_.recorded(results.reference));
              }
            }};
  }

  Levelling levelling_;
  StreamedFile odometry_;
};
}  // namespace

std::unique_ptr<RunOutput> makeTrajectoryOutput(const RunOutputContext& context)
{
  return std::make_unique<TrajectoryOutput>(context);
}
}  // namespace dyslam
