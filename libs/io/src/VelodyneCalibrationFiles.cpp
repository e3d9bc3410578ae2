// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>

#include "VelodynePackets.h"

namespace dyslam
{
namespace
{
constexpr double degrees = 180 / 3.14159265358979323846;
using Calibration = mrpt::obs::VelodyneCalibration;

void setField(Calibration::PerLaserCalib& laser, const std::string& key, double value)
{
  if (key == "rot_correction")
  {
    laser.azimuthCorrection = value * degrees;
  }
  else if (key == "vert_correction")
  {
    laser.verticalCorrection = value * degrees;
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

/** Every laser is a `- {key: value, ...}`, in whatever order. MRPT 2.5.8 takes the text of a YAML
 * file for a file name, so this is read here. */
Calibration fromYaml(const std::string& text)
{
  const std::regex pair(R"((\w+)\s*:\s*([-+0-9.eE]+))");
  Calibration calibration;
  for (std::size_t at = text.find("- {"); at != std::string::npos; at = text.find("- {", at + 1))
  {
    const std::string laser_text = text.substr(at, text.find('}', at) - at);
    Calibration::PerLaserCalib laser;
    std::size_t id = calibration.laser_corrections.size();
    for (std::sregex_iterator it(laser_text.begin(), laser_text.end(), pair), end; it != end; ++it)
    {
      const double value = std::strtod((*it)[2].str().c_str(), nullptr);
      setField(laser, (*it)[1], value);
      id =
          (*it)[1] == "laser_id" && value >= 0 && value < 64 ? static_cast<std::size_t>(value) : id;
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
    calibration = fromYaml(text);
  }
  // MRPT prints its complaints, so plainly wrong files are not shown to it.
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
