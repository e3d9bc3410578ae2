// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** One return of a firing in an Ouster data packet. */
struct OusterReturn
{
  std::size_t range_at;         //!< position of the range in the data of a pixel [bytes]
  std::size_t range_bytes;      //!< size of the range: 2 or 4 bytes
  unsigned range_bits;          //!< number of (lowest) bits that are the range
  unsigned range_unit;          //!< unit of ranges [mm]
  std::size_t reflectivity_at;  //!< position of the reflectivity in a pixel [bytes]
};

/** Layout of the data packets. */
struct OusterProfile
{
  std::string name;         //!< value of udp_profile_lidar
  std::size_t pixel_bytes;  //!< size of the data of a pixel (a beam in a column)
  std::vector<OusterReturn> returns;

  [[nodiscard]] bool isLegacy() const { return name == "LEGACY"; }
};

/** Packets and beams of an Ouster lidar, from its metadata (.json). */
struct OusterMetadata
{
  std::string product;               //!< name of the product: "OS-1-128"
  std::uint64_t serial = 0;          //!< serial number; 0: not stated
  std::uint32_t initialization = 0;  //!< number of the sensor's initialization; 0: not stated
  std::uint16_t lidar_port = 0;      //!< UDP port of the data packets; 0: not stated
  std::uint16_t imu_port = 0;        //!< UDP port of the packets of the IMU; 0: not stated
  OusterProfile profile;
  bool fusa_header = false;        //!< packets begin with the header for functional safety
  std::size_t columns = 0;         //!< number of columns in a revolution
  std::size_t packet_columns = 0;  //!< number of columns in a packet
  /** First and last column of the azimuth window; of a revolution, also if the window holds the
   * connector. */
  std::size_t first_column = 0;
  std::size_t last_column = 0;
  std::vector<double> altitudes;  //!< elevations of the beams (rows of the image) [rad]
  std::vector<double> azimuths;   //!< azimuths of the beams from the encoder's direction [rad]
  /** Offset of the beams' common origin from the axis of rotation, outwards and up [m]. */
  double origin_outwards = 0;
  double origin_up = 0;
  Pose T_sensor_lidar = Pose::Identity();
  Pose T_sensor_imu = Pose::Identity();
  /** Pose that Ouster's SDK was told (extrinsic); the identity if it was not. */
  Pose T_vehicle_sensor = Pose::Identity();

  [[nodiscard]] std::size_t beams() const { return altitudes.size(); }
};

/** Reads metadata of any firmware: those of the 1.x and 2.x with all values in one level, and the
 * later ones with sections.
 * \param place for messages: the file, or the topic of a bag.
 * \throws UserError naming the value that is missing or wrong. */
[[nodiscard]] OusterMetadata parseOusterMetadata(const std::string& text, const std::string& place);

/** Whether a file holds beam angles as the metadata of an Ouster lidar do, whatever its name. */
[[nodiscard]] bool isOusterMetadata(const std::string& path);

/** The .json files in the folder of a capture that are metadata of an Ouster lidar, first those
 * whose names have most in common with the capture's. */
[[nodiscard]] std::vector<std::string> ousterMetadataBeside(const std::string& capture);
}  // namespace dyslam
