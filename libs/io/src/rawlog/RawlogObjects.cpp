// SPDX-License-Identifier: BSD-3-Clause
#include "RawlogObjects.h"

#include <mrpt/serialization/CArchive.h>

#include <cstring>
#include <stdexcept>

#include "GzInput.h"

namespace dyslam
{
namespace
{
using mrpt::obs::CObservation;
using mrpt::rtti::TRuntimeClassId;

constexpr char end_byte = '\x88';
constexpr std::uint32_t most_in_frame = 100000;  //!< observations of a sensory frame

/** For archiveFrom(). */
class MemoryInput
{
 public:
  explicit MemoryInput(std::string_view bytes) : bytes_(bytes) {}
  std::size_t Read(void* buffer, std::size_t count)
  {
    if (count > bytes_.size())
    {
      throw std::runtime_error("an object is longer than its parts");
    }
    std::memcpy(buffer, bytes_.data(), count);
    bytes_.remove_prefix(count);
    return count;
  }
  static std::size_t Write(const void*, std::size_t) { throw std::logic_error("is for reading"); }
  [[nodiscard]] static std::string getStreamDescription() { return "object"; }

 private:
  std::string_view bytes_;
};

/** By a name without namespace, whether MRPT has the class or not. */
bool isObservationName(std::string_view name)
{
  return isClassName(name) && name.find("CObservation") != std::string_view::npos;
}

/** Null for an observation of a class that MRPT does not have. */
const TRuntimeClassId* classOf(const ObjectHeader& header)
{
  const TRuntimeClassId* id = mrpt::rtti::findRegisteredClass(header.class_name);
  if (id == nullptr && !isObservationName(header.class_name))
  {
    throw std::runtime_error(isClassName(header.class_name)
                                 ? "an object of class '" + header.class_name +
                                       "', which is not known"
                                 : "no object where one should begin");
  }
  return id;
}

/** Whether a header of an object of rawlogs begins here. */
bool beginsObject(std::string_view bytes)
{
  const auto length = static_cast<unsigned char>(bytes.empty() ? 0 : bytes[0]);
  const std::size_t size = length & 0x7FU;
  if ((length & 0x80U) == 0 || size == 0 || bytes.size() < size + 2)
  {
    return false;
  }
  const std::string_view name = bytes.substr(1, size);
  if (!isClassName(name))
  {
    return false;  // the name of the object behind it: a byte before that looked like a length
  }
  if (name.find("CObservation") == std::string_view::npos &&
      name.find("CSensoryFrame") == std::string_view::npos &&
      name.find("CActionCollection") == std::string_view::npos)
  {
    return false;
  }
  return isObservationName(name.substr(name.rfind(':') + 1)) ||
         mrpt::rtti::findRegisteredClass(std::string(name)) != nullptr;
}

bool isObservation(const TRuntimeClassId& id)
{
  return id.derivedFrom(CLASS_ID(CObservation)) && id.ptrCreateObject != nullptr;
}
}  // namespace

mrpt::serialization::CSerializable::Ptr objectFrom(std::string_view bytes)
{
  MemoryInput input(bytes);
  auto archive = mrpt::serialization::archiveFrom(input);
  return archive.ReadObject();
}

bool RawlogObjects::atEnd()
{
  return window_.ahead(1).empty() && file_.atEnd();
}

void RawlogObjects::skipObject()
{
  constexpr std::size_t longest_header = 1 + 1 + 127 + 1;
  bool ended = false;
  for (;;)
  {
    const std::string_view bytes = window_.ahead(std::size_t{1} << 16U);
    const bool last = bytes.size() < (std::size_t{1} << 16U);
    for (std::size_t at = bytes.find(end_byte); at != std::string_view::npos;
         at = bytes.find(end_byte, at + 1))
    {
      if (!last && bytes.size() - at < longest_header)
      {
        break;
      }
      if (beginsObject(bytes.substr(at + 1)))
      {
        window_.passAhead(at + 1);
        return;
      }
    }
    ended = bytes.empty() ? ended : bytes.back() == end_byte;
    window_.passAhead(last ? bytes.size() : bytes.size() - longest_header);
    if (last)
    {
      break;
    }
  }
  if (!ended)
  {
    file_.noteCut();
    throw std::runtime_error("unexpected end of data");
  }
}

bool RawlogObjects::motionSensor(const ObjectHeader& header,
                                 std::deque<CObservation::Ptr>& observations)
{
  const std::size_t behind_header = window_.at();
  try
  {
    layout_.motionSensor(header);
    observations.push_back(std::dynamic_pointer_cast<CObservation>(objectFrom(window_.since(0))));
    return true;
  }
  catch (const std::exception&)
  {
    window_.rewind(behind_header);
    return false;
  }
}

bool RawlogObjects::observation(const ObjectHeader& header,
                                const TRuntimeClassId* id,
                                std::deque<CObservation::Ptr>& observations)
{
  if (ObjectLayout::knows(header.class_name))
  {
    layout_.observation(header);
    observations.push_back(std::dynamic_pointer_cast<CObservation>(objectFrom(window_.since(0))));
    return true;
  }
  if (ObjectLayout::knowsMotionSensor(header) && motionSensor(header, observations))
  {
    return true;
  }
  if (id == nullptr)
  {
    skipObject();
    ++left_out_[header.class_name];
    return false;
  }
  auto empty = std::dynamic_pointer_cast<CObservation>(id->createObject());
  empty->timestamp = INVALID_TIMESTAMP;
  observations.push_back(std::move(empty));
  skipObject();
  return false;
}

void RawlogObjects::sensoryFrame(int version, std::deque<CObservation::Ptr>& observations)
{
  requireVersion("CSensoryFrame", version, 1, 2);
  window_.skip(version < 2 ? sizeof(std::uint32_t) : 0);  // a number
  const std::uint32_t count = window_.u32();
  if (count > most_in_frame)
  {
    throw std::runtime_error("a CSensoryFrame of " + std::to_string(count) + " observations");
  }
  bool end_known = true;
  for (std::uint32_t i = 0; i < count; ++i)
  {
    window_.begin();
    const ObjectHeader header = layout_.header();
    const TRuntimeClassId* id = classOf(header);
    if (id != nullptr && !isObservation(*id))
    {
      throw std::runtime_error("a " + header.class_name + " in a CSensoryFrame");
    }
    end_known = observation(header, id, observations);
  }
  if (end_known)
  {
    layout_.end();
  }
}

const TRuntimeClassId* RawlogObjects::next(std::deque<CObservation::Ptr>& observations)
{
  window_.begin();
  const ObjectHeader header = layout_.header();
  const TRuntimeClassId* id = classOf(header);
  if (header.class_name == "CSensoryFrame")
  {
    sensoryFrame(header.version, observations);
  }
  else if (id == nullptr || isObservation(*id))
  {
    (void)observation(header, id, observations);
  }
  else if (header.class_name == "CActionCollection")
  {
    skipObject();
  }
  return id;
}
}  // namespace dyslam
