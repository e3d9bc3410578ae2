// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/AreaUnderCurve.h>
#include <dyslam/base/Error.h>
#include <dyslam/eval/MaskScan.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::string_view mask_header = "x,y,z,static_confidence,label";

/** A sampled point whose true label is known. */
struct Sample
{
  float confidence;  //!< static confidence
  bool moving;       //!< true label
};

std::vector<Sample> labelledSamples(const MaskScan& scan)
{
  std::vector<Sample> samples;
  for (const auto& point : scan.points)
  {
    if (point.confidence >= 0 && point.truth != MaskScan::Truth::unknown)
    {
      samples.push_back({point.confidence, point.truth == MaskScan::Truth::moving});
    }
  }
  return samples;
}

bool parseRow(std::string_view row, std::array<float, 5>& values)
{
  const char* at = row.data();
  const char* end = at + row.size();
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool last = i + 1 == values.size();
    if (error != std::errc() || (last ? next != end : next == end || *next != ','))
    {
      return false;
    }
    at = last ? next : next + 1;
  }
  return true;
}
}  // namespace

MaskScan parseMaskScan(const std::string& content, const std::string& name)
{
  MaskScan scan;
  scan.name = name;
  std::string_view rest = content;
  bool first = true;
  while (!rest.empty())
  {
    const auto end = std::min(rest.find('\n'), rest.size());
    std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!row.empty() && row.back() == '\r')
    {
      row.remove_suffix(1);
    }
    if (first)
    {
      if (row != mask_header)
      {
        throw UserError(name + ": the first line must be " + std::string(mask_header) +
                        "; give a file of dyslam-train dylo --mask-csv");
      }
      first = false;
      continue;
    }
    std::array<float, 5> v{};
    const auto reject = [&](const char* what)
    { throw UserError(name + ": row " + std::to_string(scan.points.size() + 1) + what); };
    if (!parseRow(row, v))
    {
      reject(" is not five numbers with commas between");
    }
    if (!(v[3] <= 1))
    {
      reject(": static_confidence must be at most 1, or below 0 for none");
    }
    if (v[4] != 0 && v[4] != 1 && v[4] != 2)
    {
      reject(": label must be 0 (unknown), 1 (static) or 2 (moving)");
    }
    const auto truth = v[4] == 1   ? MaskScan::Truth::stationary
                       : v[4] == 2 ? MaskScan::Truth::moving
                                   : MaskScan::Truth::unknown;
    scan.points.push_back({{v[0], v[1]}, v[3], truth});
  }
  if (scan.points.empty())
  {
    throw UserError(name + ": no rows; write it again with dyslam-train dylo --mask-csv");
  }
  return scan;
}

std::size_t sampledPoints(const MaskScan& scan, MaskScan::Truth truth)
{
  return static_cast<std::size_t>(std::count_if(scan.points.begin(), scan.points.end(),
                                                [&](const MaskScan::Point& p)
                                                { return p.confidence >= 0 && p.truth == truth; }));
}

std::vector<Eigen::Vector2d> rocCurve(const MaskScan& scan)
{
  std::vector<Sample> samples = labelledSamples(scan);
  const auto all_moving = static_cast<double>(
      std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.moving; }));
  const double all_static = static_cast<double>(samples.size()) - all_moving;
  if (all_moving == 0 || all_static == 0)
  {
    return {};
  }
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.confidence < b.confidence; });
  std::vector<Eigen::Vector2d> curve = {Eigen::Vector2d::Zero()};
  double moving = 0;
  double static_count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    (samples[i].moving ? moving : static_count) += 1;
    // Points of equal confidence pass the threshold together.
    if (i + 1 == samples.size() || samples[i].confidence < samples[i + 1].confidence)
    {
      curve.emplace_back(static_count / all_static, moving / all_moving);
    }
  }
  return curve;
}

double areaUnderCurve(const MaskScan& scan)
{
  std::vector<float> still;
  std::vector<float> moving;
  for (const Sample& sample : labelledSamples(scan))
  {
    (sample.moving ? moving : still).push_back(sample.confidence);
  }
  return areaUnderCurve(std::move(still), moving);
}
}  // namespace dyslam
