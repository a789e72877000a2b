"""Drives hub motors DDSM115 (M0601), DDSM315, DDSM210 and DDSM400 on a serial port.

    import motorlink

    with motorlink.open("/dev/ttyUSB0") as bus:      # or motorlink.virtual(ids=[1, 2])
        wheel = bus.motor(1)
        wheel.drive(rpm=100)
        for reading in wheel.readings(seconds=2):
            print(reading.speed_rpm, reading.current_a, reading.temperature_c)
    # Leaving the block stops the motors and confirms it: see bus.last_stop.

The loop runs in Rust, at up to 500 setpoints a second to each motor, whatever the interpreter does. A program that does not
call the bus for a second has its motors stopped: wait with `bus.sleep`, or open with `keepalive=False`. The end of the
program, Ctrl-C, SIGTERM and SIGHUP stop them too. After `kill -9`, many motors keep their last command for ever; the next
program on that adapter stops them first. The power switch is the only emergency stop.
"""

from __future__ import annotations

import asyncio
import atexit
import json
import math
import operator
import os
import signal
import sys
import threading
import time
import weakref
from collections.abc import AsyncIterator, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from . import _motorlink
from ._motorlink import Error, InvalidInput, NotDone, Reading

__all__ = [
    "Bus",
    "Error",
    "Group",
    "InvalidInput",
    "Motor",
    "NotDone",
    "Reading",
    "Run",
    "Stop",
    "open",
    "virtual",
]

#: How long a call waits for readings before it looks at the clock again, in seconds.
_STEP_S = 0.05


def _index(name: str, value: Any) -> int:
    try:
        return operator.index(value)
    except TypeError:
        raise InvalidInput(f"{name}: expected a whole number, not {value!r}") from None


def _whole(name: str, value: Any, most: int = 255) -> int:
    """A whole number for Rust, which checks its range. What its type does not hold becomes `most`, which is out of range."""
    number = _index(name, value)
    return number if 0 <= number <= most else most


def _number(name: str, value: Any) -> float:
    try:
        number = math.nan if isinstance(value, (str, bytes, bytearray)) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise InvalidInput(f"{name}: expected a number, not {value!r}")
    return number


def _time(name: str, value: Any) -> float:
    """Seconds: at most a year, which every clock holds."""
    seconds = _number(name, value)
    if not 0 <= seconds <= 366 * 86_400:
        raise InvalidInput(f"{name}: expected 0 seconds to a year, not {value!r}")
    return seconds


def _path(name: str, value: Any) -> str | None:
    try:
        return None if value is None else os.fsdecode(value)
    except TypeError:
        raise InvalidInput(f"{name}: expected a path, not {value!r}") from None


@dataclass(frozen=True)
class Stop:
    """What a stop has shown."""

    #: Motors that reported standstill.
    confirmed: list[int] = field(default_factory=list)
    #: Motors that did not: cut their power.
    may_turn: list[int] = field(default_factory=list)

    def __bool__(self) -> bool:
        """Whether every motor stands."""
        return not self.may_turn


