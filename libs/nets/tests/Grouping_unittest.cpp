// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/Grouping.h>
#include <gtest/gtest.h>

#include "SyntheticScan.h"

namespace dyslam
{
namespace
{
/** A scan and points near its surfaces, away from the centres of image cells. */
struct Fixture
{
  ScanTensors scan = toTensors(prepareScan(testing::room(64, 1800)));
  torch::Tensor points, normals, valid;
  Fixture()
  {
    torch::manual_seed(1);
    const ScanTensors::Level& level = scan.levels[1];
    valid = level.valid.clone();
    valid.slice(0, 100, 200).zero_();
    points = level.xyz + 0.1 * torch::randn_like(level.xyz);
    normals = level.normal;
  }
};

float largestDifference(const torch::Tensor& a, const torch::Tensor& b)
{
  return (a - b).abs().max().item<float>();
}

TEST(Grouping, NearestInWindowMatchesReference)
{
  const Fixture f;
  for (const std::size_t level : {1U, 3U})
  {
    const Neighbours fast = nearestInWindow(f.points, f.valid, f.scan, level, 1, 2, 6);
    const Neighbours slow = reference::nearestInWindow(f.points, f.valid, f.scan, level, 1, 2, 6);
    EXPECT_TRUE(torch::equal(fast.usable, slow.usable));
    const torch::Tensor& xyz = f.scan.levels[level].xyz;
    const auto distance = [&](const Neighbours& n)
    { return (gather(xyz, n.index) - f.points.unsqueeze(1)).norm(2, 2) * n.usable; };
    // Nodes may swap at equal distances and at cell borders; distances may not differ otherwise.
    const torch::Tensor differ =
        (distance(fast) - distance(slow)).abs().gt(1e-3).to(torch::kFloat).amax(1);
    EXPECT_LE(differ.sum().item<float>(), 2);
  }
}

TEST(Grouping, GeometryMatchesReference)
{
  const Fixture f;
  const Neighbours near = nearestInWindow(f.points, f.valid, f.scan, 1, 1, 2, 6);
  const ScanTensors::Level& level = f.scan.levels[1];
  EXPECT_LT(largestDifference(groupOffsets(level.xyz, f.points, near.index, 0.05),
                              reference::groupOffsets(level.xyz, f.points, near.index, 0.05)),
            1e-4F);
  const Candidates fast = candidateGeometry(f.points, f.normals, level, near.index, 0.05);
  const Candidates slow =
      reference::candidateGeometry(f.points, f.normals, level, near.index, 0.05);
  EXPECT_LT(largestDifference(fast.geometry, slow.geometry), 1e-4F);
  EXPECT_LT(largestDifference(fast.planes, slow.planes), 1e-4F);
}

TEST(Grouping, SurfacesMatchReference)
{
  const Fixture f;
  const Surfaces fast = surfacesAround(f.points, f.normals, f.valid, f.scan);
  const Surfaces slow = reference::surfacesAround(f.points, f.normals, f.valid, f.scan);
  const torch::Tensor both = fast.valid * slow.valid;
  EXPECT_GT(both.sum().item<float>(), 1500);
  EXPECT_LE((fast.valid - slow.valid).abs().sum().item<float>(), 4);
  const torch::Tensor moved = (fast.target - slow.target).norm(2, 1) * both;
  EXPECT_LE(moved.gt(1e-3).sum().item<std::int64_t>(), 8);  // cell borders
  // Normals are defined for planar surfaces only, up to their sign.
  const torch::Tensor planar = both * slow.features.select(1, 2).lt(0.1).to(torch::kFloat);
  const torch::Tensor agree = (fast.normal * slow.normal).sum(1).abs();
  EXPECT_GT(((agree * planar).sum() / planar.sum()).item<float>(), 0.999F);
  EXPECT_LT(((fast.thickness - slow.thickness).abs() * planar).max().item<float>(), 0.01F);
  EXPECT_LE(
      (fast.features - slow.features).abs().amax(1).mul(planar).gt(0.02).sum().item<std::int64_t>(),
      20);
}

TEST(Grouping, SurfacesWithoutFeaturesAreTheSame)
{
  const Fixture f;
  const Surfaces full = surfacesAround(f.points, f.normals, f.valid, f.scan);
  const Surfaces bare = surfacesAround(f.points, {}, f.valid, f.scan);
  EXPECT_FALSE(bare.features.defined());
  EXPECT_TRUE(torch::equal(full.normal, bare.normal));
  EXPECT_TRUE(torch::equal(full.target, bare.target));
  EXPECT_TRUE(torch::equal(full.thickness, bare.thickness));
}

/** Every other node of a level is a view that is not contiguous. */
TEST(Grouping, SurfacesOfStridedViewsAreTheSame)
{
  const Fixture f;
  const torch::Tensor between = torch::stack({f.valid, 1 - f.valid}, 1).select(1, 0);
  ASSERT_FALSE(between.is_contiguous());
  const torch::Tensor points = torch::stack({f.points, -f.points}, 1).select(1, 0);
  ASSERT_FALSE(points.is_contiguous());
  const Surfaces expected = surfacesAround(f.points, f.normals, f.valid, f.scan);
  const Surfaces found = surfacesAround(points, f.normals, between, f.scan);
  EXPECT_TRUE(torch::equal(expected.valid, found.valid));
  EXPECT_TRUE(torch::equal(expected.target, found.target));
}

TEST(Grouping, SameBytesForAnyNumberOfThreads)
{
  const Fixture f;
  const int threads = torch::get_num_threads();
  torch::set_num_threads(1);
  const Surfaces one = surfacesAround(f.points, f.normals, f.valid, f.scan);
  torch::set_num_threads(2);
  const Surfaces two = surfacesAround(f.points, f.normals, f.valid, f.scan);
  torch::set_num_threads(threads);
  EXPECT_TRUE(torch::equal(one.features, two.features));
  EXPECT_TRUE(torch::equal(one.target, two.target));
}

TEST(Grouping, LinearAndItsGradientsMatchReference)
{
  torch::manual_seed(2);
  const torch::Tensor geometry = torch::randn({300, 6, 4});
  const torch::Tensor index = torch::randint(50, {300, 6}, torch::kLong);
  const auto leaf = torch::dtype(torch::kFloat).requires_grad(true);
  const torch::Tensor features = torch::randn({50, 5}, leaf);
  const torch::Tensor weight = torch::randn({8, 9}, leaf);
  const torch::Tensor bias = torch::randn({8}, leaf);
  const torch::Tensor mix = torch::randn({300, 6, 8});
  const torch::Tensor fast = groupedLinear(geometry, features, index, weight, bias, 0.1);
  const torch::Tensor slow = reference::groupedLinear(geometry, features, index, weight, bias, 0.1);
  EXPECT_LT(largestDifference(fast, slow), 1e-4F);
  const auto a = torch::autograd::grad({(fast * mix).sum()}, {features, weight, bias});
  const auto b = torch::autograd::grad({(slow * mix).sum()}, {features, weight, bias});
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_LT(largestDifference(a[i], b[i]) / b[i].abs().max().item<float>(), 1e-4F) << i;
  }
  // With an input per group, and with the gradient of the geometry.
  const torch::Tensor own = torch::randn({300, 8}, leaf);
  const torch::Tensor places = geometry.clone().set_requires_grad(true);
  const auto c = torch::autograd::grad(
      {(groupedLinear(places, features, index, weight, bias, 0.1, own) * mix).sum()},
      {places, own});
  const auto d = torch::autograd::grad(
      {(reference::groupedLinear(places, features, index, weight, bias, 0.1, own) * mix).sum()},
      {places, own});
  for (std::size_t i = 0; i < c.size(); ++i)
  {
    EXPECT_LT(largestDifference(c[i], d[i]), 1e-4F) << i;
  }
  const torch::Tensor narrow = torch::randn({8, 4}, leaf);
  EXPECT_LT(largestDifference(groupedLinear(geometry, {}, index, narrow, bias, 0.1),
                              reference::groupedLinear(geometry, {}, index, narrow, bias, 0.1)),
            1e-4F);
}

TEST(Grouping, MaxMatchesReferenceAndItsGradient)
{
  torch::manual_seed(3);
  const torch::Tensor x =
      torch::randn({200, 7, 5}, torch::dtype(torch::kFloat).requires_grad(true));
  torch::Tensor usable = torch::rand({200, 7}).gt(0.3).to(torch::kFloat);
  usable[3].zero_();
  const torch::Tensor mix = torch::randn({200, 5});
  const torch::Tensor fast = groupMax(x, usable);
  const torch::Tensor slow = reference::groupMax(x, usable);
  EXPECT_EQ(largestDifference(fast, slow), 0);
  EXPECT_EQ(fast[3].abs().max().item<float>(), 0);
  {
    const torch::NoGradGuard no_grad;
    EXPECT_TRUE(torch::equal(groupMax(x, usable), fast));
  }
  const auto a = torch::autograd::grad({(fast * mix).sum()}, {x});
  const auto b = torch::autograd::grad({(slow * mix).sum()}, {x});
  EXPECT_LT(largestDifference(a[0], b[0]), 1e-6F);
}

TEST(Grouping, AttendedSumAndItsGradientsMatchReference)
{
  torch::manual_seed(4);
  const auto leaf = torch::dtype(torch::kFloat).requires_grad(true);
  const torch::Tensor attention = torch::rand({200, 7}, leaf);
  const torch::Tensor values = torch::randn({200, 7, 5}, leaf);
  const torch::Tensor mix = torch::randn({200, 5});
  const torch::Tensor fast = attendedSum(attention, values);
  const torch::Tensor slow = reference::attendedSum(attention, values);
  EXPECT_LT(largestDifference(fast, slow), 1e-5F);
  const auto a = torch::autograd::grad({(fast * mix).sum()}, {attention, values});
  const auto b = torch::autograd::grad({(slow * mix).sum()}, {attention, values});
  EXPECT_LT(largestDifference(a[0], b[0]), 1e-5F);
  EXPECT_LT(largestDifference(a[1], b[1]), 1e-5F);
}
}  // namespace
}  // namespace dyslam
