// SPDX-License-Identifier: BSD-3-Clause
#include "RunReport.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RunFiles.h>

#include <filesystem>

namespace dyslam
{
std::optional<nlohmann::ordered_json> readRunReport(const std::string& folder)
{
  const auto path = std::filesystem::path(folder) / run_files::report;
  if (!std::filesystem::exists(path))
  {
    return std::nullopt;
  }
  const std::string text = readWhole(path.string());
  if (isNestedDeeper(text))
  {
    throw UserError(path.string() + ": is nested too deeply for a report");
  }
  auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!json.is_object())
  {
    throw UserError(path.string() + ": is not the JSON report of a run");
  }
  return json;
}
}  // namespace dyslam
