// SPDX-License-Identifier: BSD-3-Clause
#include "CloudColumns.h"

#include <dyslam/core/Error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace dyslam
{
namespace
{
template <typename T>
double as(const char* bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

double cloudNumber(const char* bytes, CloudNumber type)
{
  using Kind = CloudNumber::Kind;
  const bool natural = type.kind == Kind::natural;
  switch (type.size)
  {
    case 1:
      return natural ? as<std::uint8_t>(bytes) : as<std::int8_t>(bytes);
    case 2:
      return natural ? as<std::uint16_t>(bytes) : as<std::int16_t>(bytes);
    case 4:
      return type.kind == Kind::real ? as<float>(bytes)
             : natural               ? as<std::uint32_t>(bytes)
                                     : as<std::int32_t>(bytes);
    default:
      return type.kind == Kind::real ? as<double>(bytes)
             : natural               ? as<std::uint64_t>(bytes)
                                     : as<std::int64_t>(bytes);
  }
}

double cloudNumber(std::string_view word, const std::string& path)
{
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size())
  {
    throw UserError(path + ": '" + std::string(word) + "' is not a number");
  }
  return value;
}

void CloudColumns::declare(const std::string& name, CloudNumber type)
{
  struct Name
  {
    const char* text;
    Role role;
  };
  static constexpr std::array<Name, 11> names{{{"x", x},
                                               {"y", y},
                                               {"z", z},
                                               {"intensity", intensity},
                                               {"scalar_intensity", intensity},
                                               {"scalar_Intensity", intensity},
                                               {"reflectivity", intensity},
                                               {"ring", ring},
                                               {"time", time},
                                               {"t", time},
                                               {"timestamp", time}}};
  Role role = none;
  for (std::size_t rank = 0; rank < names.size(); ++rank)
  {
    if (name != names[rank].text)
    {
      continue;
    }
    Column& column = columns_[names[rank].role];
    if (!column.there || rank < column.rank)
    {
      if (column.there)
      {
        roles_[column.field] = none;
      }
      role = names[rank].role;
      column = {true, rank, roles_.size(), type, false, {}};
    }
  }
  roles_.push_back(role);
}

void CloudColumns::reserve(std::uint64_t points)
{
  for (Column& column : columns_)
  {
    column.values.reserve(column.there ? static_cast<std::size_t>(points) : 0);
  }
}

void CloudColumns::addBytes(std::size_t field, const char* bytes)
{
  if (wants(field))
  {
    Column& column = columns_[roles_[field]];
    column.values.push_back(cloudNumber(bytes, column.type));
    column.exact = column.type.kind != CloudNumber::Kind::real || column.type.size == 8;
  }
}

void CloudColumns::addText(std::size_t field, std::string_view word)
{
  if (wants(field))
  {
    columns_[roles_[field]].values.push_back(cloudNumber(word, path_));
    columns_[roles_[field]].exact = true;
  }
}

/** Seconds as they are, whole numbers as nanoseconds; real ones since 1970 in seconds, milli-,
 * micro- or nanoseconds by their size. */
void CloudColumns::fillTimes(Scan& scan) const
{
  constexpr double hour = 3600;  // times of a scan above it are absolute [s]
  std::vector<double> times = columns_[time].values;
  const CloudNumber type = columns_[time].type;
  double largest = 0;
  for (const double value : times)
  {
    largest = std::isfinite(value) ? std::max(largest, std::abs(value)) : largest;
  }
  const double unit = type.kind != CloudNumber::Kind::real ? 1e-9
                      : largest > 1e17                     ? 1e-9
                      : largest > 1e14                     ? 1e-6
                      : largest > 1e11                     ? 1e-3
                                                           : 1;
  const bool absolute = largest * unit > hour;
  if (absolute && !columns_[time].exact)
  {
    return;  // single precision has steps of minutes there
  }
  double first = std::numeric_limits<double>::infinity();
  for (double& value : times)
  {
    // Points without a return have no time.
    value = absolute && value == 0 ? std::numeric_limits<double>::quiet_NaN() : value * unit;
    first = std::isfinite(value) ? std::min(first, value) : first;
  }
  if (absolute)
  {
    scan.stamp = first;
  }
  for (const double value : times)
  {
    scan.time.push_back(static_cast<float>(value - scan.stamp));
  }
}

void CloudColumns::requireNearOrigin() const
{
  constexpr double farthest = 1e5;  // m: single precision has steps of 8 mm there
  for (const std::size_t axis : {x, y, z})
  {
    for (const double value : columns_[axis].values)
    {
      if (columns_[axis].exact && std::isfinite(value) && std::abs(value) > farthest)
      {
        throw UserError(path_ + ": has a point at " + std::to_string(value) +
                        " m, more than 100 km from the origin, where single precision is too "
                        "coarse; subtract an origin from its coordinates");
      }
    }
  }
}

Scan CloudColumns::scan() const
{
  const std::vector<double>& xs = columns_[x].values;
  if (!columns_[x].there || !columns_[y].there || !columns_[z].there)
  {
    throw UserError(path_ + ": has no fields x, y and z");
  }
  for (const Column& column : columns_)
  {
    if (column.there && column.values.size() != xs.size())
    {
      throw UserError(path_ + ": has fields with no number");
    }
  }
  requireNearOrigin();
  Scan scan;
  scan.points.reserve(xs.size());
  for (std::size_t i = 0; i < xs.size(); ++i)
  {
    scan.points.emplace_back(static_cast<float>(xs[i]), static_cast<float>(columns_[y].values[i]),
                             static_cast<float>(columns_[z].values[i]));
  }
  for (const double value : columns_[intensity].values)
  {
    scan.intensity.push_back(static_cast<float>(value));
  }
  constexpr double highest_ring = 65535;
  for (const double value : columns_[ring].values)
  {
    scan.ring.push_back(std::isfinite(value)
                            ? static_cast<std::uint16_t>(std::clamp(value, 0.0, highest_ring))
                            : std::uint16_t{0});
  }
  fillTimes(scan);
  return scan;
}

std::vector<std::string_view> cloudWords(std::string_view line)
{
  constexpr const char* blanks = " \t\r";
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(blanks); begin != std::string_view::npos;)
  {
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(blanks, end);
  }
  return words;
}
}  // namespace dyslam
