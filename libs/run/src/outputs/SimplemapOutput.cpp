// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapexport/MapExport.h>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* simplemap = "keyframes.simplemap";

/** `keyframes.simplemap`: the keyframes of the static map. */
class SimplemapOutput : public RunOutput
{
 public:
  explicit SimplemapOutput(const RunOutputContext& context) : RunOutput(context, {simplemap}) {}
  void finish(const RunResults& results) override
  {
    if (results.map != nullptr)
    {
      writeSimplemap(*results.map, path(simplemap));
    }
  }
};
}  // namespace

std::unique_ptr<RunOutput> makeSimplemapOutput(const RunOutputContext& context)
{
  return std::make_unique<SimplemapOutput>(context);
}
}  // namespace dyslam
