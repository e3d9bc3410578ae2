// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace dyslam
{
namespace
{
/** Height of a keyframe in the map [m]: a type of factor that no file but this one knows. */
class HeightFactor final : public Factor
{
 public:
  static const FactorType factor_type;

  HeightFactor(std::size_t keyframe, double height, const Matrix6& information)
      : Factor(factor_type, {Key::ego(keyframe)}, information), height_(height)
  {
  }

  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override
  {
    const Pose T_map_vehicle = unpackPose(blocks[0]);
    if (jacobians != nullptr)
    {
      (*jacobians)[0].setZero();
      (*jacobians)[0].topLeftCorner<1, 3>() = T_map_vehicle.linear().row(2);
    }
    return (T_map_vehicle.translation().z() - height_) * Vector6::Unit(0);
  }
  [[nodiscard]] FactorLoss loss(const FactorGraphOptions& options) const override
  {
    return {options.gnss_loss, 2.5};
  }
  [[nodiscard]] FactorData data() const override
  {
    FactorData data = Factor::data();
    data.further[0] = height_;
    return data;
  }

 private:
  double height_;
};

const FactorType HeightFactor::factor_type = {
    "height",
    "HEIGHT",
    nullptr,
    1,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(1);
      fields.index(data.keys[0].index);
      fields.number(data.further[0]);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<HeightFactor>(static_cast<std::size_t>(data.keys.at(0).index),
                                            data.further[0], data.information);
    }};

FactorTypes withHeights()
{
  return FactorTypes({&HeightFactor::factor_type});
}

std::string contentOf(const std::string& path)
{
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/** Two keyframes 1 m apart by odometry with sigmas of 0.1; the second one's height is 2 m with a
 * sigma of 0.1 m, at first with a residual of 20 sigmas. */
FactorGraph graphWithHeight()
{
  FactorGraph graph(withHeights());
  graph.addPose(Key::ego(0), Pose::Identity());
  graph.setFixed(Key::ego(0), true);
  Pose T = Pose::Identity();
  T.translation().x() = 1;
  graph.addPose(Key::ego(1), T);
  graph.add(std::make_unique<OdometryFactor>(0, 1, T, 100 * Matrix6::Identity()));
  Matrix6 information = Matrix6::Zero();
  information(0, 0) = 100;
  graph.add(std::make_unique<HeightFactor>(1, 2, information));
  return graph;
}

TEST(FactorType, NewTypeIsOptimised)
{
  FactorGraph graph = graphWithHeight();
  EXPECT_NEAR(graph.chi2(), 400, 1e-9);
  FactorGraphOptions options;
  options.gnss_loss = RobustLoss::none;
  const OptimisationResult result = graph.optimise(options);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_NEAR(graph.pose(Key::ego(1)).translation().z(), 1, 1e-6) << "half way";
  EXPECT_NEAR(graph.pose(Key::ego(1)).translation().x(), 1, 1e-6);
  EXPECT_NEAR(graph.covariances({Key::ego(1)}).at(0)(2, 2), 0.005, 1e-9) << "two sigmas of 0.1 m";
}

TEST(FactorType, NewTypeHasItsOwnLoss)
{
  FactorGraph graph = graphWithHeight();
  FactorGraphOptions options;
  options.gnss_loss = RobustLoss::cauchy;
  (void)graph.optimise(options);
  // Derivative of z^2 100 / 2 + the loss of width 2.5 at the minimum near the odometry.
  const double z = graph.pose(Key::ego(1)).translation().z();
  const double r = 10 * (z - 2);
  EXPECT_LT(z, 0.1);
  EXPECT_NEAR(10 * z + r / (1 + r * r / (2.5 * 2.5)), 0, 0.01);
}

TEST(FactorType, NewTypeIsWrittenAndRead)
{
  const auto folder = std::filesystem::path(::testing::TempDir()) / "FactorType_NewType";
  std::filesystem::create_directories(folder);
  const std::string a = folder / "a.txt";
  const std::string b = folder / "b.txt";
  FactorGraph graph = graphWithHeight();
  writeFactorGraph(graph, a);
  EXPECT_NE(contentOf(a).find("\nHEIGHT 1 2 100\n"), std::string::npos) << contentOf(a);
  FactorGraph copy = readFactorGraph(a, withHeights());
  writeFactorGraph(copy, b);
  EXPECT_EQ(contentOf(a), contentOf(b));
  EXPECT_TRUE(copy.factor(1).is<HeightFactor>());
  EXPECT_EQ(copy.optimise({}).final_chi2, graph.optimise({}).final_chi2);
  EXPECT_THROW((void)readFactorGraph(a), UserError) << "without the type";
  std::filesystem::remove_all(folder);
}

TEST(FactorType, NewTypeIsSavedAndLoaded)
{
  FactorGraph graph = graphWithHeight();
  StateArchive saved;
  graph.exchangeState(saved);
  FactorGraph copy(withHeights());
  StateArchive loading(saved.bytes());
  copy.exchangeState(loading);
  loading.requireEnd();
  EXPECT_TRUE(copy.factor(1).is<HeightFactor>());
  EXPECT_EQ(copy.chi2(), graph.chi2());
  EXPECT_EQ(copy.optimise({}).final_chi2, graph.optimise({}).final_chi2);

  FactorGraph without;
  StateArchive again(saved.bytes());
  EXPECT_THROW(without.exchangeState(again), UserError);
}

TEST(FactorType, TypesOfTheTableOnly)
{
  FactorGraph graph;
  graph.addPose(Key::ego(1), Pose::Identity());
  EXPECT_THROW(graph.add(std::make_unique<HeightFactor>(1, 2, Matrix6::Identity())),
               std::invalid_argument);
  FactorType taken = HeightFactor::factor_type;
  taken.line = "LEFT_OUT_LOOP";
  EXPECT_THROW(FactorTypes({&taken}), std::invalid_argument);
  for (const int dimension : {0, 7})
  {
    FactorType wrong = HeightFactor::factor_type;
    wrong.dimension = dimension;
    EXPECT_THROW(FactorTypes({&wrong}), std::invalid_argument) << dimension;
  }
}

// The number of a type in a checkpoint must not change.
TEST(FactorType, NumbersInCheckpoints)
{
  const FactorTypes types;
  const char* lines[] = {"ODOMETRY",      "LOOP", "OBSERVATION", "OBJECT_MOTION",
                         "SMOOTH_MOTION", "GNSS", "GRAVITY",     "LOCALISATION"};
  for (int i = 0; i < 8; ++i)
  {
    ASSERT_NE(types.find(lines[i]), nullptr) << lines[i];
    EXPECT_EQ(types.numberOf(*types.find(lines[i])), i) << lines[i];
  }
  EXPECT_EQ(types.find("LEFT_OUT_LOOP"), types.find("LOOP"));
}
}  // namespace
}  // namespace dyslam
