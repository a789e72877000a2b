#ifndef STUB__RCLCPP_LIFECYCLE__STATE_HPP_
#define STUB__RCLCPP_LIFECYCLE__STATE_HPP_

namespace rclcpp_lifecycle
{
struct State {};
}  // namespace rclcpp_lifecycle

#endif  // STUB__RCLCPP_LIFECYCLE__STATE_HPP_
