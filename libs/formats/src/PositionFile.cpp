// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/FieldConventions.h>
#include <dyslam/formats/PositionFile.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

#include "PoseChecks.h"

namespace dyslam
{
namespace
{
struct NamedColumn
{
  std::string name;
  std::string unit;  //!< in brackets behind the name; may be empty
};

/** Where time and position are in a line. */
struct PositionColumns
{
  std::size_t count = 4;  //!< number of fields of a line
  std::size_t time = 0;
  std::array<std::size_t, 3> position{1, 2, 3};
  double time_unit = 0;  //!< [s]; 0: by the magnitude of the first
  bool is_geodetic = false;
  bool is_table = false;  //!< separated by commas, so that fields may be empty
};

/** The names in a header, in lower case: "#timestamp [ns], x [m]" has timestamp and x. */
std::vector<NamedColumn> columnsIn(const std::string& line)
{
  constexpr std::string_view separators = " \t\r,;#%\"";
  std::vector<NamedColumn> columns;
  char closing = 0;  // bracket that ends a unit; 0: outside of units
  bool is_name = false;
  for (const char c : lowered(line))
  {
    if (closing != 0 && c != closing)
    {
      columns.back().unit += c;
    }
    else if (closing != 0)
    {
      closing = 0;
    }
    else if ((c == '[' || c == '(') && !columns.empty())
    {
      closing = c == '[' ? ']' : ')';
      is_name = false;
    }
    else if (separators.find(c) != std::string_view::npos)
    {
      is_name = false;
    }
    else
    {
      if (!is_name)
      {
        columns.emplace_back();
      }
      is_name = true;
      columns.back().name += c;
    }
  }
  return columns;
}

/** Number of the column with the first of the names that is there, also as `field.NAME`, which is
 * how rostopic writes it. */
std::optional<std::size_t> columnOf(const std::vector<NamedColumn>& columns,
                                    std::initializer_list<std::string_view> names)
{
  constexpr std::string_view prefix = "field.";
  for (const std::string_view name : names)
  {
    for (std::size_t i = 0; i < columns.size(); ++i)
    {
      std::string_view found = columns[i].name;
      found.remove_prefix(found.substr(0, prefix.size()) == prefix ? prefix.size() : 0);
      if (found == name)
      {
        return i;
      }
    }
  }
  return std::nullopt;
}

bool hasQuaternion(const std::vector<NamedColumn>& columns)
{
  return std::any_of(
      columns.begin(), columns.end(),
      [](const NamedColumn& column)
      {
        return column.name.rfind("q_", 0) == 0 ||
               (column.name.size() == 2 && column.name[0] == 'q' &&
                std::string_view("wxyz").find(column.name[1]) != std::string_view::npos);
      });
}

/** Nothing for a line that does not name time and position, or names a quaternion, too. */
std::optional<PositionColumns> columnsOfHeader(const std::string& line)
{
  const std::vector<NamedColumn> names = columnsIn(line);
  const auto time =
      columnOf(names, {"header.stamp", "stamp", "timestamp", "unix_time", "gps_time", "time", "t"});
  const auto latitude = columnOf(names, {"latitude", "lat"});
  const auto longitude = columnOf(names, {"longitude", "lon", "lng", "long"});
  auto x =
      columnOf(names, {"x", "px", "tx", "pos_x", "position_x", "p_rs_r_x", "east", "easting", "e"});
  auto y = columnOf(names,
                    {"y", "py", "ty", "pos_y", "position_y", "p_rs_r_y", "north", "northing", "n"});
  const auto z = columnOf(names, {"z", "pz", "tz", "pos_z", "position_z", "p_rs_r_z", "up",
                                  "height", "altitude", "alt", "elevation", "u", "h"});
  const bool is_geodetic = !(x && y) && latitude && longitude;
  x = is_geodetic ? latitude : x;
  y = is_geodetic ? longitude : y;
  if (!time || !x || !y || !z || hasQuaternion(names))
  {
    return std::nullopt;
  }
  const std::string& unit = names[*time].unit;
  PositionColumns columns;
  columns.count = names.size();
  columns.time = *time;
  columns.position = {*x, *y, *z};
  columns.time_unit = unit == "ns" ? 1e-9 : unit == "us" ? 1e-6 : unit == "ms" ? 1e-3 : 0;
  columns.is_geodetic = is_geodetic;
  columns.is_table = line.find(',') != std::string::npos;
  return columns;
}

/** A comment may name the columns of lines with as many fields, unless these are poses of TUM or
 * KITTI. */
bool fits(const PositionColumns& comment, std::size_t fields)
{
  return fields == comment.count && fields != 8 && fields != 12 && fields != 13;
}

/** By the header, in a comment or not, or the number of fields. Nothing for a file of another kind.
 */
std::optional<PositionColumns> columnsOfFile(const std::string& path)
{
  std::ifstream file = openBinary(path);
  std::optional<PositionColumns> of_comment;
  std::string line;
  for (bool is_first = true; std::getline(file, line); is_first = false)
  {
    if (is_first)
    {
      removeByteOrderMark(line);
    }
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos)
    {
      continue;
    }
    const bool is_comment = line[begin] == '#';
    const auto named = columnsOfHeader(line);
    if (named && !is_comment)
    {
      return named;
    }
    if (is_comment || line[begin] == '%')
    {
      of_comment = named ? named : of_comment;
      continue;
    }
    const std::vector<NamedColumn> fields = columnsIn(line);  // numbers, or names of other columns
    if (of_comment && fits(*of_comment, fields.size()))
    {
      of_comment->is_table = line.find(',') != std::string::npos;
      return of_comment;
    }
    const bool is_txyz =
        fields.size() == 4 && std::all_of(fields.begin(), fields.end(),
                                          [](const NamedColumn& field)
                                          { return parseNumber<double>(field.name).has_value(); });
    return is_txyz ? std::make_optional<PositionColumns>() : std::nullopt;
  }
  return std::nullopt;
}

std::string_view withoutSpaces(std::string_view text)
{
  const std::size_t begin = text.find_first_not_of(" \t\"");
  return begin == std::string_view::npos
             ? std::string_view()
             : text.substr(begin, text.find_last_not_of(" \t\"") + 1 - begin);
}

std::optional<double> numberAt(const TextFile& file, std::size_t column)
{
  return parseNumber<double>(withoutSpaces(file.fields()[column]));
}

/** The position of the current line; nothing if a number of it is missing. */
std::optional<Eigen::Vector3d> positionIn(const TextFile& file, const PositionColumns& columns)
{
  Eigen::Vector3d position;
  for (std::size_t i = 0; i < 3; ++i)
  {
    const std::string_view text = withoutSpaces(file.fields()[columns.position[i]]);
    const auto value = parseNumber<double>(text);
    if (!value && !text.empty())
    {
      file.fail("'" + std::string(text) + "' is not a number");
    }
    if (!value || std::isnan(*value))
    {
      return std::nullopt;
    }
    position[static_cast<Eigen::Index>(i)] = *value;
  }
  requirePosition(file, position);
  return position;
}
}  // namespace

