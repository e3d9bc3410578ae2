// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/formats/TrackTable.h>

#include "CsvTable.h"

namespace dyslam
{
namespace
{
/** Names of the columns of a value. */
std::vector<std::string> columnNames(TrackValue value)
{
  switch (value)
  {
    case TrackValue::frame:
      return {"frame"};
    case TrackValue::id:
      return {"id"};
    case TrackValue::velocity:
      return {"vx", "vy", "vz"};
    case TrackValue::speed:
      return {"speed"};
    case TrackValue::dynamic:
      return {"dynamic"};
  }
  return {};
}

/** \param columns of the value in the table */
void readValue(const CsvTable& table,
               TrackValue value,
               const std::vector<std::size_t>& columns,
               TrackTableRow& row)
{
  switch (value)
  {
    case TrackValue::frame:
      row.frame = table.integer(columns[0]);
      break;
    case TrackValue::id:
      row.id = table.integer(columns[0]);
      break;
    case TrackValue::velocity:
      row.velocity = {table.number(columns[0]), table.number(columns[1]), table.number(columns[2])};
      break;
    case TrackValue::speed:
      if (!table.text(columns[0]).empty())
      {
        row.speed = table.number(columns[0]);
      }
      break;
    case TrackValue::dynamic:
      row.dynamic = table.integer(columns[0]) != 0;
      break;
  }
}
}  // namespace

std::string trackTableHeader()
{
  return "frame,stamp,id,class,x,y,z,length,width,height,yaw,vx,vy,vz,speed,dynamic,observed,score"
         "\n";
}

std::string trackTableRow(const TrackedObject& object, std::size_t frame, double stamp)
{
  const auto& c = object.box.centre;
  const auto& s = object.box.size;
  const auto& v = object.velocity;
  return formatted(
      "%zu,%.6f,%d,%s,%.3f,%.3f,%.3f,%.2f,%.2f,%.2f,%.4f,%.3f,%.3f,%.3f,%.3f,%d,%d,%.3f\n", frame,
      stamp, object.id, toString(object.object_class).c_str(), c.x(), c.y(), c.z(), s.x(), s.y(),
      s.z(), object.box.yaw, v.x(), v.y(), v.z(), v.norm(), object.dynamic ? 1 : 0,
      object.observed ? 1 : 0, object.score);
}

TrackTable readTrackTable(const std::string& path, const std::vector<TrackValue>& wanted)
{
  CsvTable file(path);
  TrackTable table;
  std::vector<std::vector<std::size_t>> columns;
  for (const TrackValue value : wanted)
  {
    columns.emplace_back();
    for (const std::string& name : columnNames(value))
    {
      const auto column = file.find(name);
      if (!column)
      {
        table.missing = name;
        return table;
      }
      columns.back().push_back(*column);
    }
  }
  while (file.next())
  {
    table.rows.emplace_back();
    for (std::size_t i = 0; i < wanted.size(); ++i)
    {
      readValue(file, wanted[i], columns[i], table.rows.back());
    }
  }
  return table;
}
}  // namespace dyslam
