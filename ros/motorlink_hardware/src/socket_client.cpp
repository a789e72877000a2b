#include "motorlink_hardware/socket_client.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace motorlink_hardware
{
namespace
{

using Clock = std::chrono::steady_clock;

constexpr std::array<std::uint8_t, 4> MAGIC = {0x89, 'M', 'L', 'S'};
constexpr std::size_t HELLO = 8;
constexpr std::size_t FROM_CLIENT = 56;
constexpr std::size_t FROM_SERVER = 416;
constexpr std::size_t MOTORS_AT = 32;
constexpr std::size_t MOTOR = 48;
// The system keeps a few states: no more than these are taken in one call.
constexpr std::size_t MESSAGES_MAX = 1024;

template<typename T>
void put(std::vector<std::uint8_t> & bytes, T value)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(T));
  for (std::size_t place = 0; place < sizeof(T); ++place) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * place)));
  }
}

std::uint64_t unsigned_at(const std::uint8_t * bytes, std::size_t size)
{
  std::uint64_t bits = 0;
  for (std::size_t place = 0; place < size; ++place) {
    bits |= static_cast<std::uint64_t>(bytes[place]) << (8 * place);
  }
  return bits;
}

double float_at(const std::uint8_t * bytes)
{
  const auto bits = static_cast<std::uint32_t>(unsigned_at(bytes, 4));
  float value = 0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

double double_at(const std::uint8_t * bytes)
{
  const std::uint64_t bits = unsigned_at(bytes, 8);
  double value = 0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

double age_at(const std::uint8_t * bytes)
{
  const std::uint64_t us = unsigned_at(bytes, 4);
  return us == std::numeric_limits<std::uint32_t>::max() ?
         std::numeric_limits<double>::infinity() :
         static_cast<double>(us) / 1e6;
}

Motor motor_at(const std::uint8_t * bytes)
{
  Motor motor{};
  motor.id = bytes[0];
  motor.may_turn = (bytes[2] & 2) != 0;
  motor.faults = bytes[3];
  motor.reply_age = age_at(bytes + 4);
  motor.position = double_at(bytes + 8);
  motor.velocity = float_at(bytes + 16);
  motor.current = float_at(bytes + 20);
  motor.temperature = float_at(bytes + 24);
  return motor;
}

State state_at(const std::uint8_t * bytes)
{
  State state{};
  state.armed = (bytes[1] & 1) != 0;
  state.drive = static_cast<Drive>(bytes[2]);
  state.ended = bytes[3];
  state.arm = static_cast<std::uint32_t>(unsigned_at(bytes + 4, 4));
  state.challenge = unsigned_at(bytes + 8, 8);
  // On Linux the steady clock is the monotonic one.
  const auto sent_us = static_cast<std::int64_t>(unsigned_at(bytes + 16, 8));
  state.sent = Clock::time_point(std::chrono::microseconds(sent_us));
  state.holder_number = static_cast<std::uint32_t>(unsigned_at(bytes + 24, 4));
  state.holder = bytes[28];
  state.refused = bytes[30];
  const std::size_t count = std::min<std::size_t>(bytes[29], MOTORS_MAX);
  for (std::size_t place = 0; place < count; ++place) {
    state.motors.push_back(motor_at(bytes + MOTORS_AT + place * MOTOR));
  }
  return state;
}

// Waits until the socket can be read. Returns false if nothing has come until then.
bool wait_for(int socket, Clock::time_point until)
{
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
  pollfd waits{socket, POLLIN, 0};
  return poll(&waits, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0))) > 0;
}

}  // namespace

const Motor * State::motor(std::uint8_t id) const
{
  const auto found = std::find_if(
    motors.begin(), motors.end(), [id](const Motor & motor) {return motor.id == id;});
  return found == motors.end() ? nullptr : &*found;
}

SocketClient::SocketClient()
: socket_(-1), arms_(0) {}

SocketClient::~SocketClient() {close();}

void SocketClient::close()
{
  if (socket_ >= 0) {
    ::close(socket_);
  }
  socket_ = -1;
  state_.reset();
  incoming_.clear();
  outgoing_.clear();
}

bool SocketClient::is_connected() const {return socket_ >= 0;}

const std::string & SocketClient::error() const {return error_;}

const std::optional<State> & SocketClient::state() const {return state_;}

bool SocketClient::fail(const std::string & why)
{
  close();
  error_ = why;
  return false;
}

bool SocketClient::connect(const std::string & path, std::chrono::milliseconds within)
{
  close();
  const auto until = Clock::now() + within;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) {
    return fail(path + ": the path is too long");
  }
  std::copy(path.begin(), path.end(), address.sun_path);
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) {
    return fail(std::string("no socket: ") + std::strerror(errno));
  }
  if (::connect(socket_, reinterpret_cast<const sockaddr *>(&address), sizeof(address)) != 0) {
    return fail(path + ": " + std::strerror(errno) + ". Does motorlink serve --socket run?");
  }
  std::vector<std::uint8_t> hello(MAGIC.begin(), MAGIC.end());
  put(hello, VERSION);
  put(hello, static_cast<std::uint16_t>(FROM_CLIENT));
  outgoing_ = hello;
  if (!flush()) {
    return false;
  }
  std::vector<std::uint8_t> answer;
  while (answer.size() < HELLO) {
    if (!wait_for(socket_, until)) {
      return fail(path + ": no answer");
    }
    std::array<std::uint8_t, HELLO> bytes{};
    const ssize_t got = recv(socket_, bytes.data(), HELLO - answer.size(), 0);
    if (got == 0 || (got < 0 && errno != EAGAIN)) {
      return fail(path + ": closed by the server");
    }
    answer.insert(answer.end(), bytes.begin(), bytes.begin() + std::max<ssize_t>(got, 0));
  }
  if (!std::equal(MAGIC.begin(), MAGIC.end(), answer.begin())) {
    return fail(path + ": not a socket of motorlink");
  }
  const std::uint64_t version = unsigned_at(answer.data() + 4, 2);
  if (version != VERSION) {
    return fail(
      "the server speaks version " + std::to_string(version) + " of the socket, this program version " +
      std::to_string(VERSION) + ": use those of the same release");
  }
  while (!state_) {
    if (!wait_for(socket_, until)) {
      return fail(path + ": no state");
    }
    if (!receive()) {
      return false;
    }
  }
  return true;
}

