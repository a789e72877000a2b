// Hub motors behind `motorlink serve --socket`, for ros2_control.
#ifndef MOTORLINK_HARDWARE__MOTORLINK_SYSTEM_HPP_
#define MOTORLINK_HARDWARE__MOTORLINK_SYSTEM_HPP_

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "hardware_interface/system_interface.hpp"
#if __has_include("hardware_interface/types/hardware_component_interface_params.hpp")
#include "hardware_interface/types/hardware_component_interface_params.hpp"
#endif
#include "motorlink_hardware/socket_client.hpp"
#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/state.hpp"

namespace motorlink_hardware
{

// Humble has the first form of on_init, ROS 2 from Lyrical on the second one, and those between have both.
#if __has_include("hardware_interface/types/hardware_component_interface_params.hpp")
using InitParameters = hardware_interface::HardwareComponentInterfaceParams;
#else
using InitParameters = hardware_interface::HardwareInfo;
#endif

class MotorLinkSystem : public hardware_interface::SystemInterface
{
public:
  hardware_interface::CallbackReturn on_init(const InitParameters & parameters) override;

  std::vector<hardware_interface::StateInterface> export_state_interfaces() override;
  std::vector<hardware_interface::CommandInterface> export_command_interfaces() override;

  // Connects to the socket.
  hardware_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State & previous) override;
  hardware_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State & previous) override;
  // Takes control and starts the motors at 0 rad/s. Waits for it.
  hardware_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State & previous) override;
  // Stop the motors and wait until they confirm that they stand.
  hardware_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State & previous) override;
  hardware_interface::CallbackReturn on_error(const rclcpp_lifecycle::State & previous) override;
  hardware_interface::CallbackReturn on_shutdown(const rclcpp_lifecycle::State & previous) override;

  // A controller may leave its last command in the interface when it stops: these wheels stop then.
  hardware_interface::return_type perform_command_mode_switch(
    const std::vector<std::string> & start, const std::vector<std::string> & stop) override;

  // They never wait.
  hardware_interface::return_type read(
    const rclcpp::Time & time, const rclcpp::Duration & period) override;
  hardware_interface::return_type write(
    const rclcpp::Time & time, const rclcpp::Duration & period) override;

private:
  struct Joint
  {
    std::string name;
    // Of its command interface.
    std::string velocity_name;
    std::uint8_t id = 0;
    // -1 for a motor that is mounted mirrored.
    double sign = 1.0;
    // In rad/s; infinite without a limit of its own.
    double speed_max = 0.0;
    // In N.m/A; NaN if it is not known.
    double torque_constant = 0.0;
    bool has_effort = false;
    bool has_temperature = false;
    double command = 0.0;
    double position = 0.0;
    double velocity = 0.0;
    double effort = 0.0;
    double temperature = 0.0;
  };

  bool read_parameters();
  bool read_joint(const hardware_interface::ComponentInfo & info);
  // Takes the newest values. Returns false if a reply is stale: with a line in the log while the motors are driven.
  bool take_state();
  bool stop_and_wait();

  SocketClient client_;
  std::string socket_;
  std::chrono::milliseconds stale_after_{0};
  std::chrono::milliseconds start_within_{0};
  std::chrono::milliseconds stop_within_{0};
  std::vector<Joint> joints_;
  std::vector<std::uint8_t> ids_;
  std::vector<double> speeds_;
  bool is_active_ = false;
  // Since ARM, until the motors have confirmed that they stand.
  bool may_turn_ = false;
};

}  // namespace motorlink_hardware

#endif  // MOTORLINK_HARDWARE__MOTORLINK_SYSTEM_HPP_
