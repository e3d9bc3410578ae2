// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mrpt/Geodesy.h>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
/** `georeference.ini`, the pose of the map on the earth, and `trajectory_utm.txt`, the poses of the
 * recording's vehicle in UTM, if there are sufficient satellite positions. */
class GeoreferenceOutput : public RunOutput
{
 public:
  explicit GeoreferenceOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::georeference, run_files::trajectory_utm}),
        levelling_(context.config.get<RawlogSourceOptions>("input").levelling())
  {
  }
  void finish(const RunResults& results) override
  {
    const auto& found = results.report.georeference;
    if (!found)
    {
      return;
    }
    writeGeoreference(*found, path(run_files::georeference));
    writeTum(path(run_files::trajectory_utm),
             inUtm(levelling_.recorded(results.trajectory), *found));
  }

 private:
  Levelling levelling_;
};
}  // namespace

std::unique_ptr<RunOutput> makeGeoreferenceOutput(const RunOutputContext& context)
{
  return std::make_unique<GeoreferenceOutput>(context);
}
}  // namespace dyslam