@dataclass(frozen=True)
class Run:
    """A run of an experiment. docs/experiments.md explains the figures."""

    #: Why it was aborted; None if it finished.
    aborted: str | None
    #: A dict for each motor, step or frequency, and one for each other study. None is unknown.
    figures: list[dict[str, Any]]
    #: The whole run as JSON, as the page and the command write it.
    json: str
    #: Setpoints and samples as CSV.
    csv: str

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes run-N.json and run-N.csv to a folder."""
        number = json.loads(self.json)["number"]
        stem = os.path.join(folder, f"run-{number}")
        for end, text in (("json", self.json), ("csv", self.csv)):
            with _builtin_open(f"{stem}.{end}", "w", encoding="utf-8") as file:
                file.write(text)


class Group:
    """Motors that are driven together. A mirrored one turns the other way round; its readings have the sign of its side."""

    def __init__(self, bus: Bus, motors: Sequence[tuple[int, bool]]) -> None:
        self._bus = bus
        self._motors = list(motors)

    @property
    def ids(self) -> list[int]:
        """The IDs."""
        return [motor for motor, _ in self._motors]

    def drive(
        self,
        *,
        rpm: float | None = None,
        amps: float | None = None,
        degrees: float | None = None,
        acceleration: int = 0,
        high_current: bool = False,
    ) -> None:
        """Drives at a speed (rpm), a torque current (A), or to an angle (0 to 360 degrees), until the next command.

        The first call returns when every motor is driven: one that turns in another loop is stopped and switched first.
        Further calls in that loop change the setpoint at once. `acceleration` is how gently the motor itself speeds up, 0 to
        255; more is gentler. A current above 6.1 A needs `high_current=True`.
        """
        asked = {"rpm": rpm, "amps": amps, "degrees": degrees}
        given = [(name, value) for name, value in asked.items() if value is not None]
        if len(given) != 1:
            raise InvalidInput("drive: give one of rpm, amps, degrees")
        name, value = given[0]
        if not 0 <= _index("acceleration", acceleration) <= 255:
            raise InvalidInput(f"acceleration: expected 0 to 255, not {acceleration!r}")
        high_current = bool(high_current)
        self._bus._line.drive(self._motors, name, _number(name, value), acceleration, high_current)

    def stop(self) -> Stop:
        """Stops the motors until each reports standstill."""
        return self._bus._stopped(self._bus._line.stop(self.ids), self.ids)

    def readings(self, seconds: float | None = None) -> Iterator[Reading]:
        """The readings as they come, for this many seconds, or for ever. Raises NotDone if the drive ends by itself."""
        seconds = None if seconds is None else _time("seconds", seconds)
        line = self._bus._line
        reader = line.begin_reading(self._motors)
        try:
            begun = time.monotonic()
            while (left := _left(begun, seconds)) > 0:
                yield from line.take_readings(reader, min(left, _STEP_S))
        finally:
            line.end_reading(reader)

    async def readings_async(self, seconds: float | None = None) -> AsyncIterator[Reading]:
        """The same for `async for`."""
        seconds = None if seconds is None else _time("seconds", seconds)
        line = self._bus._line
        reader = line.begin_reading(self._motors)
        try:
            begun = time.monotonic()
            while (left := _left(begun, seconds)) > 0:
                wait = min(left, _STEP_S)
                for reading in await asyncio.to_thread(line.take_readings, reader, wait):
                    yield reading
        finally:
            line.end_reading(reader)

    def collect(self, seconds: float) -> Any:
        """The readings of so many seconds as a dict of numpy arrays by name. What was not told is NaN. Needs numpy."""
        import numpy

        names = ("time_s", "motor", "speed_rpm", "current_a", "angle_deg", "temperature_c")
        readings = list(self.readings(seconds))
        return {
            name: numpy.array([getattr(reading, name) for reading in readings], dtype=float)
            for name in names
        }

    def run(self, sequence: str | dict[str, Any], *, rate_hz: int = 200) -> Run:
        """Runs a sequence or a study: its JSON text, or the same as a dict. The wheels turn."""
        try:
            text = sequence if isinstance(sequence, str) else json.dumps(sequence)
        except (TypeError, ValueError) as error:
            raise InvalidInput(f"sequence: {error}") from None
        return self._run(text, rate_hz)

    def _run(self, asked: Any, rate_hz: int) -> Run:
        if not 1 <= _index("rate_hz", rate_hz) <= 500:
            raise InvalidInput(f"rate_hz: expected 1 to 500, not {rate_hz!r}")
        aborted, figures, whole, csv = self._bus._line.run(asked, self._motors, rate_hz)
        return Run(aborted, json.loads(figures)["figures"], whole, csv)


class Motor(Group):
    """One motor."""

    @property
    def id(self) -> int:
        """The ID."""
        return self.ids[0]

    @property
    def reading(self) -> Reading | None:
        """Its last reading; None if it has not replied for half a second."""
        return self._bus._line.latest(self._motors[0])

    def step(self, *, rate_hz: int = 200, **parameters: float | Sequence[float]) -> Run:
        """Measures the step response, such as `step(to_rpm=120, repeats=3)`. The wheel turns."""
        return self._study("step_response", rate_hz, parameters)

    def sweep(self, *, rate_hz: int = 200, **parameters: float) -> Run:
        """Measures the frequency response, such as `sweep(highest_hz=10, points=11)`. The wheel turns."""
        return self._study("frequency_response", rate_hz, parameters)

    def characterise(self, study: str, *, rate_hz: int = 200, **parameters: float) -> Run:
        """Measures friction, coast_down, heating, torque_speed or when_frames_cease. The wheel turns."""
        return self._study(study, rate_hz, parameters)

    def _study(self, name: str, rate_hz: int, parameters: dict[str, Any]) -> Run:
        def values(key: str, value: Any) -> list[float]:
            several = isinstance(value, (list, tuple))
            return [_number(key, one) for one in (value if several else [value])]

        given = [(key, values(key, value)) for key, value in parameters.items()]
        return self._run((str(name), given), rate_hz)


class Bus:
    """An open line of motors. Use it in a `with` or `async with` block, which stops the motors at its end."""

    def __init__(self, line: _motorlink.Line, settings: dict[str, Any]) -> None:
        self._line = line
        #: Setpoints a second, ramp, limits: see `limits`.
        self._settings = settings
        #: What the last stop has shown; None before one.
        self.last_stop: Stop | None = None

    def __enter__(self) -> Bus:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    async def __aenter__(self) -> Bus:
        return self

    async def __aexit__(self, *_: object) -> None:
        await asyncio.to_thread(self.close)

    @property
    def model(self) -> str:
        """The model of the motors, such as ddsm115."""
        return self._line.model()

    def motor(self, id: int | None = None, *, mirrored: bool = False) -> Motor:
        """The motor with this ID, once it has answered; without an ID, the only one that answers."""
        motor = (self._line.only_motor() if id is None else _whole("id", id), bool(mirrored))
        self._line.watch(motor)
        return Motor(self, [motor])

    def group(self, *ids: int) -> Group:
        """Motors that are driven together, such as `group(1, -2)`: a minus mirrors one."""
        if not ids:
            raise InvalidInput("group: name the IDs of its motors, such as group(1, -2)")
        numbers = [_index("id", id) for id in ids]
        motors = [(_whole("id", abs(number)), number < 0) for number in numbers]
        for motor in motors:
            self._line.watch(motor)
        return Group(self, motors)

    def stop(self) -> Stop:
        """Stops all motors until each reports standstill. None is driven again before `release`."""
        return self._stopped(self._line.stop(None), [])

    def release(self) -> None:
        """Allows driving again after `stop`, or after the bus has stopped all motors by itself."""
        self._line.release()

    def sleep(self, seconds: float) -> None:
        """Waits while the motors are driven on. Raises NotDone if the drive ends by itself."""
        self._line.wait(_time("seconds", seconds))

    def limits(
        self,
        *,
        rpm: int | None = None,
        amps: float | None = None,
        celsius: int | None = None,
        ramp_rpm_s: int | None = None,
        rate_hz: int | None = None,
    ) -> None:
        """Sets limits: a driven motor that exceeds one is stopped. What is not given stays as it is; at first 330 rpm, 2.7 A
        and 75 deg C. `ramp_rpm_s` is how fast a commanded speed may grow (0: no ramp), and `rate_hz` the setpoints a second
        to each motor, 1 to 500.
        """
        given = locals()
        changed = {name: given[name] for name in self._settings if given[name] is not None}
        settings = self._settings | changed
        self._line.configure(_settings(settings))
        self._settings = settings

    def scan(self) -> list[int]:
        """The IDs that answer: every ID is asked, in two seconds. Driven motors are stopped first."""
        return self._line.scan()

    def set_id(self, new: int) -> int:
        """Gives the only motor on the bus another ID, which it keeps without power, and verifies it. Returns the ID before."""
        return self._line.set_id(_whole("new", new))

    def record(self, file: str | os.PathLike[str] | None) -> None:
        """Records the line to a session file (.mcap), which the page replays, until the end; None ends it before."""
        self._line.record(_path("file", file))

    def notes(self) -> list[str]:
        """What a person should know, since the last call."""
        return self._line.take_notes()

    def close(self) -> None:
        """Stops the motors, waits until they stand, and closes the line. Raises NotDone if one may turn."""
        stopped, may_turn, wrong = self._line.close()
        if stopped or may_turn:
            self.last_stop = Stop([motor for motor, stands in stopped if stands], may_turn)
        if may_turn:
            ids = ", ".join(map(str, may_turn))
            wrong = f"motors {ids} may turn: cut their power" + (f" ({wrong})" if wrong else "")
        if wrong:
            raise NotDone(wrong)

    def _stopped(self, told: list[tuple[int, bool]], asked: list[int]) -> Stop:
        confirmed = [motor for motor, stands in told if stands]
        others = [motor for motor, stands in told if not stands]
        others += [motor for motor in asked if motor not in confirmed and motor not in others]
        self.last_stop = Stop(confirmed, others)
        return self.last_stop


_builtin_open = open

#: Every bus that is open, so that the end of the program stops its motors.
_buses: weakref.WeakSet[Bus] = weakref.WeakSet()

#: Signals that end or suspend a program. Ctrl-C raises KeyboardInterrupt.
_SIGNALS = [
    getattr(signal, name)
    for name in ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGTSTP")
    if hasattr(signal, name)
]


def _close_all() -> None:
    for bus in list(_buses):
        try:
            bus.close()
        except Error as error:
            print(f"motorlink: {error}", file=sys.stderr)


def _end(number: int, _: object) -> None:
    """Stops the motors before a signal does what it does by itself."""
    _close_all()
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)


def _forget_all() -> None:
    """In the child of a fork: the line is the parent's."""
    for bus in list(_buses):
        bus._line.forget()
    _buses.clear()


