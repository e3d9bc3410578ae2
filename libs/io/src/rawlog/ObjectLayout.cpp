// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectLayout.h"

#include <mrpt/obs/CObservationVelodyneScan.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr std::uint8_t end_flag = 0x88;
constexpr std::uint64_t largest_lasers = 1024;  //!< of a lidar
constexpr std::size_t real = sizeof(double);
constexpr std::size_t time_stamp = sizeof(std::uint64_t);

using Packet = mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket;
using Laser = mrpt::obs::VelodyneCalibration::PerLaserCalib;

[[noreturn]] void fail(const std::string& what)
{
  throw std::runtime_error(what);
}
}  // namespace

bool isClassName(std::string_view name)
{
  return std::all_of(
      name.begin(), name.end(),
      [](char c)
      { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':'; });
}

void requireVersion(const std::string& class_name, int version, int oldest, int newest)
{
  constexpr int most_newer = 20;  // versions of MRPT's classes grow by one in years
  const std::string object = "a " + class_name + " of version " + std::to_string(version);
  if (version > newest && version <= newest + most_newer)
  {
    throw NewerMrpt(object);
  }
  if (version < oldest || version > newest)
  {
    fail(object + ", which is not known");
  }
}

ObjectHeader ObjectLayout::header()
{
  const std::uint8_t length = in_.u8();
  if ((length & 0x80U) == 0)
  {
    fail("no object where one should begin");
  }
  ObjectHeader header;
  const std::size_t from = in_.at();
  in_.skip(length & 0x7FU);
  header.class_name = in_.since(from);
  if (header.class_name != "nullptr")
  {
    header.version = in_.u8();
  }
  header.class_name.erase(0, header.class_name.rfind(':') + 1);
  return header;
}

void ObjectLayout::end()
{
  if (in_.u8() != end_flag)
  {
    fail("an object does not end where it should");
  }
}

ObjectHeader ObjectLayout::headerOf(const char* class_name, int newest)
{
  ObjectHeader found = header();
  if (found.class_name != class_name)
  {
    fail(std::string("no ") + class_name + " where one should be");
  }
  requireVersion(class_name, found.version, 0, newest);
  return found;
}

bool ObjectLayout::flag()
{
  const std::size_t place = in_.at();
  const std::uint8_t value = in_.u8();
  if (value > 1)
  {
    in_.replace(place, 1);
  }
  return value != 0;
}

void ObjectLayout::flags(int count)
{
  for (int i = 0; i < count; ++i)
  {
    (void)flag();
  }
}

std::uint32_t ObjectLayout::numbers(std::size_t size)
{
  const std::uint32_t count = in_.u32();
  in_.skipAll(count, size);
  return count;
}

void ObjectLayout::matrix(std::uint64_t largest)
{
  const ObjectHeader found = header();
  // CMatrix is the name of CMatrixF before MRPT 2.
  const bool single = found.class_name == "CMatrixF" || found.class_name == "CMatrix";
  if ((!single && found.class_name != "CMatrixD") || found.version != 0)
  {
    fail("no matrix where one should be");
  }
  const std::uint64_t rows = in_.u32();
  const std::uint64_t columns = in_.u32();
  if (rows > largest || columns > largest)
  {
    fail("a matrix of " + std::to_string(rows) + " x " + std::to_string(columns));
  }
  in_.skipAll(rows * columns, single ? sizeof(float) : real);
  end();
}

void ObjectLayout::rangeMatrix()
{
  const std::uint64_t rows = in_.u32();
  const std::uint64_t columns = in_.u32();
  if (rows > largest_side || columns > largest_side)
  {
    fail("a range image of " + std::to_string(rows) + " x " + std::to_string(columns));
  }
  in_.skipAll(rows * columns, sizeof(std::uint16_t));
}

void ObjectLayout::pose()
{
  const ObjectHeader found = headerOf("CPose3D", 3);
  constexpr std::size_t quaternion = 7;
  constexpr std::size_t rows = 12;
  if (found.version < 2)
  {
    matrix(4);
  }
  else
  {
    in_.skipAll(found.version == 2 ? quaternion : rows, real);
  }
  end();
}

void ObjectLayout::genericMapParameters()
{
  (void)headerOf("TMapGenericParams", 0);
  flags(3);
  end();
}

void ObjectLayout::insertionOptions()
{
  requireVersion("TInsertionOptions", in_.u8(), 0, 0);
  in_.skip(sizeof(float));
  flags(5);
  in_.skip(2 * sizeof(float));
  flags(1);
}

void ObjectLayout::likelihoodOptions()
{
  requireVersion("TLikelihoodOptions", in_.u8(), 0, 0);
  in_.skip(2 * real + sizeof(std::uint32_t));
}

void ObjectLayout::renderOptions()
{
  requireVersion("TRenderOptions", in_.u8(), 0, 0);
  constexpr std::size_t colour = 4 * sizeof(float);
  in_.skip(sizeof(float) + colour + 1);
}

