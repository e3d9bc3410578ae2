// SPDX-License-Identifier: BSD-3-Clause
#include "RunToResume.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Version.h>
#include <dyslam/formats/RunFiles.h>

#include <filesystem>
#include <system_error>

#include "../FirstPass.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
std::unique_ptr<OutputFolder> lockedFolder(const std::string& folder)
{
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
  {
    throw UserError(folder + ": no such folder; --output names the folder of the run to resume");
  }
  if (!fs::is_regular_file(fs::path(folder) / run_files::state, ignored))
  {
    throw UserError(folder + ": nothing to resume: there is no " + run_files::state +
                    "; the run has ended, or has no checkpoint yet "
                    "(output.checkpoint_seconds)");
  }
  return std::make_unique<OutputFolder>(folder);
}
}  // namespace

RunToResume::RunToResume(const std::string& folder)
    : lock(lockedFolder(folder)), file((fs::path(folder) / run_files::state).string(), state_parts)
{
  load(StatePart::run, [this](StateArchive& archive) { archive(run); });
  if (run.version != DYSLAM_VERSION)
  {
    throw UserError((fs::path(folder) / run_files::state).string() + ": is of DySLAM " +
                    run.version + ", this is " + DYSLAM_VERSION +
                    "; resume with that one, or start the run anew");
  }
  if (run.is_second_pass)
  {
    const std::string name = "the state's settings";
    Config settings = Config::fromText(run.settings, name);
    settings.set("dyseg", "labels", {keptLabelsOf(folder), name, {}});
    run.settings = settings.toIni();
  }
}
}  // namespace dyslam
