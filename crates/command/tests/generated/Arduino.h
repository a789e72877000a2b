// What a sketch needs of the Arduino core, on the host: USB serial is stdin and stdout, Serial2 is the port that
// the environment variable PORT names. For tests.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { SERIAL_8N1, LOW = 0, HIGH = 1, OUTPUT = 1 };

inline uint64_t host_micros() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000000ull + now.tv_nsec / 1000;
}
// Both wrap, as on the board.
inline uint32_t micros() { return (uint32_t)host_micros(); }
inline uint32_t millis() { return (uint32_t)(host_micros() / 1000); }
inline void delay(uint32_t ms) { usleep(ms * 1000); }
inline void pinMode(int, int) {}
inline void digitalWrite(int, int) {}

// A terminal sends Ctrl-C to the board as a byte.
inline volatile sig_atomic_t ctrl_c = 0;
inline void on_ctrl_c(int) { ctrl_c = 1; }

class HostSerial {
  int in = 0, out = 1;
  bool usb;

 public:
  explicit HostSerial(bool usb) : usb(usb) {}
  void begin(long, int = 0, int = 0, int = 0) {
    if (usb) {
      signal(SIGINT, on_ctrl_c);
      return;
    }
    in = out = open(getenv("PORT"), O_RDWR | O_NOCTTY);
    if (in < 0) {
      perror("PORT");
      exit(2);
    }
    termios raw;
    tcgetattr(in, &raw);
    cfmakeraw(&raw);
    cfsetspeed(&raw, B115200);
    tcsetattr(in, TCSANOW, &raw);
  }
  int available() {
    if (usb && ctrl_c) return 1;
    pollfd one = {in, POLLIN, 0};
    return poll(&one, 1, 0) == 1 && (one.revents & POLLIN);
  }
  int read() {
    if (usb && ctrl_c) {
      ctrl_c = 0;
      return 3;
    }
    uint8_t byte;
    if (::read(in, &byte, 1) == 1) return byte;
    // The one at the USB port has gone.
    if (usb) exit(0);
    return -1;
  }
  void write(const uint8_t *bytes, size_t count) {
    while (count > 0) {
      ssize_t done = ::write(out, bytes, count);
      if (done <= 0) return;
      bytes += done;
      count -= done;
    }
  }
  void flush() { tcdrain(out); }
  void print(const char *text) { write((const uint8_t *)text, strlen(text)); }
  void print(int number) {
    char text[16];
    snprintf(text, sizeof text, "%d", number);
    print(text);
  }
  void println(const char *text) {
    print(text);
    print("\n");
  }
};

inline HostSerial Serial(true), Serial2(false);

void setup();
void loop();

int main() {
  setup();
  for (;;) {
    loop();
    usleep(100);
  }
}
