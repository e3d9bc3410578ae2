// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/train/ChangedSettings.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace dyslam
{
namespace
{
/** Whether a key of [train] has no effect on the result of the steps that are done. */
bool isHarmless(const std::string& key)
{
  constexpr std::array<const char*, 5> keys{"steps", "threads", "checkpoint_every",
                                            "checkpoint_minutes", "validate_every"};
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}
}  // namespace

std::vector<std::string> changedSettings(const std::string& earlier_ini, const Config& effective)
{
  std::vector<std::string> changed;
  if (!std::filesystem::exists(earlier_ini))
  {
    return changed;
  }
  const Config before = Config::fromFile(earlier_ini);
  const Config now = Config::fromText(effective.toIni(), "effective.ini");  // as that was written
  for (const std::string& section : now.sectionNames())
  {
    for (const auto& [key, value] : now.section(section))
    {
      if ((section == "train" && isHarmless(key)) || !before.has(section, key))
      {
        continue;
      }
      const std::string& earlier = before.section(section).at(key).text;
      if (earlier != value.text)
      {
        changed.push_back("[" + section + "] " + key + " = " + value.text + " (before: " + earlier +
                          ")");
      }
    }
  }
  return changed;
}

std::string changedSettingsNote(const std::string& earlier_ini, const Config& effective)
{
  std::string note;
  for (const std::string& setting : changedSettings(earlier_ini, effective))
  {
    note +=
        (note.empty() ? "note: goes on with other settings than it began with: " : ", ") + setting;
  }
  return note;
}

void writeSettings(const Config& effective, const TrainRequest& request)
{
  makeFolder(request.output, "choose another --output");
  const std::string ini = request.output + "/effective.ini";
  const std::string changes = request.resume ? changedSettingsNote(ini, effective) : "";
  if (!changes.empty())
  {
    request.report(changes);
  }
  writeWhole(ini, effective.toIni());
}
}  // namespace dyslam
