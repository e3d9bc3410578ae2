// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <mrpt/obs/VelodyneCalibration.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
enum class VelodyneModel
{
  automatic,  //!< recognised from the packets
  vlp16,
  vlp16_hires,  //!< Puck Hi-Res
  hdl32e,
  hdl64e,
  vlp32c,  //!< Ultra Puck
  vls128   //!< Alpha Prime
};

/** Properties of a model's packets, after the maker's user manuals. */
struct VelodyneTraits
{
  const char* name;  //!< name of the model: "VLP16"
  std::size_t lasers;
  double range_unit;      //!< unit of ranges [m]
  double firing_time;     //!< time of a firing of all lasers, with the pause after it [s]
  double shot_time;       //!< time from one shot to the next [s]
  std::size_t at_a_time;  //!< number of lasers in each shot
};

/** \pre model != VelodyneModel::automatic */
[[nodiscard]] const VelodyneTraits& traitsOf(VelodyneModel model);
/** Model by its name, also with hyphens; nothing if it is unknown. "" and "auto": automatic. */
[[nodiscard]] std::optional<VelodyneModel> velodyneModelNamed(const std::string& name);
/** Model by the argument of --sensor. \throws UserError for a name that is not one of a supported
 * Velodyne. */
[[nodiscard]] VelodyneModel givenVelodyneModel(const std::string& sensor);
/** Describes a field of options, whose words are the names and auto. */
void describeVelodyneModel(OptionsVisitor& visitor,
                           const char* key,
                           VelodyneModel& model,
                           const char* help);
/** All names, for messages: "VLP16, HDL32E, ... or VLS128". */
[[nodiscard]] std::string velodyneModelNames();
/** Model by the last byte of the packets; nothing if unknown. An HDL-64E has no such byte. */
[[nodiscard]] std::optional<VelodyneModel> velodyneModelOf(std::uint8_t model_byte);
/** Model of the packets in an observation, which has the calibration of its lidar; nothing for a
 * number of lasers that no model has. */
[[nodiscard]] std::optional<VelodyneModel> velodyneModelOf(std::size_t lasers,
                                                           std::uint8_t model_byte);

/** Nominal angles of a model. \pre not HDL-64E, whose lidars all differ, and not automatic */
[[nodiscard]] mrpt::obs::VelodyneCalibration usualCalibration(VelodyneModel model);
/** Reads a maker's XML, or the YAML that ROS drivers use. \throws UserError if it is neither or is
 * not of `lasers` lasers. */
[[nodiscard]] mrpt::obs::VelodyneCalibration readVelodyneCalibration(const std::string& path,
                                                                     std::size_t lasers);
/** Ring of each laser: rank by vertical angle, 0: lowest. */
[[nodiscard]] std::vector<std::uint16_t> ringsOf(const mrpt::obs::VelodyneCalibration& calibration);
}  // namespace dyslam
