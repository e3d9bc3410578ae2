// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "ByteWindow.h"

namespace dyslam
{
/** Header of every object that MRPT serializes. */
struct ObjectHeader
{
  std::string class_name;  //!< without namespace
  int version = 0;
};

/** An object of a class or version that MRPT 2.5.8 does not have; the text says which. */
class NewerMrpt : public std::runtime_error
{
 public:
  explicit NewerMrpt(const std::string& object)
      : std::runtime_error(object + ", written by a newer MRPT than 2.5.8")
  {
  }
};

/** \throws NewerMrpt for a version above `newest`. \throws std::runtime_error for one below
 * `oldest`, or so far above `newest` that no MRPT writes it: the byte is damaged. */
void requireVersion(const std::string& class_name, int version, int oldest, int newest);

/** What to do about it, for messages. */
constexpr const char* newer_mrpt_advice =
    "record with MRPT 2.5.8, or export the scans as .pcd, .ply or .bin for scans2rawlog";

/** Whether only letters, digits, '_' and ':' are in it, as in names of classes. */
[[nodiscard]] bool isClassName(std::string_view name);

/** Parses serialized objects of MRPT 2.5.8, as `serializeFrom()` of each class reads them, and
 * checks every count against the available bytes: MRPT allocates memory by counts without such a
 * check.
 *
 * Every function passes one object and throws std::runtime_error if it is damaged or of a class or
 * version that is not known here, NewerMrpt if a newer MRPT has it. */
class ObjectLayout
{
 public:
  static constexpr std::uint64_t largest_side = 65536;  //!< of an image or matrix

  explicit ObjectLayout(ByteWindow& in) : in_(in) {}

  [[nodiscard]] ObjectHeader header();
  void end();

  /** True for the classes that observation() knows: those that hold scans or poses. */
  [[nodiscard]] static bool knows(const std::string& class_name);
  /** The rest of an observation behind its header. Images are removed from the bytes: they are not
   * used, and decoding one may need much more memory than it has bytes. */
  void observation(const ObjectHeader& header);
  /** True for the versions of CObservationIMU, CObservationOdometry and CObservationGPS that
   * motionSensor() reads. */
  [[nodiscard]] static bool knowsMotionSensor(const ObjectHeader& header);
  /** The rest of an IMU's, wheel odometry's or satellite receiver's observation behind its header.
   */
  void motionSensor(const ObjectHeader& header);
  /** A points map with its header, or nothing ("nullptr"). */
  void pointsMap();
  /** std::vector of numbers. \return how many. */
  std::uint32_t numbers(std::size_t size);
  /** A matrix with its header, of CMatrixF or CMatrixD. \param largest number of rows, columns */
  void matrix(std::uint64_t largest = largest_side);
  /** Rows and columns as uint32, then 16 bits for each. */
  void rangeMatrix();

 private:
  ObjectHeader headerOf(const char* class_name, int newest);
  /** A byte that MRPT reads as a bool: any value but 0 and 1 is set to 1. */
  bool flag();
  void flags(int count);
  void pose();
  void genericMapParameters();
  void insertionOptions();
  void likelihoodOptions();
  void renderOptions();
  void camera();
  void image();
  void droppedImage();
  void pointCloud();
  void robotPose(int version);
  void rotatingScan();
  void velodyneScan(int version);
  void rangeScan(int version);
  void rangeScanImages(int version);
  void rangeScanTail(int version);
  void preamble(const char* container);
  /** A text of at most 64 KiB, all of it in the file. */
  void label();
  std::uint32_t inertialValues(int version);
  void inertial(int version);
  void wheelOdometry(int version);
  void satelliteReceiver(int version);

  ByteWindow& in_;
};
}  // namespace dyslam
