// SPDX-License-Identifier: BSD-3-Clause
// PCD 0.7 and PLY 1.0, binary.
#include <dyslam/base/Bytes.h>
#include <dyslam/formats/CloudHeader.h>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "CloudFormat.h"

namespace dyslam
{
namespace
{
void appendFloats(std::string& out, const Eigen::Vector3f& v)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    appendBytes(out, v[axis]);
  }
}

CloudHeader headerOf(const CloudSummary& summary, std::vector<CloudHeaderField> fields)
{
  CloudHeader header;
  header.fields = std::move(fields);
  header.points = summary.count;
  header.has_fixed_length = true;
  return header;
}

class PcdFormat : public CloudFormat
{
 public:
  explicit PcdFormat(const CloudDescription& layout) : layout_(layout) {}

  /** PCL counts with 32 bits. */
  [[nodiscard]] std::uint64_t maxPoints() const override
  {
    return std::numeric_limits<std::uint32_t>::max();
  }

  [[nodiscard]] std::string header(const CloudSummary& summary) const override
  {
    CloudHeader header = headerOf(summary, {{"x"}, {"y"}, {"z"}, {"intensity"}});
    if (layout_.normals)
    {
      header.fields.insert(header.fields.end(), {{"normal_x"}, {"normal_y"}, {"normal_z"}});
    }
    header.viewpoint = layout_.origin;
    return pcdHeader(header);
  }

  void append(const MapPoints& points, std::size_t i, std::string& out) const override
  {
    appendFloats(out, points.points[i]);
    appendBytes(out, points.intensity[i]);
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
    const CloudFieldType type = exact() ? CloudFieldType::float64 : CloudFieldType::float32;
    CloudHeader header = headerOf(summary, {{"x", type}, {"y", type}, {"z", type}, {"intensity"}});
    if (layout_.normals)
    {
      header.fields.insert(header.fields.end(), {{"nx"}, {"ny"}, {"nz"}});
    }
    header.comment = "DySLAM static map";
    return plyHeader(header);
  }

  void append(const MapPoints& points, std::size_t i, std::string& out) const override
  {
    if (exact())
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        appendBytes(out, layout_.origin[axis] + static_cast<double>(points.points[i][axis]));
      }
    }
    else
    {
      appendFloats(out, points.points[i]);
    }
    appendBytes(out, points.intensity[i]);
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
