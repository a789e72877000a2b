// A stand-in for the parts of ros2_control that the plugin uses, for a test without ROS.
#ifndef STUB__HARDWARE_INTERFACE__SYSTEM_INTERFACE_HPP_
#define STUB__HARDWARE_INTERFACE__SYSTEM_INTERFACE_HPP_

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/state.hpp"

namespace hardware_interface
{

enum class CallbackReturn : std::uint8_t { SUCCESS, FAILURE, ERROR };
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };

struct InterfaceInfo
{
  std::string name;
};

struct ComponentInfo
{
  std::string name;
  std::vector<InterfaceInfo> command_interfaces;
  std::vector<InterfaceInfo> state_interfaces;
  std::unordered_map<std::string, std::string> parameters;
};

struct HardwareInfo
{
  std::string name;
  std::unordered_map<std::string, std::string> hardware_parameters;
  std::vector<ComponentInfo> joints;
};

struct Handle
{
  Handle(const std::string & prefix, const std::string & interface, double * value)
  : name(prefix + "/" + interface), value(value) {}
  std::string name;
  double * value;
};
struct StateInterface : Handle
{
  using Handle::Handle;
};
struct CommandInterface : Handle
{
  using Handle::Handle;
};

}  // namespace hardware_interface

#if __has_include("hardware_interface/types/hardware_component_interface_params.hpp")
#include "hardware_interface/types/hardware_component_interface_params.hpp"
#endif

namespace hardware_interface
{

class SystemInterface
{
public:
  virtual ~SystemInterface() = default;

#if __has_include("hardware_interface/types/hardware_component_interface_params.hpp")
  virtual CallbackReturn on_init(const HardwareComponentInterfaceParams & parameters)
  {
    info_ = parameters.hardware_info;
    return CallbackReturn::SUCCESS;
  }
#else
  virtual CallbackReturn on_init(const HardwareInfo & info)
  {
    info_ = info;
    return CallbackReturn::SUCCESS;
  }
#endif
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_cleanup(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_error(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_shutdown(const rclcpp_lifecycle::State &) = 0;
  virtual std::vector<StateInterface> export_state_interfaces() = 0;
  virtual std::vector<CommandInterface> export_command_interfaces() = 0;
  virtual return_type perform_command_mode_switch(
    const std::vector<std::string> &, const std::vector<std::string> &)
  {
    return return_type::OK;
  }
  virtual return_type read(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
  virtual return_type write(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;

protected:
  HardwareInfo info_;
};

}  // namespace hardware_interface

#endif  // STUB__HARDWARE_INTERFACE__SYSTEM_INTERFACE_HPP_
