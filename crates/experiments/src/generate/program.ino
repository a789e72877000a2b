// @NAME@
//
// Drives M0601/DDSM115 hub motors over RS485, for an ESP32 with a transceiver.
// Moves: @WHAT@.
// THE WHEELS TURN. Fasten the motors first. The power switch is the emergency stop.
// If the cable or the computer fails, the wheel may keep turning. Only the power switch stops it then.
// Nothing moves after a reset: send y on the USB serial port to start. Any other character, such as Ctrl-C, stops.

#include <Arduino.h>
#include <math.h>
#include <string.h>

const int RX_PIN = 16, TX_PIN = 17;
// The pin that switches the transceiver to sending; -1 for one that does so by itself.
const int DE_PIN = 4;

const uint32_t PERIOD_MS = @PERIOD_MS@;
// A limit of -1 is none.
const double LIMIT_RPM = @LIMIT_RPM@, LIMIT_AMPS = @LIMIT_AMPS@, LIMIT_CELSIUS = @LIMIT_CELSIUS@;
const uint32_t REPLY_MS = 20, OVER_CURRENT_MS = 500, STOP_MS = 3000;
const double FRESH_S = 0.5;
const int MISSED_MAX = 10, DEPTH_MAX = 8;
// Replies in a row without speed and without motion, in the velocity loop, that make a standstill.
const int STILL_REPLIES = 3;
const double STILL_DEGREES = 0.3;
// Mode switches to a motor without replies: it has received five of them then, or receives nothing.
const int SWITCHES_MAX = 15;
const uint32_t SWITCH_MS = 20;

enum { UNKNOWN = 0, CURRENT = 1, VELOCITY = 2, POSITION = 3 };

struct Named { uint8_t id, mode; int8_t sign; };
// Motor ID, its loop, and -1 if it is mounted mirrored: its speed and its current have the opposite sign on the wire.
const Named MOTORS[@MOTOR_COUNT@] = {
    // @MOTORS@
};
const int COUNT = @MOTOR_COUNT@;

struct Row {
  // 0 move, 1 loop, 2 end of a loop; the motors as bits; 0 step, 1 ramp, 2 sine, 3 triangle, 4 chirp, 5 brake.
  uint8_t kind;
  uint32_t motors;
  uint8_t shape;
  double value, amplitude, hz, to_hz;
  uint8_t acceleration;
  double seconds;
  // 0 none, 1 rpm above, 2 rpm below, 3 degrees near, 4 celsius above, 5 celsius below.
  uint8_t condition;
  double bound, tolerance;
  // Passes of a loop, or the row of its beginning.
  uint32_t number;
};
const Row ROWS[@ROW_COUNT@] = {
    // @ROWS@
};
const int ROW_COUNT = @ROW_COUNT@;

struct Motor {
  int missed = 0, mode = 0, rpm = 0, faults = 0;
  bool heard = false;
  double heard_s = 0, amps = 0, degrees = 0, celsius = -1, over_since_s = 0, query_s = 0;
  // The setpoint that is kept, or the row that is followed since when and from where.
  double kept = 0, since_s = 0, start = 0;
  const Row *row = nullptr;
  uint8_t acceleration = 0;
  bool brakes = false;
  int switches = 0, still = 0;
  uint32_t switch_ms = 0;
  double still_degrees = 0;
};
Motor motors[COUNT];
const char *ended = nullptr;
uint32_t start_us = 0, last_us = 0;
double passed_s = 0;

// Seconds since the start; micros() wraps every 71 minutes.
double seconds_now() {
  uint32_t now = micros();
  passed_s += (uint32_t)(now - last_us) * 1e-6;
  last_us = now;
  return passed_s;
}

uint8_t crc8(const uint8_t *data, int count) {
  uint8_t crc = 0;
  for (int i = 0; i < count; i++) {
    crc ^= data[i];
    for (int bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >> 1) ^ 0x8C : crc >> 1;
  }
  return crc;
}