bool SocketClient::receive_within(std::chrono::milliseconds within)
{
  if (is_connected()) {
    wait_for(socket_, Clock::now() + within);
  }
  return receive();
}

bool SocketClient::receive()
{
  if (!is_connected()) {
    return false;
  }
  std::array<std::uint8_t, 16 * FROM_SERVER> bytes{};
  for (std::size_t turn = 0; turn < MESSAGES_MAX; ++turn) {
    const ssize_t got = recv(socket_, bytes.data(), bytes.size(), 0);
    if (got > 0) {
      incoming_.insert(incoming_.end(), bytes.begin(), bytes.begin() + got);
      if (!read_messages()) {
        return false;
      }
    } else if (got == 0) {
      return fail("closed by the server");
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return flush();
    } else if (errno != EINTR) {
      return fail(std::strerror(errno));
    }
  }
  return flush();
}

bool SocketClient::read_messages()
{
  std::size_t at = 0;
  for (; incoming_.size() - at >= FROM_SERVER; at += FROM_SERVER) {
    const std::uint8_t * message = incoming_.data() + at;
    if (message[0] == 2) {
      const std::size_t length = std::min<std::size_t>(unsigned_at(message + 2, 2), FROM_SERVER - 4);
      return fail(std::string(reinterpret_cast<const char *>(message + 4), length));
    }
    if (message[0] == 1) {
      state_ = state_at(message);
    }
  }
  incoming_.erase(incoming_.begin(), incoming_.begin() + static_cast<std::ptrdiff_t>(at));
  return true;
}

std::uint32_t SocketClient::arm(const std::vector<std::uint8_t> & ids)
{
  ++arms_;
  send_order(1, ids, std::vector<double>(ids.size(), 0.0));
  return arms_;
}

bool SocketClient::set(
  const std::vector<std::uint8_t> & ids, const std::vector<double> & speeds)
{
  return send_order(2, ids, speeds);
}

bool SocketClient::disarm() {return send_order(3, {}, {});}

bool SocketClient::send_order(
  std::uint8_t kind, const std::vector<std::uint8_t> & ids, const std::vector<double> & speeds)
{
  if (!is_connected() || !flush()) {
    return false;
  }
  if (!outgoing_.empty()) {
    // The server takes nothing. A later message is newer.
    return true;
  }
  const std::size_t count = std::min({ids.size(), speeds.size(), MOTORS_MAX});
  std::vector<std::uint8_t> message = {kind, static_cast<std::uint8_t>(count), 0, 0};
  put(message, arms_);
  put(message, state_ ? state_->challenge : std::uint64_t{0});
  for (std::size_t place = 0; place < MOTORS_MAX; ++place) {
    message.push_back(place < count ? ids[place] : std::uint8_t{0});
  }
  for (std::size_t place = 0; place < MOTORS_MAX; ++place) {
    put(message, place < count ? static_cast<float>(speeds[place]) : 0.0f);
  }
  outgoing_ = std::move(message);
  return flush();
}

bool SocketClient::flush()
{
  while (!outgoing_.empty()) {
    const ssize_t sent = send(socket_, outgoing_.data(), outgoing_.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      outgoing_.erase(outgoing_.begin(), outgoing_.begin() + sent);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return true;
    } else if (errno != EINTR) {
      return fail(std::strerror(errno));
    }
  }
  return true;
}

std::string why_ended(std::uint8_t ended)
{
  switch (ended) {
    case 0: return "it has not ended";
    case 1: return "it was disarmed";
    case 2: return "this program did not answer for 100 ms";
    case 3: return "a page has taken control";
    case 4: return "a person has stopped the motors";
    case 5: return "the server has stopped the motors";
    case 6: return "a motor reports a fault";
    case 7: return "a motor does not reply";
    case 8: return "a motor has exceeded a limit";
    case 9: return "a motor is in another loop, not enabled, or its temperature is unknown";
    case 10: return "the motors were not started: the log of motorlink says why";
    case 11: return "a setpoint is no finite number";
    case 12: return "setpoints for other motors";
    case 13: return "the port of the motors is gone";
    default: return "reason " + std::to_string(ended);
  }
}

std::string why_refused(std::uint8_t refused)
{
  switch (refused) {
    case 0: return "it was done";
    case 1: return "a page has control";
    case 2: return "another client of the socket has control";
    case 3: return "the motors were stopped meanwhile, or this program is too slow";
    case 4: return "a speed is not zero";
    case 5: return "the motors are driven already";
    case 6: return "a person has stopped all motors: Release on a page, or release in the text form";
    default: return "reason " + std::to_string(refused);
  }
}

}  // namespace motorlink_hardware
