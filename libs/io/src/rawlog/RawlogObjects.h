// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>
#include <mrpt/rtti/CObject.h>

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "ByteWindow.h"
#include "ObjectLayout.h"

namespace dyslam
{
class GzInput;

/** The objects of a rawlog, checked before MRPT reads them.
 *
 * Observations that hold scans or poses are parsed by an ObjectLayout first, and so are those of
 * motion sensors. All others are skipped up to the next object and not read, as those of motion
 * sensors that are damaged or of an unknown version: each becomes an empty one of its class,
 * without a time stamp, or nothing if MRPT does not have the class.
 */
class RawlogObjects
{
 public:
  /** \param file must outlive this. */
  explicit RawlogObjects(GzInput& file) : file_(file), window_(file), layout_(window_) {}

  [[nodiscard]] bool atEnd();
  /** Passes the next object and appends the observations in it.
   * \return its class, null for an observation of one that MRPT does not have.
   * \throws NewerMrpt. \throws std::exception if it is damaged. */
  const mrpt::rtti::TRuntimeClassId* next(std::deque<mrpt::obs::CObservation::Ptr>& observations);
  /** How many observations were left out, for each class that MRPT does not have. */
  [[nodiscard]] const std::map<std::string, std::size_t>& leftOut() const { return left_out_; }

 private:
  void sensoryFrame(int version, std::deque<mrpt::obs::CObservation::Ptr>& observations);
  /** An observation whose header is at the window's position.
   * \param id its class, null if MRPT does not have it.
   * \return whether its end is known: else the next object begins here, if there is one. */
  bool observation(const ObjectHeader& header,
                   const mrpt::rtti::TRuntimeClassId* id,
                   std::deque<mrpt::obs::CObservation::Ptr>& observations);
  /** Appends the observation of a motion sensor whose header was passed.
   * \return false if it cannot be read: then the window is still behind the header. */
  bool motionSensor(const ObjectHeader& header,
                    std::deque<mrpt::obs::CObservation::Ptr>& observations);
  void skipObject();

  GzInput& file_;
  ByteWindow window_;
  ObjectLayout layout_;
  std::map<std::string, std::size_t> left_out_;
};

/** The object of MRPT in these bytes. \throws std::exception if they are damaged. */
[[nodiscard]] mrpt::serialization::CSerializable::Ptr objectFrom(std::string_view bytes);
}  // namespace dyslam
