// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <cstdint>
#include <vector>

#include "Mesh.h"

namespace dyslam::sim
{
/** Shape and gait of a kind of actor. */
struct BodyModel
{
  enum class Gait
  {
    rigid,
    walking,  //!< shapes: torso, arm, thigh, shank, and what is pulled or pushed, if anything
    cycling   //!< shapes: bicycle with rider, thigh, shank
  };
  ObjectClass object_class = ObjectClass::car;
  Gait gait = Gait::rigid;
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  //!< length, width, height of the box [m]
  double centre_x = 0;                             //!< box centre along the body [m]
  double wheelbase = 2.6;  //!< distance between the points that follow the path [m]
  double scale = 1;        //!< scale of the shapes: a person's height [m]
  double luggage_x = 0;    //!< position of a walker's fifth shape along the body, scaled [m]
  std::uint16_t semantic_at_rest = 0, semantic_moving = 0;  //!< 0: those of the object class
  std::vector<int> shapes;                                  //!< indices in World::shapes
};

/** Pose and gait state of a body. */
struct BodyState
{
  Eigen::Vector3d position =
      Eigen::Vector3d::Zero();          //!< point on the ground below the centre, map frame [m]
  double yaw = 0, pitch = 0, roll = 0;  //!< [rad]
  double speed = 0;                     //!< speed along the heading [m/s]
  double phase = 0;                     //!< phase of the gait or the pedals [rad]
  double swing = 0;                     //!< amplitude of the limbs, in [0, 1]
};

struct BodyPart
{
  int shape = 0;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();  //!< shape to map
};

[[nodiscard]] Pose bodyPose(const BodyState& state);
/** The parts of a body; order and number depend on the model only. */
[[nodiscard]] std::vector<BodyPart> bodyParts(const BodyModel& model, const BodyState& state);
}  // namespace dyslam::sim
