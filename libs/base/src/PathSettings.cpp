// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/PathSettings.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
struct PathSetting
{
  std::string_view section;
  std::string_view key;
  bool is_file;  //!< a name that is no file may be of shipped weights, even if there is a folder
};

constexpr std::array<PathSetting, 6> path_settings{{{"boxes", "calib", false},
                                                    {"boxes", "file", false},
                                                    {"dyseg", "labels", false},
                                                    {"dyseg_network", "weights", true},
                                                    {"dylo", "weights", true},
                                                    {"prior_map", "file", false}}};

bool isThere(const PathSetting& setting, const std::string& path)
{
  std::error_code none;
  return !path.empty() &&
         (setting.is_file ? fs::is_regular_file(path, none) : fs::exists(path, none));
}
}  // namespace

std::string absolutePath(const std::string& path)
{
  const fs::path absolute = fs::absolute(path);
  const fs::path normal = absolute.lexically_normal();
  std::error_code none;
  return fs::equivalent(absolute, normal, none) ? normal.string() : absolute.string();
}

void makePathsAbsolute(Config& config)
{
  for (const PathSetting& setting : path_settings)
  {
    const std::string section(setting.section);
    const std::string key(setting.key);
    if (config.has(section, key))
    {
      Config::Value value = config.section(section).at(key);
      if (fs::path(value.text).is_relative() && isThere(setting, value.text))
      {
        value.text = absolutePath(value.text);
        config.set(section, key, value);
      }
    }
  }
}

bool isSameSetting(const std::string& section,
                   const std::string& key,
                   const std::string& a,
                   const std::string& b)
{
  const bool is_path = std::any_of(path_settings.begin(), path_settings.end(),
                                   [&](const PathSetting& setting)
                                   { return setting.section == section && setting.key == key; });
  return a == b ||
         (is_path && fs::path(a).is_absolute() && fs::path(b).is_absolute() && isSamePath(a, b));
}

std::vector<std::string> filesNamedIn(const Config& config)
{
  std::vector<std::string> files;
  for (const PathSetting& setting : path_settings)
  {
    const auto path = config.text(std::string(setting.section), std::string(setting.key));
    if (path && isThere(setting, *path))
    {
      files.push_back(*path);
    }
  }
  return files;
}

bool isAboutNamedFile(const std::string& message)
{
  return std::any_of(path_settings.begin(), path_settings.end(),
                     [&message](const PathSetting& setting)
                     {
                       const std::string name =
                           std::string(setting.section) + "." + std::string(setting.key);
                       return message.rfind(name, 0) == 0 &&
                              message.find_first_of(":= ", name.size()) == name.size();
                     });
}
}  // namespace dyslam
