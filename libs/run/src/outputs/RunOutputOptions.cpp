// SPDX-License-Identifier: BSD-3-Clause
#include "RunOutputOptions.h"

#include "RunOutput.h"

namespace dyslam
{
RunOutputOptions::RunOutputOptions()
{
  for (const RunOutputKind& kind : runOutputKinds())
  {
    if (kind.key != nullptr)
    {
      on[kind.key] = true;
    }
  }
}

void RunOutputOptions::describe(OptionsVisitor& v)
{
  for (const RunOutputKind& kind : runOutputKinds())
  {
    if (kind.key != nullptr)
    {
      v.flag(kind.key, on[kind.key], kind.help);
    }
  }
  v.real("scene_voxel_size", scene_voxel_size, 0.01, 100,
         "side of the cubes with one map point each in map.3Dscene [m]");
  v.real("checkpoint_seconds", checkpoint_seconds, 0, 1e6,
         "time between checkpoints for --resume; 0: none [s]");
}
}  // namespace dyslam