def _opened(
    port: str | None,
    model: str | None,
    ids: list[int] | None,
    rate_hz: int,
    keepalive: bool,
    timeout: float,
) -> Bus:
    first = {"rpm": 330, "amps": 2.7, "celsius": 75, "ramp_rpm_s": 0, "rate_hz": rate_hz}
    settings, timeout = _settings(first), _time("timeout", timeout)
    if threading.current_thread() is threading.main_thread():
        for number in _SIGNALS:
            # A program that handles it itself closes the bus itself.
            if signal.getsignal(number) == signal.SIG_DFL:
                signal.signal(number, _end)
    motors = [(id, False) for id in ids or []]
    port, model = _path("port", port), None if model is None else str(model)
    line = _motorlink.Line.open(port, model, motors, ids, bool(keepalive), settings, timeout)
    bus = Bus(line, first)
    _buses.add(bus)
    return bus


def _settings(of: dict[str, Any]) -> tuple[int, int | None, tuple[int, float, int]]:
    rate, ramp, rpm, celsius = (
        _whole(name, of[name], 65_535) for name in ("rate_hz", "ramp_rpm_s", "rpm", "celsius")
    )
    return rate, ramp or None, (rpm, _number("amps", of["amps"]), celsius)


atexit.register(_close_all)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_all)


