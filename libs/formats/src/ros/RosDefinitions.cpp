// SPDX-License-Identifier: BSD-3-Clause
// Definitions of message types of ROS 2 Humble: https://github.com/ros2/common_interfaces,
// https://github.com/ros2/rcl_interfaces and https://github.com/ros2/geometry2.
#include <dyslam/formats/RosWriter.h>

#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
/** Fields of a type, and the types of those that are no numbers or strings. */
struct TypeDefinition
{
  std::string_view name;
  std::string_view fields;
  std::vector<std::string_view> parts;
};

constexpr std::string_view header_type = "std_msgs/Header";
constexpr std::string_view time_type = "builtin_interfaces/Time";
constexpr std::string_view point_type = "geometry_msgs/Point";
constexpr std::string_view vector_type = "geometry_msgs/Vector3";
constexpr std::string_view quaternion_type = "geometry_msgs/Quaternion";
constexpr std::string_view pose_type = "geometry_msgs/Pose";
constexpr std::string_view twist_type = "geometry_msgs/Twist";
constexpr std::string_view colour_type = "std_msgs/ColorRGBA";

constexpr std::string_view three_numbers = "float64 x\nfloat64 y\nfloat64 z\n";

constexpr std::string_view fields_of_point_field =
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
    "uint8 FLOAT32=7\nuint8 FLOAT64=8\n"
    "string name\nuint32 offset\nuint8 datatype\nuint32 count\n";

constexpr std::string_view fields_of_cloud =
    "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\n"
    "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n";

constexpr std::string_view fields_of_imu =
    "std_msgs/Header header\n"
    "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n";

constexpr std::string_view fields_of_status =
    "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\n"
    "int8 status\n"
    "uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\n"
    "uint16 SERVICE_GALILEO=8\n"
    "uint16 service\n";

constexpr std::string_view fields_of_fix =
    "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
    "float64 altitude\nfloat64[9] position_covariance\n"
    "uint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\n"
    "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\n"
    "uint8 position_covariance_type\n";

constexpr std::string_view fields_of_marker =
    "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\n"
    "int32 LINE_LIST=5\nint32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\n"
    "int32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\nint32 TRIANGLE_LIST=11\n"
    "int32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\nint32 DELETEALL=3\n"
    "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n"
    "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n"
    "builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n"
    "std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n"
    "UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\nMeshFile mesh_file\n"
    "bool mesh_use_embedded_materials\n";

std::vector<TypeDefinition> basicTypes()
{
  return {{time_type, "int32 sec\nuint32 nanosec\n", {}},
          {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n", {}},
          {header_type, "builtin_interfaces/Time stamp\nstring frame_id\n", {time_type}},
          {colour_type, "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n", {}},
          {point_type, three_numbers, {}},
          {vector_type, three_numbers, {}},
          {quaternion_type, "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n", {}}};
}

std::vector<TypeDefinition> motionTypes()
{
  return {
      {pose_type, "Point position\nQuaternion orientation\n", {point_type, quaternion_type}},
      {twist_type, "Vector3 linear\nVector3 angular\n", {vector_type}},
      {"geometry_msgs/PoseStamped",
       "std_msgs/Header header\nPose pose\n",
       {header_type, pose_type}},
      {"geometry_msgs/TwistStamped",
       "std_msgs/Header header\nTwist twist\n",
       {header_type, twist_type}},
      {"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n", {pose_type}},
      {"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n", {twist_type}},
      {"geometry_msgs/Transform",
       "Vector3 translation\nQuaternion rotation\n",
       {vector_type, quaternion_type}},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\nTransform transform\n",
       {header_type, "geometry_msgs/Transform"}},
      {"tf2_msgs/TFMessage",
       "geometry_msgs/TransformStamped[] transforms\n",
       {"geometry_msgs/TransformStamped"}},
      {"nav_msgs/Odometry",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
       "geometry_msgs/TwistWithCovariance twist\n",
       {header_type, "geometry_msgs/PoseWithCovariance", "geometry_msgs/TwistWithCovariance"}},
      {"nav_msgs/Path",
       "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
       {header_type, "geometry_msgs/PoseStamped"}}};
}

