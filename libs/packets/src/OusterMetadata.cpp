// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/packets/OusterMetadata.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
using Json = nlohmann::json;

constexpr std::size_t most_beams = 512;
constexpr std::size_t most_columns = 8192;
constexpr std::size_t most_values = 1 << 20;
constexpr double metres_per_millimetre = 1e-3;
constexpr const char* altitudes_name = "beam_altitude_angles";

/** Layouts of the makers' software user manuals (firmware 1.12 to 3.2). */
const std::vector<OusterProfile>& profiles()
{
  const OusterReturn whole{0, 4, 19, 1, 4};
  const OusterReturn first{0, 4, 19, 1, 3};
  const OusterReturn second{4, 4, 19, 1, 7};
  const OusterReturn low{0, 2, 15, 8, 2};
  const OusterReturn low_second{4, 2, 15, 8, 6};
  static const std::vector<OusterProfile> known{
      {"LEGACY", 12, {{0, 4, 20, 1, 4}}},
      {"RNG19_RFL8_SIG16_NIR16", 12, {whole}},
      {"RNG19_RFL8_SIG16_NIR16_DUAL", 16, {first, second}},
      {"RNG15_RFL8_NIR8", 4, {low}},
      {"RNG15_RFL8_NIR8_DUAL", 8, {low, low_second}},
      {"FUSA_RNG15_RFL8_NIR8_DUAL", 8, {low, low_second}},
      {"RNG15_RFL8_WIN8", 4, {low}},
      {"FIVE_WORD_PIXEL", 20, {first, second}},
      {"RNG15_RFL8_NIR8_ZONE16", 8, {low}},
      {"RNG19_RFL8_SIG16_NIR16_ZONE16", 12, {whole}},
      {"RNG19_RFL8_SIG16_ZONE16_DUAL", 16, {first, second}},
      {"RNG19_RFL8_SIG16_NIR16_RGB16", 16, {first}},
      {"RNG19_RFL8_SIG16_NIR16_RGB16_DUAL", 20, {first, second}},
  };
  return known;
}

/** Values of one file, wherever in it they are: newer firmware puts them into sections. */
class Values
{
 public:
  Values(const std::string& text, std::string place) : place_(std::move(place))
  {
    root_ = isNestedDeeper(text) ? Json() : Json::parse(text, nullptr, false);
    if (!root_.is_object())
    {
      throw UserError(place_ + ": is not JSON");
    }
  }

  [[noreturn]] void fail(const std::string& name, const std::string& why) const
  {
    throw UserError(place_ + ": " + name + " " + why + "; give the metadata of the Ouster lidar");
  }

  /** Null if there is none. */
  [[nodiscard]] const Json* find(const char* name) const
  {
    if (const auto at = root_.find(name); at != root_.end())
    {
      return &*at;
    }
    for (const char* section :
         {"sensor_info", "beam_intrinsics", "lidar_intrinsics", "imu_intrinsics",
          "lidar_data_format", "data_format", "config_params", "ouster-sdk"})
    {
      const auto in = root_.find(section);
      if (in != root_.end() && in->is_object() && in->contains(name))
      {
        return &in->at(name);
      }
    }
    return nullptr;
  }

  /** The numbers of an array, also one of arrays; empty if there is none of this name. */
  [[nodiscard]] std::vector<double> numbers(const char* name) const
  {
    std::vector<double> values;
    if (const Json* json = find(name))
    {
      append(name, *json, values);
    }
    return values;
  }

  [[nodiscard]] double number(const char* name, double otherwise) const
  {
    const Json* json = find(name);
    return json != nullptr && json->is_number() ? json->get<double>() : otherwise;
  }

  [[nodiscard]] std::string text(const char* name) const
  {
    const Json* json = find(name);
    return json != nullptr && json->is_string() ? json->get<std::string>() : "";
  }

 private:
  void append(const char* name, const Json& json, std::vector<double>& values) const
  {
    if (!json.is_array())
    {
      fail(name, "is not a list of numbers");
    }
    for (const Json& value : json)
    {
      if (value.is_array())
      {
        append(name, value, values);
      }
      else if (value.is_number() && values.size() < most_values)
      {
        values.push_back(value.get<double>());
      }
      else
      {
        fail(name, "is not a list of numbers");
      }
    }
  }

  Json root_;
  std::string place_;
};

