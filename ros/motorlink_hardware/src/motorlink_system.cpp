#include "motorlink_hardware/motorlink_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_map>

#include "hardware_interface/types/hardware_interface_type_values.hpp"
#include "pluginlib/class_list_macros.hpp"

namespace motorlink_hardware
{
namespace
{

using hardware_interface::CallbackReturn;
using hardware_interface::return_type;
using Parameters = std::unordered_map<std::string, std::string>;

constexpr double RAD_PER_S = 2.0 * 3.14159265358979323846 / 60.0;
constexpr const char * TEMPERATURE = "temperature";
// While a function waits, it answers as often as a controller of 100 Hz.
constexpr std::chrono::milliseconds STEP{10};

rclcpp::Logger logger() {return rclcpp::get_logger("MotorLinkSystem");}

std::string text(const Parameters & parameters, const std::string & name, const std::string & usual)
{
  const auto found = parameters.find(name);
  return found == parameters.end() ? usual : found->second;
}

// A number, the whole text of it.
double number(const Parameters & parameters, const std::string & name, double usual)
{
  const auto found = parameters.find(name);
  if (found == parameters.end()) {
    return usual;
  }
  std::size_t end = 0;
  const double value = std::stod(found->second, &end);
  if (end != found->second.size() || !std::isfinite(value)) {
    throw std::invalid_argument(name);
  }
  return value;
}

std::chrono::milliseconds duration(
  const Parameters & parameters, const std::string & name, double usual_ms)
{
  const double ms = number(parameters, name, usual_ms);
  if (ms < 1.0 || ms > 60000.0) {
    throw std::invalid_argument(name);
  }
  return std::chrono::milliseconds(static_cast<std::int64_t>(ms));
}

}  // namespace

CallbackReturn MotorLinkSystem::on_init(const InitParameters & parameters)
{
  if (hardware_interface::SystemInterface::on_init(parameters) != CallbackReturn::SUCCESS) {
    return CallbackReturn::ERROR;
  }
  try {
    return read_parameters() ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
  } catch (const std::exception & error) {
    RCLCPP_ERROR(logger(), "a parameter is no number in its range: %s", error.what());
    return CallbackReturn::ERROR;
  }
}

bool MotorLinkSystem::read_parameters()
{
  const Parameters & parameters = info_.hardware_parameters;
  socket_ = text(parameters, "socket", "/run/motorlink/socket");
  stale_after_ = duration(parameters, "stale_after_ms", 100.0);
  start_within_ = duration(parameters, "start_within_ms", 5000.0);
  stop_within_ = duration(parameters, "stop_within_ms", 5000.0);
  joints_.clear();
  ids_.clear();
  for (const auto & joint : info_.joints) {
    if (!read_joint(joint)) {
      return false;
    }
  }
  if (joints_.empty() || joints_.size() > MOTORS_MAX) {
    RCLCPP_ERROR(logger(), "%zu joints: 1 to %zu are driven together", joints_.size(), MOTORS_MAX);
    return false;
  }
  speeds_.assign(joints_.size(), 0.0);
  return true;
}

bool MotorLinkSystem::read_joint(const hardware_interface::ComponentInfo & info)
{
  Joint joint;
  joint.name = info.name;
  joint.velocity_name = info.name + "/" + hardware_interface::HW_IF_VELOCITY;
  const double id = number(info.parameters, "id", 0.0);
  if (id < 1.0 || id > 254.0 || id != std::floor(id)) {
    RCLCPP_ERROR(logger(), "%s: id is the ID of its motor, 1 to 254", info.name.c_str());
    return false;
  }
  joint.id = static_cast<std::uint8_t>(id);
  if (std::find(ids_.begin(), ids_.end(), joint.id) != ids_.end()) {
    RCLCPP_ERROR(logger(), "%s: another joint has this id", info.name.c_str());
    return false;
  }
  const std::string mirrored = text(info.parameters, "mirrored", "false");
  if (mirrored != "true" && mirrored != "false") {
    RCLCPP_ERROR(logger(), "%s: mirrored is true or false", info.name.c_str());
    return false;
  }
  joint.sign = mirrored == "true" ? -1.0 : 1.0;
  const double infinite = std::numeric_limits<double>::infinity();
  joint.speed_max = infinite;
  if (info.parameters.count("max_rpm") != 0) {
    joint.speed_max = std::fabs(number(info.parameters, "max_rpm", 0.0)) * RAD_PER_S;
  }
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  joint.torque_constant = number(info.parameters, "torque_constant", unknown);
  joint.position = joint.velocity = joint.effort = joint.temperature = unknown;
  if (
    info.command_interfaces.size() != 1 ||
    info.command_interfaces[0].name != hardware_interface::HW_IF_VELOCITY)
  {
    RCLCPP_ERROR(logger(), "%s: velocity is its only command interface", info.name.c_str());
    return false;
  }
  for (const auto & state : info.state_interfaces) {
    if (state.name == hardware_interface::HW_IF_EFFORT) {
      joint.has_effort = true;
    } else if (state.name == TEMPERATURE) {
      joint.has_temperature = true;
    } else if (
      state.name != hardware_interface::HW_IF_POSITION &&
      state.name != hardware_interface::HW_IF_VELOCITY)
    {
      RCLCPP_ERROR(logger(), "%s: no state %s", info.name.c_str(), state.name.c_str());
      return false;
    }
  }
  if (joint.has_effort && std::isnan(joint.torque_constant)) {
    RCLCPP_ERROR(
      logger(), "%s: effort needs torque_constant in N.m/A; leave the interface out",
      info.name.c_str());
    return false;
  }
  joints_.push_back(joint);
  ids_.push_back(joint.id);
  return true;
}

// Humble knows no other way, and later versions still take it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
std::vector<hardware_interface::StateInterface> MotorLinkSystem::export_state_interfaces()
{
  std::vector<hardware_interface::StateInterface> interfaces;
  for (auto & joint : joints_) {
    interfaces.emplace_back(joint.name, hardware_interface::HW_IF_POSITION, &joint.position);
    interfaces.emplace_back(joint.name, hardware_interface::HW_IF_VELOCITY, &joint.velocity);
    if (joint.has_effort) {
      interfaces.emplace_back(joint.name, hardware_interface::HW_IF_EFFORT, &joint.effort);
    }
    if (joint.has_temperature) {
      interfaces.emplace_back(joint.name, TEMPERATURE, &joint.temperature);
    }
  }
  return interfaces;
}

std::vector<hardware_interface::CommandInterface> MotorLinkSystem::export_command_interfaces()
{
  std::vector<hardware_interface::CommandInterface> interfaces;
  for (auto & joint : joints_) {
    interfaces.emplace_back(joint.name, hardware_interface::HW_IF_VELOCITY, &joint.command);
  }
  return interfaces;
}
#pragma GCC diagnostic pop

CallbackReturn MotorLinkSystem::on_configure(const rclcpp_lifecycle::State &)
{
  if (!client_.connect(socket_, start_within_)) {
    RCLCPP_ERROR(logger(), "%s", client_.error().c_str());
    return CallbackReturn::ERROR;
  }
  for (const auto & joint : joints_) {
    if (client_.state()->motor(joint.id) == nullptr) {
      RCLCPP_WARN(
        logger(), "%s: motorlink knows no motor %d yet", joint.name.c_str(), joint.id);
    }
  }
  take_state();
  return CallbackReturn::SUCCESS;
}

CallbackReturn MotorLinkSystem::on_cleanup(const rclcpp_lifecycle::State &)
{
  client_.close();
  return CallbackReturn::SUCCESS;
}

CallbackReturn MotorLinkSystem::on_activate(const rclcpp_lifecycle::State &)
{
  for (auto & joint : joints_) {
    joint.command = 0.0;
  }
  speeds_.assign(joints_.size(), 0.0);
  const auto until = std::chrono::steady_clock::now() + start_within_;
  // The challenge of an old state is refused.
  do {
    if (!client_.receive_within(STEP)) {
      RCLCPP_ERROR(logger(), "no control: %s", client_.error().c_str());
      return CallbackReturn::ERROR;
    }
  } while (
    std::chrono::steady_clock::now() - client_.state()->sent > 2 * STEP &&
    std::chrono::steady_clock::now() < until);
  const std::uint32_t number = client_.arm(ids_);
  may_turn_ = true;
  while (std::chrono::steady_clock::now() < until) {
    if (!client_.receive_within(STEP) || !client_.set(ids_, speeds_)) {
      RCLCPP_ERROR(logger(), "no control: %s", client_.error().c_str());
      return CallbackReturn::ERROR;
    }
    const State & state = *client_.state();
    if (state.arm != number) {
      continue;
    }
    if (state.refused != 0) {
      RCLCPP_ERROR(
        logger(), "no control: %s (viewer %u)", why_refused(state.refused).c_str(),
        state.holder_number);
      return CallbackReturn::ERROR;
    }
    if (state.ended != 0) {
      RCLCPP_ERROR(logger(), "the motors were not started: %s", why_ended(state.ended).c_str());
      stop_and_wait();
      return CallbackReturn::ERROR;
    }
    // Driven, and each has replied.
    if (state.armed && state.drive == Drive::DRIVEN && take_state()) {
      is_active_ = true;
      return CallbackReturn::SUCCESS;
    }
  }
  RCLCPP_ERROR(logger(), "the motors were not started in time");
  stop_and_wait();
  return CallbackReturn::ERROR;
}

CallbackReturn MotorLinkSystem::on_deactivate(const rclcpp_lifecycle::State &)
{
  return stop_and_wait() ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

CallbackReturn MotorLinkSystem::on_error(const rclcpp_lifecycle::State &)
{
  stop_and_wait();
  client_.close();
  return CallbackReturn::SUCCESS;
}

CallbackReturn MotorLinkSystem::on_shutdown(const rclcpp_lifecycle::State &)
{
  const bool stands = stop_and_wait();
  client_.close();
  return stands ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

bool MotorLinkSystem::stop_and_wait()
{
  is_active_ = false;
  if (!may_turn_) {
    return true;
  }
  if (client_.is_connected()) {
    const State & state = *client_.state();
    const bool stands = state.drive == Drive::NONE || state.drive == Drive::STANDS;
    if (stands && !state.armed) {
      may_turn_ = false;
      return true;
    }
  }
  client_.disarm();
  const auto until = std::chrono::steady_clock::now() + stop_within_;
  while (client_.receive_within(STEP) && std::chrono::steady_clock::now() < until) {
    const State & state = *client_.state();
    if (state.armed) {
      continue;
    }
    if (state.drive == Drive::STANDS) {
      RCLCPP_INFO(logger(), "the motors stand, confirmed");
      may_turn_ = false;
      return true;
    }
    if (state.drive == Drive::NOT_CONFIRMED) {
      break;
    }
  }
  if (client_.is_connected()) {
    RCLCPP_ERROR(
      logger(), "THE MOTORS HAVE NOT CONFIRMED THAT THEY STAND: the power switch stops them");
  } else {
    RCLCPP_ERROR(
      logger(), "NOT CONFIRMED THAT THE MOTORS STAND: no connection (%s). motorlink stops them by itself if it runs",
      client_.error().c_str());
  }
  return false;
}

bool MotorLinkSystem::take_state()
{
  const State & state = *client_.state();
  const std::chrono::duration<double> since_sent = std::chrono::steady_clock::now() - state.sent;
  const double stale_s = std::chrono::duration<double>(stale_after_).count();
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  bool is_fresh = true;
  for (auto & joint : joints_) {
    const Motor * motor = state.motor(joint.id);
    const double age = motor == nullptr ?
      std::numeric_limits<double>::infinity() : motor->reply_age + since_sent.count();
    joint.position = motor == nullptr ? unknown : joint.sign * motor->position;
    joint.velocity = motor == nullptr ? unknown : joint.sign * motor->velocity;
    joint.effort = motor == nullptr ? unknown : joint.sign * motor->current * joint.torque_constant;
    joint.temperature = motor == nullptr ? unknown : motor->temperature;
    if (!(age <= stale_s)) {
      is_fresh = false;
      if (is_active_) {
        RCLCPP_ERROR(logger(), "%s: no reply for %.0f ms", joint.name.c_str(), age * 1e3);
      }
    }
  }
  return is_fresh;
}

return_type MotorLinkSystem::perform_command_mode_switch(
  const std::vector<std::string> &, const std::vector<std::string> & stop)
{
  for (auto & joint : joints_) {
    if (std::find(stop.begin(), stop.end(), joint.velocity_name) != stop.end()) {
      joint.command = 0.0;
    }
  }
  return return_type::OK;
}

return_type MotorLinkSystem::read(const rclcpp::Time &, const rclcpp::Duration &)
{
  if (!client_.receive()) {
    RCLCPP_ERROR(logger(), "%s", client_.error().c_str());
    return return_type::ERROR;
  }
  const bool is_fresh = take_state();
  const State & state = *client_.state();
  if (is_active_ && (!state.armed || state.drive != Drive::DRIVEN)) {
    RCLCPP_ERROR(logger(), "the motors are stopped: %s", why_ended(state.ended).c_str());
    return return_type::ERROR;
  }
  return is_fresh || !is_active_ ? return_type::OK : return_type::ERROR;
}

return_type MotorLinkSystem::write(const rclcpp::Time &, const rclcpp::Duration &)
{
  if (!is_active_) {
    return return_type::OK;
  }
  for (std::size_t place = 0; place < joints_.size(); ++place) {
    const Joint & joint = joints_[place];
    // A controller that has not computed anything yet may give NaN.
    const double command = std::isfinite(joint.command) ? joint.command : 0.0;
    speeds_[place] = joint.sign * std::clamp(command, -joint.speed_max, joint.speed_max);
  }
  if (!client_.set(ids_, speeds_)) {
    RCLCPP_ERROR(logger(), "%s", client_.error().c_str());
    return return_type::ERROR;
  }
  return return_type::OK;
}

}  // namespace motorlink_hardware

PLUGINLIB_EXPORT_CLASS(motorlink_hardware::MotorLinkSystem, hardware_interface::SystemInterface)
