// SPDX-License-Identifier: BSD-3-Clause
#include "Ground.h"

#include <algorithm>
#include <cmath>

#include "Random.h"

namespace dyslam::sim
{
Terrain::Terrain(std::uint64_t seed, double slope, double bumps)
{
  Rng rng(combine(seed, 0x7E22A1));
  const auto wave = [&](double length, double amplitude)
  {
    const double angle = rng.uniform(0, 2 * M_PI);
    const double k = 2 * M_PI / (length * rng.uniform(0.8, 1.25));
    waves_.push_back({k * std::cos(angle), k * std::sin(angle), rng.uniform(0, 6.28), amplitude});
  };
  for (const double length : {420.0, 260.0, 170.0})
  {
    wave(length, slope * length / 6.283 / 1.7 * rng.uniform(0.5, 1.2));
  }
  for (const double length : {47.0, 31.0, 23.0})
  {
    wave(length, bumps * 0.05 * rng.uniform(0.5, 1.2));
  }
  for (const double length : {9.0, 5.5})
  {
    wave(length, bumps * 0.012 * rng.uniform(0.5, 1.2));
  }
}

double Terrain::height(double x, double y) const
{
  double z = 0;
  for (const auto& w : waves_)
  {
    z += w.amplitude * std::sin(w.kx * x + w.ky * y + w.phase);
  }
  return z;
}

double Ground::headingOfU(const Eigen::Vector2d& local) const
{
  const Eigen::Vector2d d =
      toWorld(local + Eigen::Vector2d(0.5, 0)) - toWorld(local - Eigen::Vector2d(0.5, 0));
  return std::atan2(d.y(), d.x());
}

Eigen::Vector3f Ground::point(const Eigen::Vector2d& local, double above) const
{
  const Eigen::Vector2d w = toWorld(local);
  return Eigen::Vector3d(w.x(), w.y(), heightLocal(local) + above).cast<float>();
}

Mesh gridMesh(const Ground& ground,
              const std::vector<double>& u_lines,
              const std::vector<double>& v_lines,
              const std::function<Material(double, double)>& material)
{
  Mesh mesh;
  const std::size_t nu = u_lines.size(), nv = v_lines.size();
  mesh.vertices.reserve(nu * nv);
  for (const double v : v_lines)
  {
    for (const double u : u_lines)
    {
      mesh.vertices.push_back(ground.point({u, v}));
    }
  }
  for (std::size_t j = 0; j + 1 < nv; ++j)
  {
    for (std::size_t i = 0; i + 1 < nu; ++i)
    {
      const auto at = [&](std::size_t a, std::size_t b)
      { return static_cast<std::uint32_t>(b * nu + a); };
      mesh.quads.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      mesh.materials.push_back(
          material(0.5 * (u_lines[i] + u_lines[i + 1]), 0.5 * (v_lines[j] + v_lines[j + 1])));
    }
  }
  return mesh;
}

std::vector<double> fillLines(std::vector<double> fixed, const std::function<double(double)>& step)
{
  std::sort(fixed.begin(), fixed.end());
  std::vector<double> lines;
  for (std::size_t i = 0; i + 1 < fixed.size(); ++i)
  {
    const double gap = fixed[i + 1] - fixed[i];
    const int pieces =
        std::max(1, static_cast<int>(std::ceil(gap / step(0.5 * (fixed[i] + fixed[i + 1])))));
    for (int k = 0; k < pieces && gap > 1e-9; ++k)
    {
      lines.push_back(fixed[i] + gap * k / pieces);
    }
  }
  lines.push_back(fixed.back());
  return lines;
}
}  // namespace dyslam::sim
