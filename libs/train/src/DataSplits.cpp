// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/DataText.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr std::array<const char*, 3> split_names = {"training", "validation", "test"};
constexpr const char* simulator_section = "simulator";

/** Parses a number that consists of digits only. \throws std::logic_error. */
std::int64_t digitsOf(const std::string& text)
{
  if (text.empty() ||
      !std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
  {
    throw std::invalid_argument(text);
  }
  return std::stoll(text);
}

/** Parses a range: "80-109", "64-" (no upper limit) or "7". */
NumberRange parseRange(const std::string& text, const Config::Value& value)
{
  try
  {
    const std::size_t dash = text.find('-');
    const std::int64_t first = digitsOf(text.substr(0, dash));
    if (dash == std::string::npos)
    {
      return {first, first};
    }
    const std::string end = text.substr(dash + 1);
    const std::int64_t last =
        end.empty() ? std::numeric_limits<std::int64_t>::max() : digitsOf(end);
    if (first <= last)
    {
      return {first, last};
    }
  }
  catch (const std::logic_error&)  // no number
  {
  }
  throw UserError(value.origin + ": '" + text +
                  "' is not a range; write 80-109, 64- for all from 64 on, or one number");
}

bool contains(const std::vector<NumberRange>& ranges, std::int64_t number)
{
  return std::any_of(ranges.begin(), ranges.end(),
                     [number](const NumberRange& r)
                     { return r.first <= number && number <= r.last; });
}

using SplitRanges = std::array<std::vector<NumberRange>, 3>;

std::optional<Split> splitIn(const SplitRanges& ranges, std::int64_t number)
{
  for (const Split split : {Split::training, Split::validation, Split::test})
  {
    if (contains(ranges[static_cast<std::size_t>(split)], number))
    {
      return split;
    }
  }
  return std::nullopt;
}

void requireOneOf(const SplitRanges& ranges,
                  std::int64_t number,
                  Split split,
                  const std::string& what)
{
  const std::optional<Split> found = splitIn(ranges, number);
  if (found != split)
  {
    throw UserError(what + " is " + (found ? "for " + toString(*found) : "in no split") +
                    ", not for " + toString(split) + "; choose another, see the file of splits");
  }
}
}  // namespace

std::string toString(Split split)
{
  return split_names[static_cast<std::size_t>(split)];
}

std::optional<std::int64_t> frameNumberOf(const std::string& file)
{
  const std::string stem = std::filesystem::path(file).stem().string();
  const std::string digits = "0123456789";
  const std::size_t last = stem.find_last_of(digits);
  if (last == std::string::npos)
  {
    return std::nullopt;
  }
  const std::size_t before = stem.find_last_not_of(digits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  constexpr std::size_t most_digits = 18;  // digits that fit into std::int64_t
  const std::size_t count = std::min(last + 1 - first, most_digits);
  return digitsOf(stem.substr(last + 1 - count, count));
}

DataSplits::DataSplits(const Config& config)
{
  for (const std::string& name : config.sectionNames())
  {
    std::vector<NumberRange> all;
    for (const auto& [key, value] : config.section(name))
    {
      const auto split = std::find(split_names.begin(), split_names.end(), key);
      if (split == split_names.end())
      {
        throw UserError(value.origin + ": '" + key +
                        "' is no split; write training, validation or test");
      }
      for (const std::string& item : listItems(value.text, ','))
      {
        const NumberRange range = parseRange(item, value);
        for (const NumberRange& other : all)
        {
          if (range.first <= other.last && other.first <= range.last)
          {
            throw UserError(value.origin + ": '" + item + "' of [" + name +
                            "] overlaps another range; a frame or seed is of one split only");
          }
        }
        all.push_back(range);
        sections_[name][static_cast<std::size_t>(split - split_names.begin())].push_back(range);
      }
    }
  }
}

DataSplits DataSplits::load(const std::string& file, const std::string& field)
{
  const std::string program = "dyslam-train splits";
  const Config config =
      Config::fromFile(findGivenOrShared(file, "config_files", ".ini", field, program));
  config.requireFor(program);
  return DataSplits(config);
}

const DataSplits::Ranges* DataSplits::recordingOf(const std::string& file, std::string& name) const
{
  // Links are followed: another name of a folder must not bypass the splits.
  const std::filesystem::path folder =
      std::filesystem::weakly_canonical(std::filesystem::absolute(file)).parent_path();
  const std::vector<std::filesystem::path> parts(folder.begin(), folder.end());
  for (auto part = parts.rbegin(); part != parts.rend(); ++part)
  {
    const auto found = sections_.find(part->string());
    if (found != sections_.end() && found->first != simulator_section)
    {
      name = found->first;
      return &found->second;
    }
  }
  return nullptr;
}

void DataSplits::requireScan(const std::string& file, Split split, const std::string& field) const
{
  std::string name;
  const Ranges* ranges = recordingOf(file, name);
  if (ranges == nullptr)
  {
    throw UserError(field + ": " + file +
                    ": none of its folders is a section of the file of splits; add one that says "
                    "which frames are for training, validation and test");
  }
  const std::optional<std::int64_t> frame = frameNumberOf(file);
  if (!frame)
  {
    throw UserError(field + ": " + file +
                    ": has no frame number in its name, by which splits are told apart; number the "
                    "scans");
  }
  requireOneOf(*ranges, *frame, split, field + ": frame " + std::to_string(*frame) + " of " + name);
}

void DataSplits::requireFrames(const std::string& folder,
                               const NumberRange& frames,
                               Split split,
                               const std::string& field) const
{
  for (std::int64_t frame = frames.first; frame <= frames.last; ++frame)
  {
    requireScan(folder + "/" + std::to_string(frame) + ".bin", split, field);
  }
}

void DataSplits::requireSeed(std::int64_t seed, Split split, const std::string& field) const
{
  const auto ranges = sections_.find(simulator_section);
  requireOneOf(ranges == sections_.end() ? Ranges() : ranges->second, seed, split,
               field + ": seed " + std::to_string(seed) + " of the simulator");
}

std::optional<Split> DataSplits::splitOfScan(const std::string& file) const
{
  std::string name;
  const Ranges* ranges = recordingOf(file, name);
  const std::optional<std::int64_t> frame = frameNumberOf(file);
  return ranges != nullptr && frame ? splitIn(*ranges, *frame) : std::nullopt;
}

std::optional<Split> DataSplits::splitOfSeed(std::int64_t seed) const
{
  const auto found = sections_.find(simulator_section);
  return found == sections_.end() ? std::nullopt : splitIn(found->second, seed);
}

NumberRange DataSplits::trainingSeeds() const
{
  const auto found = sections_.find(simulator_section);
  if (found == sections_.end() || found->second[0].size() != 1)
  {
    throw UserError(
        "the file of splits: [simulator] training must be one range of seeds, such as "
        "500000000-899999999");
  }
  const NumberRange range = found->second[0].front();
  if (range.last > std::numeric_limits<std::int32_t>::max())
  {
    throw UserError(
        "the file of splits: [simulator] training goes beyond 2147483647, the largest "
        "seed; end it before");
  }
  return range;
}
}  // namespace dyslam