std::vector<TypeDefinition> sensorTypes()
{
  return {{"sensor_msgs/PointField", fields_of_point_field, {}},
          {"sensor_msgs/PointCloud2", fields_of_cloud, {header_type, "sensor_msgs/PointField"}},
          {"sensor_msgs/Imu", fields_of_imu, {header_type, quaternion_type, vector_type}},
          {"sensor_msgs/NavSatStatus", fields_of_status, {}},
          {"sensor_msgs/NavSatFix", fields_of_fix, {header_type, "sensor_msgs/NavSatStatus"}},
          {"sensor_msgs/CompressedImage",
           "std_msgs/Header header\nstring format\nuint8[] data\n",
           {header_type}}};
}

std::vector<TypeDefinition> markerTypes()
{
  return {{"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n", {}},
          {"visualization_msgs/MeshFile", "string filename\nuint8[] data\n", {}},
          {"visualization_msgs/Marker",
           fields_of_marker,
           {header_type, pose_type, vector_type, colour_type, "builtin_interfaces/Duration",
            point_type, "sensor_msgs/CompressedImage", "visualization_msgs/UVCoordinate",
            "visualization_msgs/MeshFile"}},
          {"visualization_msgs/MarkerArray", "Marker[] markers\n", {"visualization_msgs/Marker"}}};
}

/** Name without the "msg" of ROS 2, as the definitions have it. */
std::string_view plainName(RosType type)
{
  switch (type)
  {
    case RosType::point_cloud2:
      return "sensor_msgs/PointCloud2";
    case RosType::imu:
      return "sensor_msgs/Imu";
    case RosType::nav_sat_fix:
      return "sensor_msgs/NavSatFix";
    case RosType::twist_stamped:
      return "geometry_msgs/TwistStamped";
    case RosType::pose_stamped:
      return "geometry_msgs/PoseStamped";
    case RosType::odometry:
      return "nav_msgs/Odometry";
    case RosType::path:
      return "nav_msgs/Path";
    case RosType::transforms:
      return "tf2_msgs/TFMessage";
    case RosType::marker_array:
      return "visualization_msgs/MarkerArray";
  }
  throw std::logic_error("no such RosType");
}

class Definitions
{
 public:
  Definitions()
  {
    for (auto&& group : {basicTypes(), motionTypes(), sensorTypes(), markerTypes()})
    {
      types_.insert(types_.end(), group.begin(), group.end());
    }
  }

  /** The type, then those in it, each once and in the order of their first use. */
  [[nodiscard]] std::string textOf(std::string_view name) const
  {
    std::vector<std::string_view> names{name};
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      const TypeDefinition& type = find(names[i]);
      if (i > 0)
      {
        text += std::string(80, '=') + "\nMSG: " + std::string(type.name) + '\n';
      }
      text += type.fields;
      for (const std::string_view part : type.parts)
      {
        bool known = false;
        for (const std::string_view listed : names)
        {
          known = known || listed == part;
        }
        if (!known)
        {
          names.push_back(part);
        }
      }
    }
    return text;
  }

 private:
  [[nodiscard]] const TypeDefinition& find(std::string_view name) const
  {
    for (const TypeDefinition& type : types_)
    {
      if (type.name == name)
      {
        return type;
      }
    }
    throw std::logic_error("no definition of " + std::string(name));
  }

  std::vector<TypeDefinition> types_;
};
}  // namespace

std::string rosTypeName(RosType type)
{
  std::string name(plainName(type));
  return name.insert(name.find('/'), "/msg");
}

std::string rosDefinition(RosType type)
{
  return Definitions().textOf(plainName(type));
}
}  // namespace dyslam
