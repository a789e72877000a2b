#!/usr/bin/env python3
"""@NAME@

Drives M0601/DDSM115 hub motors over RS485. Needs pyserial: pip install pyserial
Moves: @WHAT@.
THE WHEELS TURN. Fasten the motors first. Ctrl-C stops them; the power switch is the emergency stop.
If the cable or the computer fails, the wheel may keep turning. Only the power switch stops it then.
"""

import math
import signal
import sys
import time

import serial

PORT = "@PORT@"
PERIOD_S = @PERIOD_MS@ / 1000
LIMIT_RPM, LIMIT_AMPS, LIMIT_CELSIUS = @LIMIT_RPM@, @LIMIT_AMPS@, @LIMIT_CELSIUS@

# Motor ID, its loop (1 current, 2 velocity, 3 position), and -1 if it is mounted mirrored: its speed and its current
# have the opposite sign on the wire.
MOTORS = [
    # @MOTORS@
]

# kind (0 move, 1 loop, 2 end of a loop), motors (a bit each), shape (0 step, 1 ramp, 2 sine, 3 triangle,
# 4 chirp, 5 brake), value, amplitude, hz, to_hz, acceleration, seconds, condition (0 none, 1 rpm above,
# 2 rpm below, 3 degrees near, 4 celsius above, 5 celsius below), its bound, its tolerance, passes or first row
ROWS = [
    # @ROWS@
]

LOOPS = CURRENT, VELOCITY, POSITION = 1, 2, 3
REPLY_S = 0.02
MISSED_MAX = 10
OVER_CURRENT_S = 0.5
FRESH_S = 0.5
STOP_S = 3.0
# Replies in a row without speed and without motion, in the velocity loop, that make a standstill.
STILL_REPLIES, STILL_DEGREES = 3, 0.3
# Mode switches to a motor without replies: it has received five of them then, or receives nothing.
SWITCHES_MAX, SWITCH_S = 15, 0.02


class Ended(Exception):
    """What ends the run before its last step."""


