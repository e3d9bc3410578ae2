// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RunFiles.h>
#include <dyslam/mapexport/MapCloudFile.h>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
/** `map_static.pcd` or `map_static.ply`: the points of the static map. */
class MapCloudOutput : public RunOutput
{
 public:
  using RunOutput::RunOutput;
  void checkpoint(const RunResults& results) override { finish(results); }
  void finish(const RunResults& results) override
  {
    if (results.map != nullptr)
    {
      constexpr bool normals = false;
      MapCloudFile file(path(names().front().name), normals);
      results.map->forEachPart([&](const MapPoints& part) { file.add(part); });
      file.close();
    }
  }
};
}  // namespace

std::unique_ptr<RunOutput> makePcdOutput(const RunOutputContext& context)
{
  return std::make_unique<MapCloudOutput>(context, std::vector<OutputName>{run_files::map_pcd});
}

std::unique_ptr<RunOutput> makePlyOutput(const RunOutputContext& context)
{
  return std::make_unique<MapCloudOutput>(context, std::vector<OutputName>{run_files::map_ply});
}
}  // namespace dyslam