void send(const uint8_t *frame) {
  if (DE_PIN >= 0) digitalWrite(DE_PIN, HIGH);
  Serial2.write(frame, 10);
  Serial2.flush();
  if (DE_PIN >= 0) digitalWrite(DE_PIN, LOW);
}

// The next reply. The adapter may echo the request in front of it, whole or cut short.
bool receive(int m, uint8_t *reply) {
  int got = 0;
  for (uint32_t began = millis(); millis() - began < REPLY_MS;) {
    if (!Serial2.available()) continue;
    if (got == 10) memmove(reply, reply + 1, --got);
    reply[got++] = Serial2.read();
    // Byte 1 of a reply is a loop, that of a request is not.
    bool is_reply = got == 10 && reply[0] == MOTORS[m].id && reply[1] >= CURRENT && reply[1] <= POSITION;
    if (is_reply && crc8(reply, 9) == reply[9]) return true;
  }
  return false;
}

// Sends nine bytes with their CRC; reads the reply.
bool exchange(int m, uint8_t *frame) {
  Motor &motor = motors[m];
  while (Serial2.available()) Serial2.read();
  frame[9] = crc8(frame, 9);
  send(frame);
  uint8_t reply[10];
  if (!receive(m, reply)) {
    motor.missed++;
    return false;
  }
  motor.missed = 0;
  motor.heard = true;
  motor.heard_s = seconds_now();
  motor.mode = reply[1];
  motor.amps = (int16_t)(reply[2] << 8 | reply[3]) * 8.0 / 32767;
  motor.rpm = (int16_t)(reply[4] << 8 | reply[5]);
  motor.faults = reply[8] & 0x1F;
  if (frame[1] == 0x74) motor.celsius = reply[6];
  else motor.degrees = (reply[6] << 8 | reply[7]) * 360.0 / 32767;
  return true;
}

bool query(int m) {
  uint8_t frame[10] = {MOTORS[m].id, 0x74};
  return exchange(m, frame);
}

bool drive(int m, long raw, uint8_t acceleration, uint8_t brake) {
  uint8_t frame[10] = {MOTORS[m].id, 0x64, (uint8_t)(raw >> 8), (uint8_t)raw, 0, 0, acceleration, brake};
  return exchange(m, frame);
}

// It has no reply. Until the next reply the loop is unknown.
void switch_once(int m, uint8_t mode) {
  uint8_t frame[10] = {MOTORS[m].id, 0xA0, 0, 0, 0, 0, 0, 0, 0, mode};
  motors[m].mode = UNKNOWN;
  send(frame);
}

// Any character on the USB serial port ends the run.
void listen() {
  if (!Serial.available()) return;
  Serial.read();
  ended = "stopped by you";
}

// Five frames, 20 ms apart.
void switch_mode(int m, uint8_t mode) {
  for (int i = 0; i < 5; i++) {
    switch_once(m, mode);
    delay(SWITCH_MS);
  }
  listen();
}

// The setpoint at this second of the run.
double value_at(const Motor &motor, double at_s) {
  if (!motor.row) return motor.kept;
  const Row &row = *motor.row;
  double t = at_s - motor.since_s;
  t = t < 0 ? 0 : t > row.seconds ? row.seconds : t;
  const double turn = 6.283185307179586;
  switch (row.shape) {
    case 1:
      return row.seconds > 0 ? motor.start + (row.value - motor.start) * t / row.seconds : row.value;
    case 2:
      return row.value + row.amplitude * sin(turn * row.hz * t);
    case 3: {
      double part = row.hz * t + 0.25;
      part -= floor(part);
      return row.value + row.amplitude * (1 - 4 * fabs(part - 0.5));
    }
    case 4: {
      double octaves = log(row.to_hz / row.hz), turns = row.hz * t;
      if (row.seconds > 0 && fabs(octaves) > 1e-9)
        turns = row.hz * row.seconds / octaves * expm1(octaves * t / row.seconds);
      return row.value + row.amplitude * sin(turn * turns);
    }
    case 5:
      return 0;
    default:
      return row.value;
  }
}