void ObjectLayout::pointsMap()
{
  const auto [name, version] = header();
  if (name == "nullptr")
  {
    end();
    return;
  }
  const bool simple = name == "CSimplePointsMap";
  const bool coloured = name == "CColouredPointsMap";
  const bool weighted = name == "CWeightedPointsMap";
  if (!simple && !coloured && !weighted && name != "CPointsMapXYZI")
  {
    if (isClassName(name) && name.find("PointsMap") != std::string::npos)
    {
      throw NewerMrpt("points of class '" + name + "'");
    }
    fail("no points where they should be");
  }
  // Older versions are from before there were point clouds among the observations.
  const int oldest = simple || coloured ? 8 : weighted ? 1 : 0;
  requireVersion(name, version, oldest, simple ? 10 : coloured ? 9 : weighted ? 2 : 0);
  const std::uint32_t count = in_.u32();
  in_.skipAll(count, (simple || coloured ? 3 : 4) * sizeof(float));
  for (int channel = 0; coloured && channel < 3; ++channel)
  {
    if (numbers(sizeof(float)) != count)
    {
      fail("points and colours of different numbers");
    }
  }
  if (simple || coloured || weighted)
  {
    version >= (weighted ? 2 : 9) ? genericMapParameters() : in_.skip(1);
  }
  insertionOptions();
  likelihoodOptions();
  if (simple && version >= 10)
  {
    renderOptions();
  }
  end();
}

void ObjectLayout::pointCloud()
{
  (void)in_.text();  // label
  in_.skip(time_stamp);
  pose();
  const bool external = in_.u8() != 0;  // in one of several formats
  if (external)
  {
    (void)in_.text();
  }
  else
  {
    pointsMap();
  }
}

void ObjectLayout::robotPose(int version)
{
  if (headerOf("CPose3DPDFGaussian", 1).version != 1)
  {
    fail("a pose of version 0, which is not known");
  }
  pose();
  constexpr std::size_t covariance = 21;
  in_.skipAll(covariance, real);
  end();
  (void)in_.text();  // label
  in_.skip(time_stamp);
  if (version >= 1)
  {
    pose();
  }
}

void ObjectLayout::rotatingScan()
{
  in_.skip(time_stamp);
  (void)in_.text();  // label
  in_.skip(2 * sizeof(std::uint16_t) + 4 * real);
  (void)in_.text();  // model
  in_.skip(2 * real);
  pose();
  in_.skip(time_stamp);
  flags(1);
  std::uint64_t pixels = 0;
  for (const std::size_t size : {sizeof(std::uint16_t), sizeof(std::uint8_t)})
  {
    const std::uint64_t columns = in_.u16();
    const std::uint64_t rows = in_.u16();
    in_.skipAll(rows * columns, size);
    pixels = size == sizeof(std::uint16_t) ? rows * columns : pixels;
  }
  const std::uint16_t layers = in_.u16();
  if (layers > 0 && pixels == 0)
  {
    fail("layers of a range image that is empty");
  }
  for (std::uint16_t layer = 0; layer < layers; ++layer)
  {
    (void)in_.text();
    in_.skipAll(pixels, sizeof(std::uint16_t));
  }
}

void ObjectLayout::preamble(const char* container)
{
  if (in_.text() != container)
  {
    fail(std::string("no ") + container + " where one should be");
  }
  (void)in_.text();  // what it holds
}

void ObjectLayout::velodyneScan(int version)
{
  in_.skip(time_stamp);
  (void)in_.text();  // label
  in_.skip(2 * real);
  pose();
  (void)numbers(sizeof(Packet));
  (void)numbers(sizeof(Laser));
  const std::uint32_t points = numbers(sizeof(float));
  if (numbers(sizeof(float)) != points || numbers(sizeof(float)) != points)
  {
    fail("points whose coordinates are of different numbers");
  }
  (void)numbers(sizeof(std::uint8_t));  // intensity
  flags(version >= 1 ? 1 : 0);
  if (version < 2)
  {
    return;
  }
  preamble("std::vector");  // times
  (void)numbers(time_stamp);
  (void)numbers(sizeof(float));         // azimuths
  (void)numbers(sizeof(std::int16_t));  // lasers
  preamble("std::vector");              // the points of each laser
  const std::uint32_t lasers = in_.u32();
  if (lasers > largest_lasers)
  {
    fail(std::to_string(lasers) + " lasers");
  }
  for (std::uint32_t laser = 0; laser < lasers; ++laser)
  {
    (void)numbers(sizeof(std::uint64_t));
  }
}

namespace
{
struct Known
{
  const char* class_name;
  int newest;
};
constexpr std::array<Known, 5> known{{{"CObservationPointCloud", 0},
                                      {"CObservationRobotPose", 1},
                                      {"CObservationRotatingScan", 0},
                                      {"CObservationVelodyneScan", 2},
                                      {"CObservation3DRangeScan", 10}}};

const Known* find(const std::string& class_name)
{
  for (const Known& one : known)
  {
    if (class_name == one.class_name)
    {
      return &one;
    }
  }
  return nullptr;
}
}  // namespace

bool ObjectLayout::knows(const std::string& class_name)
{
  return find(class_name) != nullptr;
}

void ObjectLayout::observation(const ObjectHeader& header)
{
  const auto& [name, version] = header;
  const Known* one = find(name);
  if (one == nullptr)
  {
    fail("an observation of class '" + name + "', which is not known");
  }
  requireVersion(name, version, 0, one->newest);
  if (name == "CObservationPointCloud")
  {
    pointCloud();
  }
  else if (name == "CObservationRobotPose")
  {
    robotPose(version);
  }
  else if (name == "CObservationRotatingScan")
  {
    rotatingScan();
  }
  else if (name == "CObservationVelodyneScan")
  {
    velodyneScan(version);
  }
  else
  {
    rangeScan(version);
  }
  end();
}
}  // namespace dyslam
