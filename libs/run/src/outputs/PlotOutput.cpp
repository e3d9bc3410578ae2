// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/plot/TrajectoryPlot.h>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* picture = "trajectory.png";

/** `trajectory.png`: the trajectory and the ground truth, if there is one. */
class PlotOutput : public RunOutput
{
 public:
  explicit PlotOutput(const RunOutputContext& context)
      : RunOutput(context, {picture}),
        title_(nameOfFile(context.settings.output_folder)),
        difference_to_(poseOrigin(groundTruthFolder(context.settings.rawlog)).differenceTo())
  {
  }
  void finish(const RunResults& results) override
  {
    constexpr double tolerance = 1e-3;  // [s]; both have the stamps of the scans
    const TrajectoryPlotItem item{
        "estimate", associateByTime(results.reference, results.trajectory, tolerance)};
    if (item.pairs.size() < 2)
    {
      return;
    }
    writeWhole(path(picture),
               bytesOf(renderTrajectoryPlot({item}, {title_, Alignment::se3, difference_to_})));
  }

 private:
  std::string title_;
  std::string difference_to_;  //!< TrajectoryPlotOptions::difference_to
};
}  // namespace

std::unique_ptr<RunOutput> makePlotOutput(const RunOutputContext& context)
{
  return std::make_unique<PlotOutput>(context);
}
}  // namespace dyslam