void set(int m, double value) {
  Motor &motor = motors[m];
  if (motor.brakes) drive(m, 0, 0, 0xFF);
  else if (MOTORS[m].mode == VELOCITY) drive(m, MOTORS[m].sign * lround(value), motor.acceleration, 0);
  else if (MOTORS[m].mode == CURRENT) drive(m, MOTORS[m].sign * lround(value * 32767 / 8), 0, 0);
  else drive(m, lround(value * 32767 / 360), 0, 0);
}

// What ends the run.
void check(int m, double now_s) {
  Motor &motor = motors[m];
  if (motor.missed >= MISSED_MAX) ended = "a motor does not reply";
  else if (motor.faults) ended = "a motor reports a fault";
  else if (motor.heard && motor.mode != MOTORS[m].mode) ended = "a motor is in another loop";
  else if (LIMIT_RPM >= 0 && abs(motor.rpm) > LIMIT_RPM) ended = "too fast";
  else if (LIMIT_CELSIUS >= 0 && motor.celsius > LIMIT_CELSIUS) ended = "too hot";
  else if (LIMIT_AMPS < 0 || fabs(motor.amps) <= LIMIT_AMPS) motor.over_since_s = now_s;
  else if (now_s - motor.over_since_s > OVER_CURRENT_MS / 1000.0) ended = "too much current";
}

bool holds(int m, const Row &row, double since_s) {
  const Motor &motor = motors[m];
  if (row.condition == 4) return motor.celsius >= row.bound;
  if (row.condition == 5) return motor.celsius >= 0 && motor.celsius <= row.bound;
  if (!motor.heard || motor.heard_s < since_s) return false;
  if (row.condition == 1) return abs(motor.rpm) >= row.bound;
  if (row.condition == 2) return abs(motor.rpm) <= row.bound;
  double off = fmod(motor.degrees - row.bound + 540, 360) - 180;
  return fabs(off) <= row.tolerance;
}

// The next frames of the stop of a motor.
void stop_once(int m) {
  Motor &motor = motors[m];
  if (motor.mode != VELOCITY && (motor.switches == 0 || millis() - motor.switch_ms >= SWITCH_MS)) {
    motor.switches++;
    motor.switch_ms = millis();
    bool may_push = motor.mode == CURRENT;
    switch_once(m, VELOCITY);
    // There a brake frame is 0 A.
    if (may_push) drive(m, 0, 0, 0xFF);
  }
  // In the position loop a brake frame is a move to 0 degrees: first the motor reports that it has left it.
  bool may_hold = motor.mode != VELOCITY && motor.mode != CURRENT;
  if (may_hold && (motor.missed == 0 || motor.switches < SWITCHES_MAX)) {
    query(m);
    return;
  }
  bool replied = drive(m, 0, 0, 0xFF) && motor.mode == VELOCITY && motor.rpm == 0;
  double moved = fabs(fmod(motor.degrees - motor.still_degrees + 540, 360) - 180);
  if (!replied || motor.still == 0 || moved > STILL_DEGREES) {
    motor.still = replied ? 1 : 0;
    motor.still_degrees = motor.degrees;
  } else {
    motor.still++;
  }
}

// Velocity loop, zero, brake, until each motor reports a standstill.
void stop() {
  bool all = false;
  for (uint32_t began = millis(); !all && millis() - began < STOP_MS;) {
    all = true;
    for (int m = 0; m < COUNT; m++) {
      stop_once(m);
      all = all && motors[m].still >= STILL_REPLIES;
    }
    delay(5);
  }
  for (int m = 0; m < COUNT; m++) {
    Serial.print("motor ");
    Serial.print((int)MOTORS[m].id);
    Serial.println(motors[m].still >= STILL_REPLIES ? " stands" : " DID NOT CONFIRM ITS STOP");
  }
}

