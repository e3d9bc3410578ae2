// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/benchmarks/MethodGroups.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

using Parts = std::vector<std::string>;

/** The components of a file's path, without the ending of a text file. */
Parts partsOf(const std::string& file)
{
  fs::path path = fs::path(file).lexically_normal();
  path = path.extension() == ".txt" ? path.replace_extension() : path;
  Parts parts;
  for (const fs::path& part : path)
  {
    parts.push_back(part.string());
  }
  return parts;
}

/** The components that paths have in common; those that differ are empty. */
Parts commonParts(const std::vector<std::string>& files, const std::vector<std::size_t>& numbers)
{
  Parts common = partsOf(files[numbers.front()]);
  for (const std::size_t number : numbers)
  {
    const Parts parts = partsOf(files[number]);
    for (std::size_t i = 0; i < common.size(); ++i)
    {
      common[i] = i < parts.size() && parts[i] == common[i] ? common[i] : "";
    }
  }
  return common;
}

/** Names groups by the components that their paths have in common, and not all groups. */
void nameGroups(const std::vector<std::string>& files, std::vector<MethodGroup>& groups)
{
  std::vector<Parts> of_groups;
  for (const MethodGroup& group : groups)
  {
    of_groups.push_back(commonParts(files, group.estimates));
  }
  for (std::size_t g = 0; g < groups.size(); ++g)
  {
    fs::path name;
    for (std::size_t i = 0; i < of_groups[g].size(); ++i)
    {
      const std::string& part = of_groups[g][i];
      const bool differs =
          std::any_of(of_groups.begin(), of_groups.end(),
                      [&](const Parts& other) { return i >= other.size() || other[i] != part; });
      if (differs && !part.empty())
      {
        name /= part;
      }
    }
    groups[g].name = name.string();
  }
}
}  // namespace

std::vector<MethodGroup> methodGroups(const std::vector<std::string>& files,
                                      const std::vector<std::string>& references)
{
  std::vector<MethodGroup> groups;
  std::set<std::string> seen;  // references of the last group
  std::set<std::string> first;
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    const std::string reference = fs::path(references[i]).lexically_normal().string();
    if (groups.empty() || seen.count(reference) != 0)
    {
      if (groups.size() > 1 && seen != first)
      {
        return {};
      }
      groups.emplace_back();
      seen.clear();
    }
    seen.insert(reference);
    if (groups.size() == 1)
    {
      first.insert(reference);
    }
    groups.back().estimates.push_back(i);
  }
  if (groups.size() < 2)
  {
    return groups;
  }
  nameGroups(files, groups);
  std::set<std::string> different;
  for (const MethodGroup& group : groups)
  {
    different.insert(group.name);
  }
  const bool told_apart = different.size() == groups.size() && different.count("") == 0;
  return told_apart && seen == first ? groups : std::vector<MethodGroup>();
}
}  // namespace dyslam
