// SPDX-License-Identifier: BSD-3-Clause
#include "SceneParts.h"

#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/core/bits_math.h>
#include <mrpt/opengl/CArrow.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CText.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>

namespace dyslam
{
using mrpt::img::TColor;

namespace
{
std::uint8_t toByte(float v)
{
  return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0F, 255.0F)));
}

/** Is filled at once: MRPT's push_back() takes a lock and tells all viewers for every point. It is
 * written and copied as its base class. */
class FilledPoints : public mrpt::opengl::CPointCloudColoured
{
 public:
  explicit FilledPoints(std::size_t expected)
  {
    m_vertex_buffer_data.reserve(expected);
    m_color_buffer_data.reserve(expected);
  }
  void add(const Eigen::Vector3f& p, const TColor& colour)
  {
    m_vertex_buffer_data.emplace_back(p.x(), p.y(), p.z());
    m_color_buffer_data.push_back(colour);
  }
};
}  // namespace

TColor rampColour(float value)
{
  constexpr std::array<std::array<float, 3>, 6> stops{{{48, 70, 200},
                                                       {30, 170, 220},
                                                       {60, 210, 120},
                                                       {200, 220, 60},
                                                       {250, 150, 40},
                                                       {220, 50, 40}}};
  const float at = std::clamp(value, 0.0F, 1.0F) * static_cast<float>(stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const float rest = at - static_cast<float>(low);
  const auto mix = [&](std::size_t c)
  { return toByte(stops[low][c] + rest * (stops[low + 1][c] - stops[low][c])); };
  return TColor(mix(0), mix(1), mix(2));
}

TColor objectColour(int id)
{
  constexpr std::array<std::array<std::uint8_t, 3>, 8> colours{{{230, 60, 60},
                                                                {60, 180, 75},
                                                                {255, 190, 25},
                                                                {70, 130, 255},
                                                                {245, 130, 48},
                                                                {190, 70, 220},
                                                                {70, 220, 230},
                                                                {240, 90, 200}}};
  const auto& c = colours[static_cast<std::size_t>(std::abs(std::int64_t{id})) % colours.size()];
  return TColor(c[0], c[1], c[2]);
}

HeightRange heightRange(const std::vector<Eigen::Vector3f>& points)
{
  std::vector<float> heights;
  for (const auto& p : points)
  {
    if (p.allFinite())
    {
      heights.push_back(p.z());
    }
  }
  if (heights.empty())
  {
    return {};
  }
  const float low = quantile(heights, 0.02);
  return {low, std::max(quantile(heights, 0.98), low + 1.0F)};
}

mrpt::opengl::CPointCloudColoured::Ptr heightColoured(const std::vector<Eigen::Vector3f>& points,
                                                      const std::vector<float>& intensity,
                                                      float point_size)
{
  return heightColoured(points, intensity, heightRange(points), point_size);
}

mrpt::opengl::CPointCloudColoured::Ptr heightColoured(const std::vector<Eigen::Vector3f>& points,
                                                      const std::vector<float>& intensity,
                                                      const HeightRange& range,
                                                      float point_size)
{
  const auto cloud = std::make_shared<FilledPoints>(points.size());
  cloud->setPointSize(point_size);
  const bool has_intensity = intensity.size() == points.size();
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto& p = points[i];
    if (!p.allFinite())
    {
      continue;
    }
    const TColor colour = rampColour((p.z() - range.low) / (range.high - range.low));
    const float lit = has_intensity ? 0.65F + 0.6F * std::clamp(intensity[i], 0.0F, 1.0F) : 1.0F;
    const auto part = [lit](std::uint8_t c)
    { return mrpt::f2u8(static_cast<float>(toByte(lit * static_cast<float>(c))) / 255.0F); };
    cloud->add(p, TColor(part(colour.R), part(colour.G), part(colour.B)));
  }
  cloud->markAllPointsAsNew();
  return cloud;
}