def crc8(data):
    """CRC-8/MAXIM."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0x8C if crc & 1 else crc >> 1
    return crc


class Motor:
    """A motor and what it last reported."""

    def __init__(self, port, address, mode, sign):
        self.port, self.address, self.mode, self.sign = port, address, mode, sign
        self.missed, self.heard_s, self.over_since_s = 0, None, None
        self.rpm = self.amps = self.degrees = self.celsius = self.reported_mode = None
        self.faults = 0
        self.query_s = 0.0
        # The setpoint that is kept, or the row that is followed since when and from where.
        self.kept, self.row, self.since_s, self.start = 0.0, None, 0.0, 0.0
        self.acceleration, self.brakes = 0, False
        self.switches, self.switch_s, self.still, self.still_degrees = 0, 0.0, 0, 0.0

    def exchange(self, body):
        """Sends nine bytes with their CRC; reads the reply."""
        self.port.reset_input_buffer()
        self.port.write(bytes(body) + bytes([crc8(body)]))
        reply = self.receive()
        if reply is None:
            self.missed += 1
            return False
        self.missed, self.heard_s = 0, time.monotonic()
        self.reported_mode = reply[1]
        self.amps = int.from_bytes(reply[2:4], "big", signed=True) * 8 / 32767
        self.rpm = int.from_bytes(reply[4:6], "big", signed=True)
        self.faults = reply[8] & 0x1F
        if body[1] == 0x74:
            self.celsius = reply[6]
        else:
            self.degrees = int.from_bytes(reply[6:8], "big") * 360 / 32767
        return True

    def receive(self):
        """The next reply. The adapter may echo the request in front of it, whole or cut short."""
        got, until_s = b"", time.monotonic() + REPLY_S
        while time.monotonic() < until_s:
            got += self.port.read(1)
            last = got[-10:]
            # Byte 1 of a reply is a loop, that of a request is not.
            if len(last) == 10 and last[0] == self.address and last[1] in LOOPS and crc8(last[:9]) == last[9]:
                return last
        return None

    def query(self):
        return self.exchange([self.address, 0x74, 0, 0, 0, 0, 0, 0, 0])

    def drive(self, raw, acceleration=0, brake=0):
        high, low = (raw & 0xFFFF).to_bytes(2, "big")
        return self.exchange([self.address, 0x64, high, low, 0, 0, acceleration, brake, 0])

    def switch_once(self, mode):
        """It has no reply. Until the next reply the loop is unknown."""
        self.reported_mode = None
        self.port.write(bytes([self.address, 0xA0, 0, 0, 0, 0, 0, 0, 0, mode]))

    def switch(self, mode):
        """Five frames, 20 ms apart."""
        for _ in range(5):
            self.switch_once(mode)
            time.sleep(SWITCH_S)

    def stop(self):
        """The next frames of a stop."""
        if self.reported_mode != VELOCITY and time.monotonic() >= self.switch_s:
            self.switches, self.switch_s = self.switches + 1, time.monotonic() + SWITCH_S
            may_push = self.reported_mode == CURRENT
            self.switch_once(VELOCITY)
            if may_push:
                # There a brake frame is 0 A.
                self.drive(0, 0, 0xFF)
        # In the position loop a brake frame is a move to 0 degrees: first the motor reports that it has left it.
        if self.reported_mode not in (VELOCITY, CURRENT) and (self.missed == 0 or self.switches < SWITCHES_MAX):
            self.query()
            return
        replied = self.drive(0, 0, 0xFF) and self.reported_mode == VELOCITY and abs(self.rpm) < 1
        moved = abs((self.degrees - self.still_degrees + 180) % 360 - 180) if replied else 0.0
        if not replied or self.still == 0 or moved > STILL_DEGREES:
            self.still, self.still_degrees = int(replied), self.degrees
        else:
            self.still += 1

    def stands(self):
        return self.still >= STILL_REPLIES

    def set(self, value, acceleration, brakes):
        if brakes:
            return self.drive(0, 0, 0xFF)
        if self.mode == VELOCITY:
            return self.drive(self.sign * round(value), acceleration)
        if self.mode == CURRENT:
            return self.drive(self.sign * round(value * 32767 / 8))
        return self.drive(round(value * 32767 / 360))

    def check(self, now_s):
        if self.missed >= MISSED_MAX:
            raise Ended(f"motor {self.address} does not reply")
        if self.faults:
            raise Ended(f"motor {self.address} reports fault 0x{self.faults:02X}")
        if self.reported_mode != self.mode:
            raise Ended(f"motor {self.address} is in loop {self.reported_mode}, not {self.mode}")
        if LIMIT_RPM is not None and abs(self.rpm) > LIMIT_RPM:
            raise Ended(f"motor {self.address} turns at {self.rpm} rpm, above {LIMIT_RPM}")
        if LIMIT_CELSIUS is not None and (self.celsius or 0) > LIMIT_CELSIUS:
            raise Ended(f"motor {self.address} has {self.celsius} deg C, above {LIMIT_CELSIUS}")
        if LIMIT_AMPS is None or abs(self.amps) <= LIMIT_AMPS:
            self.over_since_s = now_s
        elif now_s - self.over_since_s > OVER_CURRENT_S:
            raise Ended(f"motor {self.address} draws {self.amps:.2f} A, above {LIMIT_AMPS}")

    def holds(self, kind, bound, tolerance, since_s):
        if kind == 4:
            return self.celsius is not None and self.celsius >= bound
        if kind == 5:
            return self.celsius is not None and self.celsius <= bound
        if self.heard_s is None or self.heard_s < since_s:
            return False
        if kind == 1:
            return abs(self.rpm) >= bound
        if kind == 2:
            return abs(self.rpm) <= bound
        return abs((self.degrees - bound + 180) % 360 - 180) <= tolerance

    def value(self, at_s):
        """The setpoint at this second of the run."""
        if self.row is None:
            return self.kept
        _, _, shape, to, amplitude, hz, to_hz, _, seconds, *_ = self.row
        t = min(max(at_s - self.since_s, 0.0), seconds)
        if shape == 1:
            return self.start + (to - self.start) * t / seconds if seconds > 0 else to
        if shape == 2:
            return to + amplitude * math.sin(math.tau * hz * t)
        if shape == 3:
            return to + amplitude * (1 - 4 * abs((hz * t + 0.25) % 1.0 - 0.5))
        if shape == 4:
            octaves = math.log(to_hz / hz)
            if seconds > 0 and abs(octaves) > 1e-9:
                turns = hz * seconds / octaves * math.expm1(octaves * t / seconds)
            else:
                turns = hz * t
            return to + amplitude * math.sin(math.tau * turns)
        return 0.0 if shape == 5 else to


def run(motors):
    """Sends the setpoints of every row at its time."""
    start_s = time.monotonic()
    at, began_s, entered, passes = 0, 0.0, False, []
    number = 0
    while at < len(ROWS):
        row = ROWS[at]
        kind, mask, shape, *_ = row
        acceleration, seconds, condition, bound, tolerance, count = row[7:]
        now_s = time.monotonic() - start_s
        since_s = start_s + began_s
        if kind == 1:
            passes.append(count)
            at += 1
            continue
        if kind == 2:
            # The last step of the pass has just ended: no reply is newer than its end.
            over = condition and any(m.holds(condition, bound, tolerance, time.monotonic() - FRESH_S) for m in motors)
            left = passes.pop() - 1
            if left > 0 and not over:
                passes.append(left)
                at = count
            at += 1
            continue
        mine = [motor for place, motor in enumerate(motors) if mask >> place & 1]
        if not entered:
            entered = True
            for motor in mine:
                motor.start, motor.row, motor.since_s = motor.value(began_s), row, began_s
                motor.acceleration, motor.brakes = acceleration, shape == 5
        over_s = None
        if not condition:
            if now_s >= began_s + seconds:
                over_s = began_s + seconds
        elif now_s > began_s and all(m.holds(condition, bound, tolerance, since_s) for m in mine):
            over_s = now_s
        elif now_s >= began_s + seconds:
            raise Ended(f"row {at} waited {seconds} s in vain")
        if over_s is not None:
            for motor in mine:
                motor.kept, motor.row = motor.value(over_s), None
            at, began_s, entered = at + 1, over_s, False
            continue
        for motor in motors:
            if now_s >= motor.query_s:
                motor.query_s = now_s + 1.0
                motor.query()
            else:
                motor.set(motor.value(now_s), motor.acceleration, motor.brakes)
            motor.check(now_s)
        # The next of the moments start + n * period: a late round makes no later one late.
        number = max(number + 1, math.ceil((time.monotonic() - start_s) / PERIOD_S))
        time.sleep(max(0.0, start_s + number * PERIOD_S - time.monotonic()))


def stop(motors):
    """Velocity loop, zero, brake, until each motor reports a standstill."""
    until_s = time.monotonic() + STOP_S
    while time.monotonic() < until_s and not all(motor.stands() for motor in motors):
        for motor in motors:
            motor.stop()
        time.sleep(0.005)
    for motor in motors:
        said = "stands" if motor.stands() else "DID NOT CONFIRM ITS STOP"
        print(f"motor {motor.address} {said}", flush=True)
    return all(motor.stands() for motor in motors)


def main():
    arguments = [word for word in sys.argv[1:] if word != "--yes"]
    print("Moves: @WHAT@.", flush=True)
    if "--yes" not in sys.argv and input("Type yes to start: ") != "yes":
        return 1
    # A program that is ended by a signal stops its motors as well.
    def end(*_):
        raise KeyboardInterrupt
    for name in ("SIGTERM", "SIGHUP", "SIGINT"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), end)
    with serial.Serial(arguments[0] if arguments else PORT, 115200, timeout=REPLY_S) as port:
        motors = [Motor(port, *motor) for motor in MOTORS]
        failed = None
        try:
            for motor in motors:
                motor.switch(motor.mode)
                if not any(motor.query() for _ in range(MISSED_MAX)):
                    raise Ended(f"motor {motor.address} does not reply")
                motor.over_since_s = 0.0
                motor.check(0.0)
                if motor.mode == POSITION:
                    # An angle begins where the wheel is: the drive reply to zero speed tells it.
                    motor.switch(VELOCITY)
                    motor.drive(0)
                    motor.kept = motor.degrees or 0.0
                    motor.switch(POSITION)
            print("running", flush=True)
            run(motors)
        except KeyboardInterrupt:
            failed = "stopped by you"
        except Exception as error:  # whatever it is, the motors are stopped
            failed = str(error)
        finally:
            # A second Ctrl-C must not end the stop.
            for name in ("SIGTERM", "SIGHUP", "SIGINT"):
                if hasattr(signal, name):
                    signal.signal(getattr(signal, name), signal.SIG_IGN)
            try:
                stands = stop(motors)
            except (serial.SerialException, OSError) as error:
                stands, failed = False, f"{error}; the wheels may keep turning: switch their power off"
    print(f"aborted: {failed}" if failed else "finished", flush=True)
    return 0 if stands and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
