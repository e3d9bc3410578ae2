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
  std::size_t range_at;         //!< byte within the data of a pixel
  std::size_t range_bytes;      //!< 2 or 4
  unsigned range_bits;          //!< the lowest of these
  unsigned range_unit;          //!< [mm]
  std::size_t reflectivity_at;  //!< byte within the data of a pixel
};

/** How the data packets are laid out. */
struct OusterProfile
{
  std::string name;         //!< as udp_profile_lidar has it
  std::size_t pixel_bytes;  //!< of one beam in one column
  std::vector<OusterReturn> returns;

  [[nodiscard]] bool isLegacy() const { return name == "LEGACY"; }
};

/** What the metadata of an Ouster lidar (.json) say of its packets and beams. */
struct OusterMetadata
{
  std::string product;       //!< "OS-1-128"
  std::uint64_t serial = 0;  //!< 0: not stated
  OusterProfile profile;
  bool fusa_header = false;        //!< packets begin with the header for functional safety
  std::size_t columns = 0;         //!< in a whole turn
  std::size_t packet_columns = 0;  //!< in each packet
  std::vector<double> altitudes;   //!< of the beams, rows of the image [rad]
  std::vector<double> azimuths;    //!< of the beams from the direction of the encoder [rad]
  /** Of the beams' common origin from the axis of the turn, outwards and up [m]. */
  double origin_outwards = 0;
  double origin_up = 0;
  Pose T_sensor_lidar = Pose::Identity();

  [[nodiscard]] std::size_t beams() const { return altitudes.size(); }
};

/** Reads metadata of any firmware: those of the 1.x and 2.x with all values in one level, and the
 * later ones with sections.
 * \param place for messages: the file, or the topic of a bag.
 * \throws UserError naming the value that is missing or wrong. */
[[nodiscard]] OusterMetadata parseOusterMetadata(const std::string& text, const std::string& place);

/** The .json files in the folder of a capture that are metadata of an Ouster lidar, first those
 * whose names have most in common with the capture's. */
[[nodiscard]] std::vector<std::string> ousterMetadataBeside(const std::string& capture);
}  // namespace dyslam
