// SPDX-License-Identifier: BSD-3-Clause
#include "RunReport.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>

#include <filesystem>

namespace dyslam
{
std::optional<nlohmann::ordered_json> readRunReport(const std::string& folder)
{
  const auto path = std::filesystem::path(folder) / "report.json";
  if (!std::filesystem::exists(path))
  {
    return std::nullopt;
  }
  auto json = nlohmann::ordered_json::parse(readWhole(path.string()), nullptr, false);
  if (!json.is_object())
  {
    throw UserError(path.string() + ": is not the JSON report of a run");
  }
  return json;
}
}  // namespace dyslam
