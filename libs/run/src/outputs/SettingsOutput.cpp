// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/RunFiles.h>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
/** `effective.ini`: every setting of the run. It identifies the folder of a run. */
class SettingsOutput : public RunOutput
{
 public:
  explicit SettingsOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::settings}), config_(context.config)
  {
  }
  void open() override { writeWhole(path(run_files::settings), config_.effective().toIni()); }
  /** The folder may have been moved since, and the labels of a first pass with it. */
  void exchangeState(StateArchive& archive) override
  {
    if (archive.isLoading())
    {
      open();
    }
  }

 private:
  const ConfigLoader& config_;  // other parts of the run load sections until open()
};
}  // namespace

std::unique_ptr<RunOutput> makeSettingsOutput(const RunOutputContext& context)
{
  return std::make_unique<SettingsOutput>(context);
}
}  // namespace dyslam