OusterProfile profileOf(const Values& values)
{
  const std::string stated = values.text("udp_profile_lidar");
  const std::string name = stated.empty() ? "LEGACY" : stated;
  const auto& known = profiles();
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&name](const OusterProfile& p) { return p.name == name; });
  if (found == known.end())
  {
    values.fail("udp_profile_lidar", name + " is not known");
  }
  return *found;
}

/** "1024x10": columns and turns per second. */
std::size_t columnsOf(const Values& values)
{
  const std::string mode = values.text("lidar_mode");
  const double by_mode = mode.empty() ? 0 : std::strtod(mode.c_str(), nullptr);
  const double columns = values.number("columns_per_frame", by_mode);
  if (!(columns >= 1 && columns <= static_cast<double>(most_columns)))
  {
    values.fail("columns_per_frame", "is missing or no number of columns");
  }
  return static_cast<std::size_t>(columns);
}

std::size_t packetColumnsOf(const Values& values)
{
  constexpr double usual = 16;
  const double columns = values.number("columns_per_packet", usual);
  if (!(columns >= 1 && columns <= 256))
  {
    values.fail("columns_per_packet", "is no number of columns");
  }
  return static_cast<std::size_t>(columns);
}

/** A whole number from 1 to `most`; 0: not stated. */
std::uint32_t positiveOf(const Values& values, const char* name, double most)
{
  const double number = values.number(name, 0);
  return number >= 1 && number <= most ? static_cast<std::uint32_t>(number) : 0;
}

/** First and last column with returns. \pre the number of columns is set */
void readWindow(const Values& values, OusterMetadata& metadata)
{
  metadata.last_column = metadata.columns - 1;
  const auto window = values.numbers("column_window");
  if (window.size() == 2 && window[0] >= 0 && window[0] <= window[1] &&
      window[1] < static_cast<double>(metadata.columns))
  {
    metadata.first_column = static_cast<std::size_t>(window[0]);
    metadata.last_column = static_cast<std::size_t>(window[1]);
  }
}

/** Distance of the beams' origin from the axis, of firmware that does not state it [mm]. */
double usualOrigin(const std::string& product)
{
  const std::string line = product.substr(0, 4);
  return line == "OS-0" ? 27.67 : line == "OS-1" ? 15.806 : line == "OS-2" ? 13.762 : 12.163;
}

void readBeams(const Values& values, OusterMetadata& metadata)
{
  metadata.altitudes = values.numbers(altitudes_name);
  metadata.azimuths = values.numbers("beam_azimuth_angles");
  const std::size_t beams = metadata.altitudes.size();
  if (beams == 0 || beams > most_beams)
  {
    values.fail(altitudes_name, "has " + counted(beams, "angle") + ", one of each beam needed");
  }
  if (metadata.azimuths.size() != beams)
  {
    values.fail("beam_azimuth_angles", "has " + std::to_string(metadata.azimuths.size()) +
                                           " angles, " + altitudes_name + " " +
                                           std::to_string(beams));
  }
  const double rows = values.number("pixels_per_column", static_cast<double>(beams));
  if (rows != static_cast<double>(beams))
  {
    values.fail("pixels_per_column", "is not the number of the beams");
  }
  if (std::all_of(metadata.altitudes.begin(), metadata.altitudes.end(),
                  [](double angle) { return angle == 0; }))
  {
    values.fail(altitudes_name, "are all 0: the lidar's calibration is missing");
  }
  for (std::vector<double>* angles : {&metadata.altitudes, &metadata.azimuths})
  {
    std::transform(angles->begin(), angles->end(), angles->begin(),
                   [](double degrees) { return degrees / degrees_per_radian; });
  }
  const auto beam_to_lidar = values.numbers("beam_to_lidar_transform");
  if (!beam_to_lidar.empty() && beam_to_lidar.size() != 16)
  {
    values.fail("beam_to_lidar_transform", "has not 16 numbers");
  }
  const double outwards =
      beam_to_lidar.size() == 16
          ? beam_to_lidar[3]
          : values.number("lidar_origin_to_beam_origin_mm", usualOrigin(metadata.product));
  metadata.origin_outwards = metres_per_millimetre * outwards;
  metadata.origin_up = beam_to_lidar.size() == 16 ? metres_per_millimetre * beam_to_lidar[11] : 0;
}

/** Pose of the lidar in the frame of the sensor, of firmware that does not state it: x of the
 * sensor points to its front, x of the lidar to the connector. */
