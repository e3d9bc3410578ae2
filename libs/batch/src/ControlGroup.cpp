// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/batch/ControlGroup.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
/** Path of this process's group in the hierarchy of version 2. On hosts with both versions, lines
 * of version 1 precede its line. */
std::optional<fs::path> groupOf(const fs::path& root)
{
  const std::string version_2 = "0::";
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);)
  {
    if (line.rfind(version_2, 0) == 0)
    {
      return (fs::path("/") / line.substr(version_2.size())).lexically_normal();
    }
  }
  return std::nullopt;
}

/** The number in a file; nothing for "max" or if the file does not exist. */
std::optional<std::uint64_t> numberIn(const fs::path& path)
{
  std::uint64_t value = 0;
  std::ifstream file(path);
  return file >> value ? std::optional(value) : std::nullopt;
}

/** The number after a word at the beginning of a line; 0 if there is no such line. */
std::uint64_t numberBehind(const std::string& wanted, const fs::path& path)
{
  std::ifstream file(path);
  std::string key;
  for (std::uint64_t value = 0; file >> key >> value;)
  {
    if (key == wanted)
    {
      return value;
    }
  }
  return 0;
}

std::optional<std::uint64_t> memoryLeftBy(const fs::path& group)
{
  const auto limit = numberIn(group / "memory.max");
  if (!limit)
  {
    return std::nullopt;
  }
  const std::uint64_t charged = numberIn(group / "memory.current").value_or(0);
  const std::uint64_t cache = numberBehind("inactive_file", group / "memory.stat");
  const std::uint64_t used = charged - std::min(charged, cache);
  return *limit - std::min(*limit, used);
}
}  // namespace

std::optional<std::uint64_t> memoryLeftByGroups(const std::string& root)
{
  const auto own = groupOf(root);
  if (!own)
  {
    return std::nullopt;
  }
  const fs::path groups = fs::path(root) / "sys/fs/cgroup";
  const fs::path unified = groups / "unified";  // exists on hosts with both versions
  const fs::path& hierarchy = fs::is_directory(unified) ? unified : groups;
  std::optional<std::uint64_t> left;
  for (fs::path group = *own;; group = group.parent_path())
  {
    const auto here = memoryLeftBy(hierarchy / group.relative_path());
    left = here ? std::min(*here, left.value_or(*here)) : left;
    if (!group.has_relative_path())
    {
      return left;
    }
  }
}
}  // namespace dyslam::batch
