// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFiles.h"

#include <dyslam/base/Bytes.h>
#include <dyslam/base/PendingFile.h>

#include <filesystem>
#include <iostream>
#include <set>
#include <system_error>

#include "../common/OutputOptions.h"

namespace dyslam
{
namespace
{
/** The last `parts` components of a path; that of a file without extension. */
std::string tail(const std::filesystem::path& path, int parts)
{
  std::error_code ignored;
  const bool is_folder = !path.has_filename() || std::filesystem::is_directory(path, ignored);
  const std::filesystem::path last = path.has_filename() ? path : path.parent_path();
  std::filesystem::path name = is_folder ? last.filename() : last.stem();
  std::filesystem::path folder = last.parent_path();
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
  addOutputFile(app, "--json", json, "write all figures to this JSON file");
  addOutputFile(app, "--csv", csv, "write the table to this CSV file");
  addOutputFile(app, "--markdown", markdown, "write the table to this Markdown file");
}

void OutputFlags::write(const Table& table, const std::string& json_text) const
{
  std::cout << table.toText();
  if (!csv.empty())
  {
    writeWhole(csv, table.toCsv());
  }
  if (!markdown.empty())
  {
    writeWhole(markdown, table.toMarkdown());
  }
  if (!json.empty())
  {
    writeWhole(json, json_text);
  }
}

void printNote(const std::string& text)
{
  std::cerr << "note: " << text << '\n';
}

void writePng(const std::string& path, const std::vector<std::uint8_t>& png)
{
  writeWhole(path, bytesOf(png));
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
