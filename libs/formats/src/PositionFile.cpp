// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
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

#include "GnssTime.h"
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
  PositionAxes axes = PositionAxes::local;
  bool is_table = false;  //!< separated by commas, so that fields may be empty

  // Of RTKLIB's files:
  std::optional<GnssClock> clock;  //!< the time is a date and a time of day, or week and seconds
  bool has_minutes = false;        //!< latitude and longitude are degrees, minutes and seconds each
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
  columns.axes = is_geodetic ? PositionAxes::geodetic : PositionAxes::local;
  columns.is_table = line.find(',') != std::string::npos;
  return columns;
}

/** By the line of RTKLIB's header that names the columns: clock, position, and others. */
std::optional<PositionColumns> columnsOfRtklib(const std::string& line)
{
  const std::vector<NamedColumn> names = columnsIn(line);
  if (names.size() < 4)
  {
    return std::nullopt;
  }
  PositionColumns columns;
  columns.time_unit = 1;
  const std::string& clock = names[0].name;
  columns.clock = clock == "gpst"  ? std::make_optional(GnssClock::gps)
                  : clock == "utc" ? std::make_optional(GnssClock::utc)
                  : clock == "jst" ? std::make_optional(GnssClock::japan)
                                   : std::nullopt;
  const std::string& first = names[1].name;
  columns.has_minutes = first == "latitude" && names[1].unit != "deg";
  columns.position = {2, columns.has_minutes ? 5U : 3U, columns.has_minutes ? 8U : 4U};
  columns.count = columns.position[2] + 1;
  columns.axes = first == "latitude" ? PositionAxes::geodetic
                 : first == "x-ecef" ? PositionAxes::geocentric
                                     : PositionAxes::local;
  const bool is_known = columns.axes != PositionAxes::local || first == "e-baseline";
  return columns.clock && is_known ? std::make_optional(columns) : std::nullopt;
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
  std::optional<PositionColumns> of_rtklib;
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
      const auto rtklib = is_comment ? std::nullopt : columnsOfRtklib(line);
      of_rtklib = rtklib ? rtklib : of_rtklib;
      continue;
    }
    const std::vector<NamedColumn> fields = columnsIn(line);  // numbers, or names of other columns
    if (of_rtklib)
    {
      of_rtklib->count = std::max(of_rtklib->count, fields.size());
      return of_rtklib;
    }
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
  return of_rtklib;  // without lines
}

constexpr const char* field_blanks = " \t\"";  // around a field

/** Number in a column of the current line; nothing if it is missing or nan. */
std::optional<double> numberAt(const TextFile& file, std::size_t column)
{
  const std::string text = trimmed(file.fields()[column], field_blanks);
  const auto value = parseNumber<double>(text);
  if (!value && !text.empty())
  {
    file.fail("'" + text + "' is not a number");
  }
  return value && !std::isnan(*value) ? value : std::nullopt;
}

/** Angle [deg] in three columns of the current line: degrees with the sign, minutes, seconds. */
std::optional<double> angleAt(const TextFile& file, std::size_t column)
{
  const auto degrees = numberAt(file, column);
  const auto minutes = numberAt(file, column + 1);
  const auto seconds = numberAt(file, column + 2);
  if (!degrees || !minutes || !seconds)
  {
    return std::nullopt;
  }
  return std::copysign(std::abs(*degrees) + *minutes / 60 + *seconds / 3600, *degrees);
}

/** The position of the current line; nothing if a number of it is missing. */
std::optional<Eigen::Vector3d> positionIn(const TextFile& file, const PositionColumns& columns)
{
  Eigen::Vector3d position;
  for (std::size_t i = 0; i < 3; ++i)
  {
    const bool is_angle = columns.has_minutes && i < 2;
    const auto value =
        is_angle ? angleAt(file, columns.position[i]) : numberAt(file, columns.position[i]);
    if (!value)
    {
      return std::nullopt;
    }
    position[static_cast<Eigen::Index>(i)] = *value;
  }
  requirePosition(file, position);
  return position;
}

/** Time stamp of the current line [s]. \param unit of the times [s]; 0: to be set by this one
 * \throws UserError. */
double stampIn(const TextFile& file, const PositionColumns& columns, double& unit)
{
  const std::string_view word = file.fields()[columns.time];
  if (columns.clock)
  {
    const std::string_view second = file.fields()[columns.time + 1];
    const auto time = unixTimeOf(word, second, *columns.clock);
    if (!time)
    {
      file.fail("'" + std::string(word) + " " + std::string(second) + "' is not a time");
    }
    return *time;
  }
  const auto time = parseNumber<double>(trimmed(word, field_blanks));
  if (!time || !std::isfinite(*time))
  {
    file.fail("'" + std::string(word) + "' is not a time");
  }
  unit = unit > 0 ? unit : unitOfDate(*time);
  return unit * *time;
}

/** The clock of a file's times for messages; empty if it is that of the stamps. \param first stamp
 * [s] */
std::string clockText(std::optional<GnssClock> clock, double first)
{
  if (!clock || *clock == GnssClock::utc)
  {
    return "";
  }
  const std::string ahead = std::to_string(secondsAheadOfUtc(*clock, first));
  return (*clock == GnssClock::gps ? "GPS time, " : "Japan's time, ") + ahead + " s ahead of UTC";
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
  result.axes = columns->axes;
  Trajectory& positions = result.positions;
  double unit = columns->time_unit;
  while (file.next())
  {
    const bool is_comment = file.fields().front().substr(0, 1) == "%";
    if (is_comment || (positions.empty() && columnsOfHeader(file.line())))
    {
      continue;
    }
    file.requireFields(columns->count, "time and position, as the first line or the header");
    const double stamp = stampIn(file, *columns, unit);
    const auto position = positionIn(file, *columns);
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
  result.clock = clockText(columns->clock, positions[0].stamp);
  return result;
}
}  // namespace dyslam
