// SPDX-License-Identifier: BSD-3-Clause
// The observations of depth cameras, with their images.
#include <stdexcept>

#include "ObjectLayout.h"

namespace dyslam
{
void ObjectLayout::camera()
{
  const ObjectHeader found = headerOf("TCamera", 6);
  const std::size_t distortion = found.version >= 3 ? 8 : 5;
  in_.skipAll(1 + distortion, sizeof(double));
  if (found.version < 4)
  {
    matrix();
  }
  else
  {
    in_.skipAll(4, sizeof(double));
  }
  if (found.version == 0)
  {
    matrix();
  }
  if (found.version >= 2)
  {
    in_.skip(2 * sizeof(std::uint32_t));
  }
  if (found.version >= 5)
  {
    (void)in_.text();
  }
  in_.skip(found.version >= 6 ? 1 : 0);
  end();
}

void ObjectLayout::image()
{
  const int version = header().version;
  requireVersion("CImage", version, 6, 9);
  if (in_.u8() != 0)
  {
    (void)in_.text();  // in a file of its own
  }
  else if (in_.u8() == 0)
  {
    in_.skip(3 * sizeof(std::uint32_t));
    const std::uint32_t bytes = in_.u32();
    in_.skip(version >= 9 ? sizeof(std::uint32_t) : 0);
    const bool zipped = in_.u8() != 0;
    in_.skip(zipped ? in_.u32() : bytes);
  }
  else
  {
    const auto width = static_cast<std::int32_t>(version >= 7 ? in_.u32() : 1);
    const auto height = static_cast<std::int32_t>(version >= 7 ? in_.u32() : 1);
    if (width >= 1 && height >= 1)
    {
      in_.skip(in_.u32());
    }
    else if (width < 0 && height < 0)
    {
      in_.skipAll(3ULL * static_cast<std::uint64_t>(-std::int64_t{width}),
                  static_cast<std::uint64_t>(-std::int64_t{height}));
    }
  }
  end();
}

void ObjectLayout::droppedImage()
{
  const std::size_t flag = in_.at();
  if (in_.u8() != 0)
  {
    const std::size_t from = in_.at();
    image();
    in_.erase(from);
    in_.replace(flag, 0);
  }
}

void ObjectLayout::rangeScanImages(int version)
{
  const bool has_ranges = flag();
  in_.skip(version >= 9 ? sizeof(float) : 0);
  if (has_ranges)
  {
    version >= 9 ? rangeMatrix() : matrix();
  }
  droppedImage();
  droppedImage();
  if (version >= 2)
  {
    camera();
  }
  if (version >= 4)
  {
    camera();
    pose();
  }
}

void ObjectLayout::rangeScanTail(int version)
{
  in_.skip(sizeof(float) + sizeof(std::uint64_t));  // standard error, time stamp
  (void)in_.text();                                 // label
  for (int file = 0; version >= 3 && file < 2; ++file)
  {
    flags(1);
    (void)in_.text();
  }
  flags(version >= 5 ? 1 : 0);
  in_.skip(version >= 6 ? 1 : 0);
  if (version >= 7 && in_.u8() != 0)
  {
    throw std::runtime_error("a range image with labels of its pixels, which cannot be read");
  }
  const int layers = version >= 10 ? in_.u8() : 0;
  for (int layer = 0; layer < layers; ++layer)
  {
    (void)in_.text();
    rangeMatrix();
  }
}

void ObjectLayout::rangeScan(int version)
{
  in_.skip(sizeof(float));
  pose();
  if (version == 0 || flag())
  {
    const std::uint32_t points = in_.u32();
    in_.skipAll(points, 3 * sizeof(float));
    in_.skipAll(points, version == 0 ? 1 : version >= 8 ? 2 * sizeof(std::uint16_t) : 0);
  }
  if (version >= 1)
  {
    rangeScanImages(version);
  }
  rangeScanTail(version);
}
}  // namespace dyslam
