// SPDX-License-Identifier: BSD-3-Clause
#include "ConvertedFiles.h"

#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RecordingOrigin.h>
#include <dyslam/formats/RunFiles.h>

#include <filesystem>

namespace dyslam
{
namespace fs = std::filesystem;

ConvertedFiles::ConvertedFiles(const std::string& output)
    : folder(output),
      rawlog((fs::path(output) / run_files::recording).string()),
      origin(recordingOriginFile(output))
{
}

void ConvertedFiles::writeOrigin(const std::string& input,
                                 const std::string& program,
                                 const std::vector<std::string>& warnings,
                                 const std::string& part) const
{
  const std::string source =
      isLiveInput(input) ? input : fs::absolute(input).lexically_normal().string();
  writeRecordingOrigin({source, program, warnings, part}, folder);
}

bool ConvertedFiles::canBeMadeAgain() const
{
  const auto found = originOfRecording(rawlog);
  return fs::is_regular_file(origin) && !(found && isLiveInput(found->input));
}
}  // namespace dyslam
