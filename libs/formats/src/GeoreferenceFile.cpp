// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/TextFile.h>

#include <array>
#include <ostream>
#include <utility>

namespace dyslam
{
namespace
{
constexpr const char* georeference_section = "georeference";
constexpr double unset = 1e9;  // of a key that the file must have
constexpr double farthest = 1e8;

/** The values of the file. */
struct GeoreferenceOptions : Options
{
  double latitude = unset;
  double longitude = unset;
  double height = unset;
  double east = unset;
  double north = unset;
  double up = unset;
  double yaw = unset;
  double pitch = unset;
  double roll = unset;
  int epsg = 0;
  int fixes = 0;
  double horizontal_rmse = 0;
  double vertical_rmse = 0;
  bool fused = false;

  void describe(OptionsVisitor& visitor) override
  {
    visitor.real("latitude_deg", latitude, -90, unset,
                 "of the origin of the axes east, north, up; WGS84 [deg]");
    visitor.real("longitude_deg", longitude, -360, unset, "of the origin [deg]");
    visitor.real("height", height, -farthest, unset, "of the origin, above the ellipsoid [m]");
    visitor.real("east", east, -farthest, unset, "of the map's origin [m]");
    visitor.real("north", north, -farthest, unset, "of the map's origin [m]");
    visitor.real("up", up, -farthest, unset, "of the map's origin [m]");
    visitor.real("yaw_deg", yaw, -360, unset,
                 "of the map's x axis from the east, counter-clockwise [deg]");
    visitor.real("pitch_deg", pitch, -360, unset,
                 "of the map about its y axis, after the yaw [deg]");
    visitor.real("roll_deg", roll, -360, unset,
                 "of the map about its x axis, after the pitch [deg]");
    visitor.integer("epsg", epsg, 0, 99999,
                    "coordinate reference system of UTM at the map's origin");
    visitor.integer("fixes", fixes, 0, 2147483647, "positions of the receiver that were used");
    visitor.real("horizontal_rmse", horizontal_rmse, 0, farthest,
                 "of these positions from the trajectory [m]");
    visitor.real("vertical_rmse", vertical_rmse, 0, farthest,
                 "of these positions from the trajectory [m]");
    visitor.flag("fused", fused, "the map was optimised with the positions");
  }
};

std::string allDigits(double value)
{
  std::string text;
  appendNumber(text, value, 17);
  return text;
}
}  // namespace

void writeGeoreference(const Georeference& georeference, const std::string& path)
{
  const Pose& T = georeference.T_enu_map;
  const Eigen::Vector3d angles = degrees_per_radian * yawPitchRoll(T);
  writeWhole(
      path,
      [&](std::ostream& out)
      {
        out << "# Where the map frame is on the earth (WGS84): the map's origin is at east,\n"
               "# north and up from the position of the first three lines.\n["
            << georeference_section
            << "]\nlatitude_deg = " << allDigits(georeference.origin.latitude)
            << "\nlongitude_deg = " << allDigits(georeference.origin.longitude)
            << "\nheight = " << allDigits(georeference.origin.height)
            << "\neast = " << allDigits(T.translation().x())
            << "\nnorth = " << allDigits(T.translation().y())
            << "\nup = " << allDigits(T.translation().z()) << "\nyaw_deg = " << allDigits(angles[0])
            << "\npitch_deg = " << allDigits(angles[1]) << "\nroll_deg = " << allDigits(angles[2])
            << "\nepsg = " << georeference.epsg << "\nfixes = " << georeference.fixes
            << "\nhorizontal_rmse = " << allDigits(georeference.horizontal_rmse)
            << "\nvertical_rmse = " << allDigits(georeference.vertical_rmse)
            << "\nfused = " << (georeference.fused ? "true" : "false") << '\n';
      });
}

Georeference readGeoreference(const std::string& path)
{
  GeoreferenceOptions values;
  load(values, Config::fromFile(path), georeference_section);
  const std::array<std::pair<const char*, double>, 9> needed{{{"latitude_deg", values.latitude},
                                                              {"longitude_deg", values.longitude},
                                                              {"height", values.height},
                                                              {"east", values.east},
                                                              {"north", values.north},
                                                              {"up", values.up},
                                                              {"yaw_deg", values.yaw},
                                                              {"pitch_deg", values.pitch},
                                                              {"roll_deg", values.roll}}};
  for (const auto& [key, value] : needed)
  {
    if (value == unset)
    {
      throw UserError(path + ": has no " + georeference_section + "." + key);
    }
  }
  Georeference result;
  result.origin = {values.latitude, values.longitude, values.height};
  result.T_enu_map =
      poseFromYpr(values.east, values.north, values.up, radians_per_degree * values.yaw,
                  radians_per_degree * values.pitch, radians_per_degree * values.roll);
  result.epsg = values.epsg;
  result.fixes = static_cast<std::size_t>(values.fixes);
  result.horizontal_rmse = values.horizontal_rmse;
  result.vertical_rmse = values.vertical_rmse;
  result.fused = values.fused;
  return result;
}
}  // namespace dyslam
