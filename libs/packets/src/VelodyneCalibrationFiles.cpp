// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/packets/VelodyneModels.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>

namespace dyslam
{
namespace
{
constexpr std::size_t most_lasers = 128;
using Calibration = mrpt::obs::VelodyneCalibration;

void setField(Calibration::PerLaserCalib& laser, const std::string& key, double value)
{
  if (key == "rot_correction")
  {
    laser.azimuthCorrection = value * degrees_per_radian;
  }
  else if (key == "vert_correction")
  {
    laser.verticalCorrection = value * degrees_per_radian;
  }
  else if (key == "dist_correction")
  {
    laser.distanceCorrection = value;
  }
  else if (key == "vert_offset_correction")
  {
    laser.verticalOffsetCorrection = value;
  }
  else if (key == "horiz_offset_correction")
  {
    laser.horizontalOffsetCorrection = value;
  }
}

bool isWord(char c)
{
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/** The value behind the colon of `key: value`. \throws UserError if it is not a number. */
double numberAfter(std::string_view text, const std::string& key)
{
  std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
  begin += begin < text.size() && text[begin] == '+' ? 1 : 0;
  double value = 0;
  const auto parsed = std::from_chars(text.data() + begin, text.data() + text.size(), value);
  if (parsed.ec != std::errc() || !std::isfinite(value))
  {
    throw UserError(key + ": '" + std::string(text.substr(0, text.find_first_of(",}\n"))) +
                    "' is not a number");
  }
  return value;
}

/** \throws UserError unless the value is the number of a laser. */
std::size_t laserId(double value)
{
  if (!(value >= 0 && value < most_lasers && value == std::floor(value)))
  {
    std::ostringstream text;
    text << "laser_id " << value << " is not an integer from 0 to " << most_lasers - 1;
    throw UserError(text.str());
  }
  return static_cast<std::size_t>(value);
}

/** The items of a list, `- {key: value, ...}` or `- key: value` with further lines. */
std::vector<std::string_view> itemsOf(const std::string& text)
{
  std::vector<std::string_view> items;
  const std::string_view all = text;
  const bool braces = text.find("- {") != std::string::npos;
  const char* const mark = braces ? "- {" : "- ";
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1))
  {
    const std::size_t line = text.find_last_of('\n', at);
    const std::size_t first = line == std::string::npos ? 0 : line + 1;
    if (braces || text.find_first_not_of(' ', first) == at)
    {
      items.push_back(all.substr(at));
    }
  }
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const std::size_t next = i + 1 < items.size()
                                 ? static_cast<std::size_t>(items[i + 1].data() - items[i].data())
                                 : items[i].size();
    // The last item of a block ends where a line is not indented.
    std::size_t end = braces ? items[i].find('}') : next;
    for (std::size_t line = items[i].find('\n'); !braces && line < end;
         line = items[i].find('\n', line + 1))
    {
      if (line + 1 < items[i].size() && items[i][line + 1] != ' ' && items[i][line + 1] != '-')
      {
        end = line;
      }
    }
    items[i] = items[i].substr(0, std::min(end, next));
  }
  return items;
}

/** Every laser is an item of a list, its keys in whatever order. MRPT 2.5.8 takes the text of a
 * YAML file for a file name, and its parser for any YAML prints errors and reads on, or overflows
 * the stack on deep nesting, so this is read here. */
Calibration fromYaml(const std::string& text)
{
  Calibration calibration;
  std::set<std::size_t> ids;
  for (const std::string_view laser_text : itemsOf(text))
  {
    Calibration::PerLaserCalib laser;
    std::size_t id = calibration.laser_corrections.size();
    for (std::size_t colon = laser_text.find(':'); colon != std::string_view::npos;
         colon = laser_text.find(':', colon + 1))
    {
      std::size_t end = colon;
      for (; end > 0 && laser_text[end - 1] == ' '; --end)
      {
      }
      std::size_t begin = end;
      for (; begin > 0 && isWord(laser_text[begin - 1]); --begin)
      {
      }
      const std::string key(laser_text.substr(begin, end - begin));
      if (key == "two_pt_correction_available")
      {
        continue;  // true or false
      }
      const double value = numberAfter(laser_text.substr(colon + 1), key);
      setField(laser, key, value);
      if (key == "laser_id")
      {
        id = laserId(value);
      }
    }
    if (calibration.laser_corrections.size() >= most_lasers && id >= most_lasers)
    {
      break;  // no lidar has so many: refused by their number
    }
    if (!ids.insert(id).second)
    {
      throw UserError("laser_id " + std::to_string(id) + " is there twice");
    }
    auto& lasers = calibration.laser_corrections;
    lasers.resize(std::max(lasers.size(), id + 1));
    lasers[id] = laser;
  }
  return calibration;
}
}  // namespace

Calibration readVelodyneCalibration(const std::string& path, std::size_t lasers)
{
  const std::string text = readWhole(path);
  const auto extension = std::filesystem::path(path).extension();
  Calibration calibration;
  if (extension == ".yaml" || extension == ".yml")
  {
    try
    {
      calibration = fromYaml(text);
    }
    catch (const UserError& error)
    {
      throw UserError(path + ": " + error.what());
    }
  }
  // MRPT prints its errors, so obviously wrong files are not passed to it.
  else if (text.find("boost_serialization") != std::string::npos)
  {
    (void)calibration.loadFromXMLText(text);
  }
  if (calibration.laser_corrections.size() != lasers)
  {
    throw UserError(path + ": is no Velodyne calibration (.xml or .yaml) of " +
                    std::to_string(lasers) + " lasers");
  }
  return calibration;
}
}  // namespace dyslam