def open(  # noqa: A001: the name that one expects
    port: str | None = None,
    *,
    model: str | None = None,
    rate_hz: int = 50,
    keepalive: bool = True,
    timeout: float = 1.0,
) -> Bus:
    """Opens a serial port, or the only USB adapter. What an earlier program left running is stopped first.

    `model` is ddsm115, ddsm315, ddsm210, ddsm400 or the maker's name; without it, the replies tell it. `rate_hz` is the
    setpoints a second to each motor, 1 to 500. With `keepalive`, a program that does not call the bus for a second has its
    motors stopped. `timeout` is the time for the first reply of a motor, in seconds.
    """
    return _opened(port, model, None, rate_hz, keepalive, timeout)


def virtual(
    ids: Sequence[int] = (1,),
    *,
    model: str = "ddsm115",
    rate_hz: int = 50,
    keepalive: bool = True,
) -> Bus:
    """Virtual motors in this process, without hardware."""
    if not isinstance(ids, Iterable) or not (motors := [_whole("ids", id) for id in ids]):
        raise InvalidInput(f"ids: expected the IDs of the motors, such as [1, 2], not {ids!r}")
    return _opened(None, model, motors, rate_hz, keepalive, 1.0)


def command() -> None:
    """The command `motorlink`."""
    sys.exit(_motorlink.command(sys.argv))


def _left(begun: float, seconds: float | None) -> float:
    return _STEP_S if seconds is None else seconds - (time.monotonic() - begun)
