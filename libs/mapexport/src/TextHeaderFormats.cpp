// SPDX-License-Identifier: BSD-3-Clause
// PCD 0.7 and PLY 1.0, binary.
#include <cstdio>

#include "CloudFormat.h"

namespace dyslam
{
namespace
{
/** Digits of the largest count: headers are filled up to it, so that their length is fixed. */
constexpr std::size_t most_digits = 20;

std::string filler(std::uint64_t count, std::size_t times)
{
  return std::string(times * (most_digits - std::to_string(count).size()), '.');
}

void appendFloats(std::string& out, const Eigen::Vector3f& v)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    appendNumber(out, v[axis]);
  }
}

class PcdFormat : public CloudFormat
{
 public:
  explicit PcdFormat(const CloudDescription& layout) : layout_(layout) {}

  [[nodiscard]] std::string header(const CloudSummary& summary) const override
  {
    const std::string count = std::to_string(summary.count);
    char viewpoint[128];
    std::snprintf(viewpoint, sizeof viewpoint, "VIEWPOINT %.15g %.15g %.15g 1 0 0 0\n",
                  layout_.origin.x(), layout_.origin.y(), layout_.origin.z());
    return "# .PCD v0.7 - Point Cloud Data file format " + filler(summary.count, 2) +
           "\nVERSION 0.7\nFIELDS x y z intensity" +
           (layout_.normals ? " normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4 4\nTYPE F F F F F F F"
                              "\nCOUNT 1 1 1 1 1 1 1"
                            : "\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1") +
           "\nWIDTH " + count + "\nHEIGHT 1\n" + viewpoint + "POINTS " + count + "\nDATA binary\n";
  }

  void append(const MapPoints& points, std::size_t i, std::string& out) const override
  {
    appendFloats(out, points.points[i]);
    appendNumber(out, points.intensity[i]);
    if (layout_.normals)
    {
      appendFloats(out, points.normals[i]);
    }
  }

 private:
  CloudDescription layout_;
};

class PlyFormat : public CloudFormat
{
 public:
  explicit PlyFormat(const CloudDescription& layout) : layout_(layout) {}

  [[nodiscard]] std::string header(const CloudSummary& summary) const override
  {
    const std::string type = exact() ? "double" : "float";
    return "ply\nformat binary_little_endian 1.0\ncomment DySLAM static map " +
           filler(summary.count, 1) + "\nelement vertex " + std::to_string(summary.count) +
           "\nproperty " + type + " x\nproperty " + type + " y\nproperty " + type +
           " z\nproperty float intensity\n" +
           (layout_.normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "") +
           "end_header\n";
  }

  void append(const MapPoints& points, std::size_t i, std::string& out) const override
  {
    if (exact())
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        appendNumber(out, layout_.origin[axis] + static_cast<double>(points.points[i][axis]));
      }
    }
    else
    {
      appendFloats(out, points.points[i]);
    }
    appendNumber(out, points.intensity[i]);
    if (layout_.normals)
    {
      appendFloats(out, points.normals[i]);
    }
  }

 private:
  /** Float32 would round coordinates that are far from zero. */
  [[nodiscard]] bool exact() const { return !layout_.origin.isZero(0); }

  CloudDescription layout_;
};
}  // namespace

std::unique_ptr<CloudFormat> makePcdFormat(const CloudDescription& layout)
{
  return std::make_unique<PcdFormat>(layout);
}

std::unique_ptr<CloudFormat> makePlyFormat(const CloudDescription& layout)
{
  return std::make_unique<PlyFormat>(layout);
}
}  // namespace dyslam
