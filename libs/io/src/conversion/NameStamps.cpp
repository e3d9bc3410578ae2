// SPDX-License-Identifier: BSD-3-Clause
#include "NameStamps.h"

#include <dyslam/base/Quantile.h>
#include <dyslam/formats/FieldConventions.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <sstream>
#include <tuple>
#include <utility>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** The part of a file's name that may be a time: all of it, or of nuScenes' names, such as
 * n008-2018-08-01-15-16-36-0400__LIDAR_TOP__1533151603547590.pcd.bin, the end. */
std::string timeInName(const std::string& file)
{
  std::string stem = fs::path(file).stem().string();
  if (lowerExtension(stem) == ".pcd")
  {
    stem.resize(stem.size() - 4);
  }
  const auto end = stem.rfind("__");
  return end == std::string::npos ? stem : stem.substr(end + 2);
}

/** Where a name's fraction of a second begins; the name's end if it has none. */
std::size_t fractionBegin(const std::string& name)
{
  const std::size_t point = name.find('.');
  return point == std::string::npos ? name.size() : point + 1;
}

/** Makes decimals of the fractions of seconds in names, which may also be counts of nanoseconds
 * without leading zeros (1600000000.50000000 is 0.05 s after the full second).
 * \return false if their lengths differ and they may be either. */
bool makeDecimals(std::vector<std::string>& names)
{
  constexpr std::size_t nanosecond_digits = 9;
  std::size_t shortest = std::string::npos;
  std::size_t longest = 0;
  bool decimals = false;  // a count has digits, and no zero before others
  for (const std::string& name : names)
  {
    const std::size_t begin = fractionBegin(name);
    const std::size_t length = name.size() - begin;
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
    decimals = decimals || length == 0 || (length > 1 && name[begin] == '0');
  }
  if (decimals || shortest == longest)
  {
    return true;
  }
  if (longest != nanosecond_digits)
  {
    return false;
  }
  for (std::string& name : names)
  {
    const std::size_t begin = fractionBegin(name);
    name.insert(begin, nanosecond_digits - (name.size() - begin), '0');
  }
  return true;
}

/** The parts of the files' names that may be times, as decimal numbers; empty if the text before
 * them differs, as of two lidars, or if it cannot be told what the digits behind the point mean. */
std::vector<std::string> timesInNames(const std::vector<std::string>& files)
{
  std::vector<std::string> names;
  std::string prefix;  // such as that of pcl_ros's pointcloud_to_pcd
  for (const std::string& file : files)
  {
    std::string name = timeInName(file);
    const std::size_t begin = std::min(name.find_first_of("0123456789"), name.size());
    if (!names.empty() && name.compare(0, begin, prefix) != 0)
    {
      return {};
    }
    prefix = name.substr(0, begin);
    name.erase(0, begin);
    const auto part = name.find('_');
    if (part != std::string::npos)
    {
      name[part] = '.';  // seconds_fraction
    }
    names.push_back(std::move(name));
  }
  return makeDecimals(names) ? names : std::vector<std::string>();
}

/** The numbers that decimal texts are; empty unless all are such, nothing before or behind them. */
std::vector<double> numbersOf(const std::vector<std::string>& texts)
{
  std::vector<double> numbers;
  for (const std::string& text : texts)
  {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
    {
      return {};
    }
    numbers.push_back(value);
  }
  return numbers;
}

/** Sorts times, and the files by them. \return false, with nothing changed, if two are the same */
bool sortByTime(std::vector<double>& times, std::vector<std::string>& files)
{
  std::vector<std::pair<double, std::string>> timed;
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    timed.emplace_back(times[i], files[i]);
  }
  std::sort(timed.begin(), timed.end());
  if (std::adjacent_find(timed.begin(), timed.end(),
                         [](const auto& a, const auto& b)
                         { return a.first == b.first; }) != timed.end())
  {
    return false;
  }
  for (std::size_t i = 0; i < timed.size(); ++i)
  {
    std::tie(times[i], files[i]) = timed[i];
  }
  return true;
}

/** Whether all names have a decimal point, and one of them milliseconds. */
bool haveMilliseconds(const std::vector<std::string>& files)
{
  std::size_t longest = 0;
  for (const std::string& file : files)
  {
    const std::string name = timeInName(file);
    const std::size_t begin = fractionBegin(name);
    if (begin == name.size())
    {
      return false;
    }
    longest = std::max(longest, name.size() - begin);
  }
  constexpr std::size_t digits = 3;
  return longest >= digits;
}
}  // namespace

std::vector<int> numbersFromNames(const std::vector<std::string>& files)
{
  constexpr std::size_t most_digits = 9;  // without leading zeros; an int holds them
  std::vector<int> numbers;
  std::string prefix;
  for (const std::string& file : files)
  {
    const std::string stem = fs::path(file).stem().string();
    const std::size_t begin = stem.find_last_not_of("0123456789") + 1;
    const std::size_t first = std::min(stem.find_first_not_of('0', begin), stem.size());
    if (begin == stem.size() || stem.size() - first > most_digits)
    {
      return {};
    }
    const int number = std::stoi("0" + stem.substr(first));
    if (!numbers.empty() && (stem.compare(0, begin, prefix) != 0 || number <= numbers.back()))
    {
      return {};
    }
    prefix = stem.substr(0, begin);
    numbers.push_back(number);
  }
  return numbers;
}

std::string secondsText(double seconds)
{
  std::ostringstream text;
  text << seconds;
  return text.str();
}

double secondsOf(double time)
{
  return time * unitOfDate(time);
}

std::vector<double> stampsFromNames(std::vector<std::string>& files)
{
  constexpr double earliest = 9e8;  // s since 1970, in 1998: 251370668 counts from a start
  constexpr double latest = 4.1e9;  // s since 1970, in 2099: 20180801151636 is a date
  std::vector<double> stamps = numbersOf(timesInNames(files));
  for (double& stamp : stamps)
  {
    stamp = secondsOf(stamp);
    if (!(stamp >= earliest && stamp < latest))
    {
      return {};
    }
  }
  return sortByTime(stamps, files) ? stamps : std::vector<double>();
}

std::vector<double> secondsFromNames(std::vector<std::string>& files)
{
  constexpr double shortest = 0.005;  // median time between scans [s]
  constexpr double longest = 2;
  std::vector<double> stamps =
      haveMilliseconds(files) ? numbersOf(timesInNames(files)) : std::vector<double>();
  std::vector<std::string> ordered = files;
  if (stamps.size() < 2 || !sortByTime(stamps, ordered))
  {
    return {};
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
  {
    steps.push_back(stamps[i] - stamps[i - 1]);
  }
  const double usual = upperMedian(steps);
  if (usual < shortest || usual > longest)
  {
    return {};
  }
  files = std::move(ordered);
  return stamps;
}
}  // namespace dyslam
