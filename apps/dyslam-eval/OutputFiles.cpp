// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFiles.h"

#include <dyslam/core/PendingFile.h>

#include <filesystem>
#include <iostream>
#include <set>

namespace dyslam
{
namespace
{
/** The last `parts` components of a path, without extension. */
std::string tail(const std::filesystem::path& path, int parts)
{
  std::filesystem::path name = path.has_filename() ? path.stem() : path.parent_path().filename();
  std::filesystem::path folder =
      path.has_filename() ? path.parent_path() : path.parent_path().parent_path();
  for (int i = 1; i < parts && folder.has_filename(); ++i)
  {
    name = folder.filename() / name;
    folder = folder.parent_path();
  }
  return name.string();
}
}  // namespace

void OutputFlags::declare(CLI::App& app)
{
  app.add_option("--json", json, "write all figures to this JSON file");
  app.add_option("--csv", csv, "write the table to this CSV file");
}

void OutputFlags::write(const Table& table, const std::string& json_text) const
{
  std::cout << table.toText();
  if (!csv.empty())
  {
    writeWhole(csv, table.toCsv());
  }
  if (!json.empty())
  {
    writeWhole(json, json_text);
  }
}

std::vector<std::string> shortNames(const std::vector<std::string>& paths)
{
  for (int parts = 1; parts < 6; ++parts)
  {
    std::vector<std::string> names;
    for (const auto& path : paths)
    {
      names.push_back(tail(std::filesystem::path(path).lexically_normal(), parts));
    }
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size())
    {
      return names;
    }
  }
  return paths;
}
}  // namespace dyslam
