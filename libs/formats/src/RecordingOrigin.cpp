// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/RecordingOrigin.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <ostream>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr const char* recording_section = "recording";

std::string warningKey(std::size_t number)
{
  return "warning_" + std::to_string(number);
}

std::string inOneLine(std::string text)
{
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}
}  // namespace

std::string recordingOriginFile(const std::string& folder)
{
  return (fs::path(folder) / "recording.ini").string();
}

void writeRecordingOrigin(const RecordingOrigin& origin, const std::string& folder)
{
  Config ini;
  ini.set(recording_section, "input", {origin.input, "", {}});
  ini.set(recording_section, "converter", {origin.converter, "", {}});
  if (!origin.part.empty())
  {
    ini.set(recording_section, "part", {origin.part, "", {}});
  }
  for (std::size_t i = 0; i < origin.warnings.size(); ++i)
  {
    ini.set(recording_section, warningKey(i + 1), {inOneLine(origin.warnings[i]), "", {}});
  }
  writeWhole(recordingOriginFile(folder), [&ini](std::ostream& out) { out << ini.toIni(); });
}

std::optional<RecordingOrigin> originOfRecording(const std::string& rawlog)
{
  const fs::path path(rawlog);
  const std::string file = recordingOriginFile(path.parent_path().string());
  std::error_code none;
  if (path.filename() != run_files::recording || !fs::is_regular_file(file, none))
  {
    return std::nullopt;
  }
  Config ini;
  try
  {
    ini = Config::fromFile(file);
  }
  catch (const UserError&)
  {
    return std::nullopt;  // it is only for information
  }
  const auto value = [&ini](const std::string& key)
  { return ini.text(recording_section, key).value_or(""); };
  RecordingOrigin origin{value("input"), value("converter"), {}, value("part")};
  for (std::size_t number = 1; ini.has(recording_section, warningKey(number)); ++number)
  {
    origin.warnings.push_back(value(warningKey(number)));
  }
  return origin;
}
}  // namespace dyslam
