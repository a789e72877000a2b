// The client of `motorlink serve --socket`. docs/socket.md of MotorLink describes every byte.
//
// It knows nothing of ROS, and never waits but where it says so.
#ifndef MOTORLINK_HARDWARE__SOCKET_CLIENT_HPP_
#define MOTORLINK_HARDWARE__SOCKET_CLIENT_HPP_

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace motorlink_hardware
{

// The version of the messages.
constexpr std::uint16_t VERSION = 1;
constexpr std::size_t MOTORS_MAX = 8;

// What becomes of the drive of this client.
enum class Drive : std::uint8_t
{
  NONE = 0,
  STARTING = 1,
  DRIVEN = 2,
  STOPPING = 3,
  STANDS = 4,
  NOT_CONFIRMED = 5,
};

// A motor. What is unknown is NaN, and its age is infinite. Ages are in seconds at the time of the call.
struct Motor
{
  std::uint8_t id;
  bool may_turn;
  std::uint8_t faults;
  double reply_age;
  // In rad, unwrapped.
  double position;
  // In rad/s.
  double velocity;
  // In A.
  double current;
  // In degrees Celsius.
  double temperature;
};

struct State
{
  // Whether this client has control.
  bool armed;
  Drive drive;
  // Why the drive has ended: 0 as long as it has not.
  std::uint8_t ended;
  // The number of the newest ARM that the server has handled, and why it has no effect: 0 if it has.
  std::uint32_t arm;
  std::uint8_t refused;
  std::uint64_t challenge;
  // When it was sent, by the monotonic clock of this computer.
  std::chrono::steady_clock::time_point sent;
  // Who has control: 0 nobody, 1 a page, 2 another client, 3 this one; and its number.
  std::uint8_t holder;
  std::uint32_t holder_number;
  std::vector<Motor> motors;

  const Motor * motor(std::uint8_t id) const;
};

class SocketClient
{
public:
  SocketClient();
  ~SocketClient();
  SocketClient(const SocketClient &) = delete;
  SocketClient & operator=(const SocketClient &) = delete;

  // Connects, and waits for the first state at most so long. Returns false with error().
  bool connect(const std::string & path, std::chrono::milliseconds within);
  void close();
  bool is_connected() const;
  // Why the connection has ended.
  const std::string & error() const;

  // Takes all that has come, and keeps the newest state. Returns false once the connection has ended.
  bool receive();
  // The same, after waiting for something to come at most so long.
  bool receive_within(std::chrono::milliseconds within);
  // The newest state.
  const std::optional<State> & state() const;

  // Asks for control, and for these motors at 0 rad/s. The state has the number that this returns once it is handled.
  std::uint32_t arm(const std::vector<std::uint8_t> & ids);
  // Speeds in rad/s for the motors of arm(), in its order.
  bool set(const std::vector<std::uint8_t> & ids, const std::vector<double> & speeds);
  // Stops the motors, and gives up control.
  bool disarm();

private:
  bool send_order(
    std::uint8_t kind, const std::vector<std::uint8_t> & ids, const std::vector<double> & speeds);
  bool flush();
  bool fail(const std::string & why);
  bool read_messages();

  int socket_;
  std::string error_;
  std::optional<State> state_;
  std::uint32_t arms_;
  // What has come of a message that is not whole yet.
  std::vector<std::uint8_t> incoming_;
  // What the system has not taken of the last message.
  std::vector<std::uint8_t> outgoing_;
};

// The words for State::ended and State::refused.
std::string why_ended(std::uint8_t ended);
std::string why_refused(std::uint8_t refused);

}  // namespace motorlink_hardware

#endif  // MOTORLINK_HARDWARE__SOCKET_CLIENT_HPP_
