// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/ParseNumber.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Words.h>
#include <dyslam/train/DataText.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace dyslam
{
std::vector<std::string> splitFields(const std::string& text, char separator)
{
  std::vector<std::string> fields;
  std::istringstream stream(text);
  for (std::string field; std::getline(stream, field, separator);)
  {
    fields.push_back(trimmed(field, " \t"));
  }
  return fields;
}

std::vector<std::string> listItems(const std::string& text, char separator)
{
  std::vector<std::string> items = splitFields(text, separator);
  items.erase(std::remove(items.begin(), items.end(), ""), items.end());
  return items;
}

double numberOf(const std::string& text)
{
  const std::optional<double> number = parseNumber<double>(text);
  if (!number || !std::isfinite(*number))
  {
    throw std::invalid_argument(text);
  }
  return *number;
}

int wholeNumberOf(const std::string& text)
{
  std::size_t read = 0;
  const int number = std::stoi(text, &read);
  if (read != text.size())
  {
    throw std::invalid_argument(text);
  }
  return number;
}

long long beginLog(const std::string& file, const std::string& header, long long last_step)
{
  long long last_kept = -1;
  std::string kept = header + '\n';
  std::ifstream before(file);
  std::string line;
  for (bool first = true; std::getline(before, line); first = false)
  {
    const long long step = std::atoll(line.c_str());
    const bool is_whole = !before.eof();  // a full disk cuts the last row off
    if (!first && is_whole && step <= last_step)
    {
      kept += line + '\n';
      last_kept = step;
    }
  }
  before.close();
  writeWhole(file, kept);
  return last_kept;
}

void appendRows(const std::string& file, const std::vector<std::string>& rows)
{
  std::ofstream csv(file, std::ios::app);
  for (const std::string& row : rows)
  {
    csv << row << '\n';
  }
  csv.close();
  if (!csv)
  {
    throw UserError(file + ": cannot be written; check the disk and that the file may be changed");
  }
}

std::string dataFolder(const std::string& folder, const std::string& field)
{
  if (folder.empty() || folder.front() != '$')
  {
    return folder;
  }
  const std::size_t slash = folder.find('/');
  const std::string name = folder.substr(1, slash == std::string::npos ? slash : slash - 1);
  const char* value = std::getenv(name.c_str());
  if (value == nullptr)
  {
    throw UserError(field + " is " + folder + ", but the environment variable " + name +
                    " is not set; export it, or write the folder");
  }
  return value + (slash == std::string::npos ? "" : folder.substr(slash));
}

std::string startWeights(const std::string& start)
{
  if (std::filesystem::is_directory(start))
  {
    throw UserError("--start " + start + ": is a folder; give its file of weights");
  }
  return start.empty() ? "" : findGivenOrShared(start, "models", ".safetensors", "--start");
}

std::string dataPath(const std::string& data, const std::string& name)
{
  return (std::filesystem::path(data) / name).string();
}
}  // namespace dyslam
