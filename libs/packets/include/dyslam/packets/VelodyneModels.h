// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
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

/** What the packets of a model mean, after the makers' user manuals. */
struct VelodyneTraits
{
  const char* name;  //!< "VLP16"
  std::size_t lasers;
  double range_unit;      //!< [m]
  double firing_time;     //!< of all lasers once, with the pause behind it [s]
  double shot_time;       //!< from one shot to the next [s]
  std::size_t at_a_time;  //!< lasers in each shot
};

/** \pre model != VelodyneModel::automatic */
[[nodiscard]] const VelodyneTraits& traitsOf(VelodyneModel model);
/** By the name, also with hyphens; nothing if it is unknown. "" and "auto": automatic. */
[[nodiscard]] std::optional<VelodyneModel> velodyneModelNamed(const std::string& name);
/** The model that an argument of --sensor names. \throws UserError for a name that is none of a
 * Velodyne whose packets are read. */
[[nodiscard]] VelodyneModel givenVelodyneModel(const std::string& sensor);
/** A field of options: the names, and auto. */
void describeVelodyneModel(OptionsVisitor& visitor,
                           const char* key,
                           VelodyneModel& model,
                           const char* help);
/** All names, for messages: "VLP16, HDL32E, ... or VLS128". */
[[nodiscard]] std::string velodyneModelNames();
/** By the last byte of the packets; nothing if it is unknown. An HDL-64E has no such byte. */
[[nodiscard]] std::optional<VelodyneModel> velodyneModelOf(std::uint8_t model_byte);
/** That of packets in an observation, which has the calibration of its lidar; nothing for a number
 * of lasers that no model has. */
[[nodiscard]] std::optional<VelodyneModel> velodyneModelOf(std::size_t lasers,
                                                           std::uint8_t model_byte);

/** The angles that the maker gives for all of a model. \pre the model is none of which every one
 * differs: not HDL-64E, not automatic */
[[nodiscard]] mrpt::obs::VelodyneCalibration usualCalibration(VelodyneModel model);
/** Reads a maker's XML, or the YAML that ROS drivers use. \throws UserError if it is neither or is
 * not of `lasers` lasers. */
[[nodiscard]] mrpt::obs::VelodyneCalibration readVelodyneCalibration(const std::string& path,
                                                                     std::size_t lasers);
/** Ring of each laser: its rank by vertical angle, the lowest beam is 0. */
[[nodiscard]] std::vector<std::uint16_t> ringsOf(const mrpt::obs::VelodyneCalibration& calibration);
}  // namespace dyslam