Pose usualLidarPose()
{
  constexpr double height = 36.18;  // [mm]
  Pose T_sensor_lidar = Pose::Identity();
  T_sensor_lidar.linear().diagonal() = Eigen::Vector3d(-1, -1, 1);
  T_sensor_lidar.translation().z() = metres_per_millimetre * height;
  return T_sensor_lidar;
}

/** Pose of the IMU in the frame of the sensor, of firmware that does not state it. */
Pose usualImuPose()
{
  Pose T_sensor_imu = Pose::Identity();
  T_sensor_imu.translation() = metres_per_millimetre * Eigen::Vector3d(6.253, -11.775, 7.645);
  return T_sensor_imu;
}

/** A pose. \param unit of its translation [m] \param usual if it is not stated */
Pose poseOf(const Values& values, const char* name, double unit, const Pose& usual)
{
  const auto m = values.numbers(name);
  if (m.empty())
  {
    return usual;
  }
  if (m.size() != 16)
  {
    values.fail(name, "has not 16 numbers");
  }
  Pose T_frame_part = Pose::Identity();
  for (int row = 0; row < 3; ++row)
  {
    const auto at = static_cast<std::size_t>(4 * row);
    T_frame_part.linear().row(row) << m[at], m[at + 1], m[at + 2];
    T_frame_part.translation()[row] = unit * m[at + 3];
  }
  const Eigen::Matrix3d R = T_frame_part.linear();
  if (!(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0)
  {
    values.fail(name, "is no pose");
  }
  return T_frame_part;
}
}  // namespace

OusterMetadata parseOusterMetadata(const std::string& text, const std::string& place)
{
  const Values values(text, place);
  OusterMetadata metadata;
  const std::string product = values.text("prod_line");
  metadata.product = product.empty() ? "Ouster" : product;
  metadata.serial = std::strtoull(values.text("prod_sn").c_str(), nullptr, 10);
  metadata.initialization = positiveOf(values, "initialization_id", (1U << 24U) - 1);
  metadata.lidar_port = static_cast<std::uint16_t>(positiveOf(values, "udp_port_lidar", 65535));
  metadata.imu_port = static_cast<std::uint16_t>(positiveOf(values, "udp_port_imu", 65535));
  metadata.profile = profileOf(values);
  metadata.fusa_header =
      values.text("header_type") == "FUSA" || metadata.profile.name.compare(0, 5, "FUSA_") == 0;
  metadata.columns = columnsOf(values);
  metadata.packet_columns = packetColumnsOf(values);
  readWindow(values, metadata);
  readBeams(values, metadata);
  metadata.T_sensor_lidar =
      poseOf(values, "lidar_to_sensor_transform", metres_per_millimetre, usualLidarPose());
  metadata.T_sensor_imu =
      poseOf(values, "imu_to_sensor_transform", metres_per_millimetre, usualImuPose());
  metadata.T_vehicle_sensor = poseOf(values, "extrinsic", 1, Pose::Identity());
  return metadata;
}

bool isOusterMetadata(const std::string& path)
{
  constexpr std::uintmax_t largest = 1 << 20;  // [bytes]
  std::error_code unreadable;
  const std::uintmax_t size = fs::file_size(path, unreadable);
  if (unreadable || size > largest)
  {
    return false;
  }
  try
  {
    return readWhole(path).find(altitudes_name) != std::string::npos;
  }
  catch (const UserError&)
  {
    return false;  // another file of the folder, whose owner keeps it private
  }
}

std::vector<std::string> ousterMetadataBeside(const std::string& capture)
{
  const fs::path path(capture);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::string stem = path.stem().string();
  std::vector<std::pair<std::size_t, std::string>> files;  // behind what the name has in common
  for (const auto& entry : entriesIfReadable(folder))
  {
    const fs::path& file = entry.path();
    if (lowerExtension(file.string()) == ".json" && isOusterMetadata(file.string()))
    {
      files.emplace_back(commonPrefix(file.stem().string(), stem), file.string());
    }
  }
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b)
            {
              return std::tuple(b.first, a.second.size(), a.second) <
                     std::tuple(a.first, b.second.size(), b.second);
            });
  std::vector<std::string> paths;
  for (const auto& [common, file] : files)
  {
    paths.push_back(file);
  }
  return paths;
}
}  // namespace dyslam
