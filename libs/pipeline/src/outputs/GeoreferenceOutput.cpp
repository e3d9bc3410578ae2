// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/formats/GeoreferenceFile.h>

#include "../RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* georeference = "georeference.ini";

/** `georeference.ini`, where positions of a satellite receiver show where the map is on the earth.
 */
class GeoreferenceOutput : public RunOutput
{
 public:
  explicit GeoreferenceOutput(const RunOutputContext& context) : RunOutput(context, {georeference})
  {
  }
  void finish(const RunResults& results) override
  {
    if (results.report.georeference)
    {
      writeGeoreference(*results.report.georeference, path(georeference));
    }
  }
};
}  // namespace

std::unique_ptr<RunOutput> makeGeoreferenceOutput(const RunOutputContext& context)
{
  return std::make_unique<GeoreferenceOutput>(context);
}
}  // namespace dyslam