mrpt::opengl::CPointCloudColoured::Ptr plainColoured(const std::vector<Eigen::Vector3f>& points,
                                                     const TColor& colour,
                                                     float point_size)
{
  const auto cloud = std::make_shared<FilledPoints>(points.size());
  cloud->setPointSize(point_size);
  const mrpt::img::TColorf exact(colour);
  const TColor c(mrpt::f2u8(exact.R), mrpt::f2u8(exact.G), mrpt::f2u8(exact.B));
  for (const auto& p : points)
  {
    if (p.allFinite())
    {
      cloud->add(p, c);
    }
  }
  cloud->markAllPointsAsNew();
  return cloud;
}

mrpt::opengl::CRenderizable::Ptr wireBox(const Box& box, const Pose& T, const TColor& colour)
{
  auto lines = mrpt::opengl::CSetOfLines::Create();
  const Eigen::Vector3d h = 0.5 * box.size;
  const auto line = [&](double x0, double y0, double z0, double x1, double y1, double z1)
  { lines->appendLine(x0 * h.x(), y0 * h.y(), z0 * h.z(), x1 * h.x(), y1 * h.y(), z1 * h.z()); };
  for (const double a : {-1.0, 1.0})
  {
    for (const double b : {-1.0, 1.0})
    {
      line(-1, a, b, 1, a, b);
      line(a, -1, b, a, 1, b);
      line(a, b, -1, a, b, 1);
    }
  }
  line(1, -1, -1, 1, 1, 1);  // a cross marks the front
  line(1, 1, -1, 1, -1, 1);
  lines->setLineWidth(2.0F);
  lines->setColor_u8(colour);
  Pose T_frame_box = Pose::Identity();
  T_frame_box.linear() = Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T_frame_box.translation() = box.centre;
  lines->setPose(toMrpt(T * T_frame_box));
  return lines;
}

mrpt::opengl::CRenderizable::Ptr textAt(const std::string& words,
                                        const Eigen::Vector3d& at,
                                        const TColor& colour)
{
  auto label = mrpt::opengl::CText::Create(words);
  label->setFont("sans", 20);
  label->setColor_u8(colour);
  label->setLocation(at.x(), at.y(), at.z());
  return label;
}

mrpt::opengl::CRenderizable::Ptr velocityArrow(const Eigen::Vector3d& at,
                                               const Eigen::Vector3d& velocity,
                                               const TColor& colour)
{
  constexpr double seconds = 1;
  constexpr double shortest = 0.2;
  const Eigen::Vector3d along = seconds * velocity;
  if (!(along.norm() > shortest))
  {
    return nullptr;
  }
  const auto f = [](double v) { return static_cast<float>(v); };
  const Eigen::Vector3d tip = at + along;
  auto shape = mrpt::opengl::CArrow::Create(f(at.x()), f(at.y()), f(at.z()), f(tip.x()), f(tip.y()),
                                            f(tip.z()), 0.25F, 0.06F, 0.2F);
  shape->setColor_u8(colour);
  return shape;
}

void insertObject(mrpt::opengl::COpenGLScene& scene, const TrackedObject& object, const Pose& T)
{
  const TColor colour = object.dynamic ? objectColour(object.id) : TColor(150, 150, 150);
  scene.insert(wireBox(object.box, T, colour));
  const Eigen::Vector3d top = object.box.centre + Eigen::Vector3d(0, 0, 0.5 * object.box.size.z());
  const std::string label = formatted("%s %d: %.1f m/s", toString(object.object_class).c_str(),
                                      object.id, object.velocity.norm());
  scene.insert(textAt(label, T * (top + Eigen::Vector3d(0, 0, 0.4)), colour));
  if (const auto shape = velocityArrow(T * top, T.linear() * object.velocity, colour))
  {
    scene.insert(shape);
  }
}

mrpt::opengl::CRenderizable::Ptr polyline(const std::vector<Eigen::Vector3d>& points,
                                          const TColor& colour,
                                          float width)
{
  if (points.size() < 2)
  {
    return nullptr;
  }
  auto lines = mrpt::opengl::CSetOfLines::Create();
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
  {
    const auto& a = points[i];
    const auto& b = points[i + 1];
    lines->appendLine(a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  }
  lines->setLineWidth(width);
  lines->setColor_u8(colour);
  return lines;
}
}  // namespace dyslam