// Sends the setpoints of every row at its time.
void run() {
  int at = 0, depth = 0;
  double began_s = 0;
  bool entered = false;
  uint32_t passes[DEPTH_MAX];
  uint32_t number = 0;
  last_us = micros();
  passed_s = 0;
  for (int m = 0; m < COUNT; m++) motors[m].heard = false;
  while (at < ROW_COUNT && !ended) {
    const Row &row = ROWS[at];
    double now_s = seconds_now();
    if (row.kind == 1) {
      passes[depth++] = row.number;
      at++;
      continue;
    }
    if (row.kind == 2) {
      // The last step of the pass has just ended: no reply is newer than its end.
      bool over = false;
      for (int m = 0; row.condition && m < COUNT; m++) over = over || holds(m, row, seconds_now() - FRESH_S);
      uint32_t left = --passes[depth - 1];
      if (left > 0 && !over) at = row.number;
      else depth--;
      at++;
      continue;
    }
    if (!entered) {
      entered = true;
      for (int m = 0; m < COUNT; m++) {
        if (!(row.motors >> m & 1)) continue;
        motors[m].start = value_at(motors[m], began_s);
        motors[m].row = &row;
        motors[m].since_s = began_s;
        motors[m].acceleration = row.acceleration;
        motors[m].brakes = row.shape == 5;
      }
    }
    double over_s = -1;
    bool held = row.condition && now_s > began_s;
    for (int m = 0; m < COUNT; m++)
      if (row.motors >> m & 1) held = held && holds(m, row, began_s);
    if (held) over_s = now_s;
    else if (now_s >= began_s + row.seconds) {
      if (row.condition) {
        ended = "waited in vain";
        break;
      }
      over_s = began_s + row.seconds;
    }
    if (over_s >= 0) {
      for (int m = 0; m < COUNT; m++) {
        if (!(row.motors >> m & 1)) continue;
        motors[m].kept = value_at(motors[m], over_s);
        motors[m].row = nullptr;
      }
      at++;
      began_s = over_s;
      entered = false;
      continue;
    }
    for (int m = 0; m < COUNT && !ended; m++) {
      if (now_s >= motors[m].query_s) {
        motors[m].query_s = now_s + 1;
        query(m);
      } else {
        set(m, value_at(motors[m], now_s));
      }
      check(m, now_s);
    }
    // The next of the moments n * period: a late round makes no later one late.
    uint32_t next = (uint32_t)ceil(seconds_now() * 1000 / PERIOD_MS);
    number = next > number ? next : number + 1;
    while (seconds_now() * 1000 < (double)number * PERIOD_MS && !ended) {
      listen();
    }
  }
}

void setup() {
  Serial.begin(115200);
  Serial2.begin(115200, SERIAL_8N1, RX_PIN, TX_PIN);
  if (DE_PIN >= 0) pinMode(DE_PIN, OUTPUT);
  Serial.println("Moves: @WHAT@. Send y to start.");
}

void loop() {
  if (!Serial.available()) return;
  if (Serial.read() != 'y') return;
  ended = nullptr;
  for (int m = 0; m < COUNT; m++) motors[m] = Motor();
  for (int m = 0; m < COUNT && !ended; m++) {
    switch_mode(m, MOTORS[m].mode);
    if (ended) break;
    bool replied = false;
    for (int i = 0; i < MISSED_MAX && !replied; i++) replied = query(m);
    check(m, 0);
    if (!replied) ended = "a motor does not reply";
    if (!ended && MOTORS[m].mode == POSITION) {
      // An angle begins where the wheel is: the drive reply to zero speed tells it.
      switch_mode(m, VELOCITY);
      drive(m, 0, 0, 0);
      motors[m].kept = motors[m].degrees;
      if (!ended) switch_mode(m, POSITION);
    }
  }
  if (!ended) {
    Serial.println("running");
    run();
  }
  stop();
  Serial.print(ended ? "aborted: " : "finished");
  Serial.println(ended ? ended : "");
}
