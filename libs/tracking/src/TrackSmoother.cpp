// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/tracking/TrackSmoother.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr int robust_rounds = 2;          // fits after the first one, with outliers down-weighted
constexpr double least_scatter = 0.02;    // floor of the median residual [m]
constexpr double outlier_medians = 6;     // median residuals beyond which a position has no weight
constexpr double samples_per_degree = 2;  // least number of observations per degree of a polynomial

struct Position
{
  double time;
  Eigen::RowVector3d centre;
  Eigen::RowVector3d velocity;  // velocity by the tracker
  double robust = 1;            // robustness weight
};

struct Fit
{
  Eigen::RowVector3d centre;
  Eigen::RowVector3d velocity;
};

double tricube(double u)
{
  const double rest = 1 - std::abs(u * u * u);
  return std::abs(u) < 1 ? rest * rest * rest : 0;
}

double bisquare(double u)
{
  const double rest = 1 - u * u;
  return std::abs(u) < 1 ? rest * rest : 0;
}

std::vector<Position> observationsOf(const std::vector<TrackState>& track)
{
  std::vector<Position> observations;
  for (const TrackState& state : track)
  {
    if (state.observed)
    {
      observations.push_back({state.time, state.centre.transpose(), state.velocity.transpose()});
    }
  }
  return observations;
}

/** Fits the observations within `window` of `time`. \param velocity velocity by the tracker at
 * `time`; a fit of degree 0 moves the observations to `time` with it, as it gives no velocity.
 * \return false if there are no observations. */
bool fitAt(const std::vector<Position>& observations,
           double time,
           const Eigen::RowVector3d& velocity,
           const TrackSmoothingOptions& options,
           Fit& fit)
{
  // Beyond the window the weights are zero.
  const double reach = 1.000001 * options.window;
  const auto begin = std::lower_bound(observations.begin(), observations.end(), time - reach,
                                      [](const Position& o, double t) { return o.time < t; });
  const auto end = std::upper_bound(observations.begin(), observations.end(), time + reach,
                                    [](double t, const Position& o) { return t < o.time; });
  const auto count = end - begin;
  if (count == 0)
  {
    return false;
  }
  const int degree = std::clamp(static_cast<int>(static_cast<double>(count) / samples_per_degree),
                                0, options.degree);
  Eigen::MatrixXd basis(count, degree + 1);
  Eigen::MatrixXd centres(count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    const Position& o = begin[i];
    const double u = (o.time - time) / options.window;
    // An outlier keeps a little weight, so that a window of outliers alone has a fit.
    const double weight = std::sqrt(std::max(tricube(u / 1.01), 1e-6) * std::max(o.robust, 1e-3));
    double power = weight;
    for (int d = 0; d <= degree; ++d, power *= u)
    {
      basis(i, d) = power;
    }
    centres.row(i) = weight * o.centre;
    if (degree == 0)
    {
      centres.row(i) += weight * (time - o.time) * velocity;
    }
  }
  const Eigen::MatrixXd plane = basis.colPivHouseholderQr().solve(centres.leftCols<2>());
  const Eigen::VectorXd height =
      basis.leftCols(std::min(degree, 1) + 1).colPivHouseholderQr().solve(centres.col(2));
  fit.centre << plane.row(0), height[0];
  fit.velocity = velocity;
  if (degree > 0)
  {
    fit.velocity << plane.row(1) / options.window, height[1] / options.window;
  }
  return true;
}

/** Sets the robustness weights of the observations by their distance from the fit. */
void weighOutliers(std::vector<Position>& observations, const TrackSmoothingOptions& options)
{
  std::vector<double> residuals;
  for (const Position& o : observations)
  {
    Fit fit;
    fitAt(observations, o.time, o.velocity, options, fit);
    residuals.push_back((o.centre - fit.centre).head<2>().norm());
  }
  std::vector<double> reordered = residuals;
  const double limit = outlier_medians * std::max(upperMedian(reordered), least_scatter);
  for (std::size_t i = 0; i < observations.size(); ++i)
  {
    observations[i].robust = bisquare(residuals[i] / limit);
  }
}
}  // namespace

void TrackSmoothingOptions::describe(OptionsVisitor& v)
{
  v.real(
      "window", window, 0, 100,
      "time before and after a state whose observations smooth it; 0: tracks are not smoothed [s]");
  v.integer("degree", degree, 0, 5, "degree of the polynomials that smooth a track");
  v.real("merge_overlap", merge_overlap, 0.01, 1,
         "share of the smaller footprint above which two tracks are one object; 1: never");
}

std::vector<TrackState> smoothTrack(const std::vector<TrackState>& track,
                                    const TrackSmoothingOptions& options)
{
  for (std::size_t i = 1; i < track.size(); ++i)
  {
    if (!(track[i].time > track[i - 1].time))
    {
      throw std::invalid_argument("smoothTrack: times must increase");
    }
  }
  std::vector<TrackState> result = track;
  std::vector<Position> observations = observationsOf(track);
  if (options.window <= 0 || observations.empty())
  {
    return result;
  }
  for (int round = 0; round < robust_rounds; ++round)
  {
    weighOutliers(observations, options);
  }
  for (TrackState& state : result)
  {
    Fit fit;
    if (fitAt(observations, state.time, state.velocity.transpose(), options, fit))
    {
      state.centre = fit.centre.transpose();
      state.velocity = fit.velocity.transpose();
    }
  }
  return result;
}
}  // namespace dyslam
