// SPDX-License-Identifier: BSD-3-Clause
#include "CloudColumns.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "FieldNames.h"

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
  const bool is_unsigned = type.kind == Kind::unsigned_integer;
  switch (type.size)
  {
    case 1:
      return is_unsigned ? as<std::uint8_t>(bytes) : as<std::int8_t>(bytes);
    case 2:
      return is_unsigned ? as<std::uint16_t>(bytes) : as<std::int16_t>(bytes);
    case 4:
      return type.kind == Kind::floating ? as<float>(bytes)
             : is_unsigned               ? as<std::uint32_t>(bytes)
                                         : as<std::int32_t>(bytes);
    default:
      return type.kind == Kind::floating ? as<double>(bytes)
             : is_unsigned               ? as<std::uint64_t>(bytes)
                                         : as<std::int64_t>(bytes);
  }
}

double cloudNumber(std::string_view word, const std::string& path)
{
  const std::optional<double> value = parseNumber<double>(word);
  if (!value)
  {
    throw UserError(path + ": '" + std::string(word) + "' is not a number");
  }
  return *value;
}

std::uint16_t ringNumber(double value)
{
  constexpr double highest = 65535;
  return std::isfinite(value) ? static_cast<std::uint16_t>(std::clamp(value, 0.0, highest))
                              : std::uint16_t{0};
}

template <typename Names>
void CloudColumns::offer(Role role, const Names& names, const std::string& name, CloudNumber type)
{
  const auto at = std::find(names.begin(), names.end(), plainFieldName(name));
  if (at == names.end())
  {
    return;
  }
  const auto rank = 2 * static_cast<std::size_t>(at - names.begin()) + (name == *at ? 0U : 1U);
  Column& column = columns_[role];
  if (column.there && rank >= column.rank)
  {
    return;
  }
  if (column.there)
  {
    roles_[column.field] = none;
  }
  const bool exact = type.isInteger() || type.size == 8;
  column = {true, rank, roles_.size() - 1, name, type, exact, {}};
  roles_.back() = role;
}

void CloudColumns::declare(const std::string& name, CloudNumber type)
{
  using Name = std::array<const char*, 1>;
  roles_.push_back(none);
  offer(x, Name{"x"}, name, type);
  offer(y, Name{"y"}, name, type);
  offer(z, Name{"z"}, name, type);
  const bool is_calibrated = plainFieldName(name) == calibrated_intensity_name;
  offer(is_calibrated ? calibrated : intensity, intensity_names, name, type);
  offer(ring, ring_names, name, type);
  offer(time, time_names, name, type);
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

/** \throws UserError if the field of earlier scans is missing. */
void CloudColumns::fillIntensity(FieldConventions& conventions, Scan& scan) const
{
  const Column& other = columns_[calibrated];
  const Column& plain = columns_[intensity];
  const Column& usual = plain.there && (!other.there || plain.rank < other.rank) ? plain : other;
  if (usual.values.empty())
  {
    return;
  }
  const std::string& name =
      conventions.intensityField(usual.name, other.there ? other.name : "", usual.values);
  if (name != usual.name && name != other.name)
  {
    throw UserError(path_ + ": lacks the field " + name + " that earlier scans have");
  }
  for (const double value : (name == usual.name ? usual : other).values)
  {
    scan.intensity.push_back(static_cast<float>(value));
  }
}

void CloudColumns::fillTimes(FieldConventions& conventions, Scan& scan) const
{
  const Column& column = columns_[time];
  if (!column.values.empty())
  {
    conventions.fillTimesAndStamp(
        {column.name, column.type.isInteger(), !column.exact, column.values}, scan);
  }
}

void CloudColumns::fillRings(FieldConventions& conventions, Scan& scan) const
{
  const Column& column = columns_[ring];
  const bool by_rows = !column.there && row_length_ > 0;
  for (std::size_t i = 0; by_rows && i < scan.size(); ++i)
  {
    scan.ring.push_back(static_cast<std::uint16_t>(i / row_length_));
  }
  for (const double value : column.values)
  {
    scan.ring.push_back(ringNumber(value));
  }
  if (!scan.ring.empty())
  {
    conventions.orderRings(by_rows ? "rows of the cloud" : "field " + column.name, scan, by_rows);
  }
}

void failTooFar(double coordinate, const std::string& place, const std::string& advice)
{
  throw UserError(place + ": has a point at " + std::to_string(coordinate) +
                  " m, more than 100 km from the origin, where single precision is too "
                  "coarse; subtract an origin from its coordinates" +
                  advice);
}

void CloudColumns::requireNearOrigin(double length_unit) const
{
  for (const std::size_t axis : {x, y, z})
  {
    for (const double value : columns_[axis].values)
    {
      const double metres = length_unit * value;
      if (columns_[axis].exact && std::isfinite(metres) && std::abs(metres) > farthest_coordinate)
      {
        failTooFar(metres, path_,
                   ", or, if they are not in metres, give their unit (scans2rawlog --scale, 0.001: "
                   "millimetres)");
      }
    }
  }
}

Scan CloudColumns::scan(FieldConventions& conventions) const
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
  requireNearOrigin(conventions.lengthUnit());
  Scan scan;
  scan.points.reserve(xs.size());
  for (std::size_t i = 0; i < xs.size(); ++i)
  {
    scan.points.emplace_back(static_cast<float>(xs[i]), static_cast<float>(columns_[y].values[i]),
                             static_cast<float>(columns_[z].values[i]));
  }
  conventions.toMetres(scan);
  fillIntensity(conventions, scan);
  fillTimes(conventions, scan);
  fillRings(conventions, scan);
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