bool isPositionFile(const std::string& path)
{
  return columnsOfFile(path).has_value();
}

PositionFile readPositions(const std::string& path)
{
  const std::optional<PositionColumns> columns = columnsOfFile(path);
  if (!columns)
  {
    throw UserError(path + ": has neither lines of t x y z nor a header that names such columns");
  }
  TextFile file = columns->is_table ? TextFile::table(path) : TextFile(path, " \t\r,;");
  PositionFile result;
  result.is_geodetic = columns->is_geodetic;
  Trajectory& positions = result.positions;
  double unit = columns->time_unit;
  while (file.next())
  {
    const bool is_header =
        file.fields().front().substr(0, 1) == "%" || columnsOfHeader(file.line());
    if (positions.empty() && is_header)
    {
      continue;
    }
    file.requireFields(columns->count, "time and position, as the first line or the header");
    const auto time = numberAt(file, columns->time);
    if (!time || !std::isfinite(*time))
    {
      file.fail("'" + std::string(file.fields()[columns->time]) + "' is not a time");
    }
    unit = unit > 0 ? unit : unitOfDate(*time);
    const auto position = positionIn(file, *columns);
    const double stamp = unit * *time;
    const double last = positions.empty() ? stamp : positions[positions.size() - 1].stamp;
    if (stamp < last)
    {
      file.fail("the time is before that of the line before; sort the lines by time");
    }
    if (position && (positions.empty() || stamp > last))
    {
      Pose pose = Pose::Identity();
      pose.translation() = *position;
      positions.push_back(stamp, pose);
    }
  }
  if (positions.empty())
  {
    throw UserError(path + ": holds no positions");
  }
  return result;
}
}  // namespace dyslam
