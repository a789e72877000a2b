// Later versions of ros2_control have it. Its folder stands before that of the other headers.
#ifndef STUB__HARDWARE_COMPONENT_INTERFACE_PARAMS_HPP_
#define STUB__HARDWARE_COMPONENT_INTERFACE_PARAMS_HPP_

namespace hardware_interface
{
struct HardwareComponentInterfaceParams
{
  HardwareInfo hardware_info;
};
}  // namespace hardware_interface

#endif  // STUB__HARDWARE_COMPONENT_INTERFACE_PARAMS_HPP_
