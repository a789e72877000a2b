import os

class Error(Exception): ...
class NotDone(Error): ...
class InvalidInput(Error): ...

class Reading:
    """What a motor reports at one moment. A value that the motor has not told is None."""

    @property
    def time_s(self) -> float:
        """Seconds since the line was opened."""
    @property
    def motor(self) -> int: ...
    @property
    def mode(self) -> str:
        """The loop it closes: open loop, current loop, velocity loop or position loop."""
    @property
    def speed_rpm(self) -> int | None:
        """Speed in rpm, with the sign of its side."""
    @property
    def current_a(self) -> float | None:
        """Torque current in A, with the sign of its side. None if its scale is not known."""
    @property
    def current_raw(self) -> int | None:
        """Torque current as the number in the reply, with the sign of the wire."""
    @property
    def angle_deg(self) -> float | None:
        """Angle in degrees, 0 to 360, as the motor counts it."""
    @property
    def temperature_c(self) -> int | None:
        """Temperature of the winding in deg C, at most two seconds old."""
    @property
    def faults(self) -> str:
        """Active faults; empty if there are none."""

_Settings = tuple[int, int | None, tuple[int, float, int]]

class Line:
    @staticmethod
    def open(
        port: str | None,
        model: str | None,
        ids: list[tuple[int, bool]],
        virtual_motors: list[int] | None,
        keepalive: bool,
        settings: _Settings,
        timeout_s: float,
    ) -> Line: ...
    def model(self) -> str: ...
    def watch(self, motor: tuple[int, bool]) -> None: ...
    def only_motor(self) -> int: ...
    def drive(
        self,
        motors: list[tuple[int, bool]],
        quantity: str,
        value: float,
        acceleration: int,
        high_current: bool,
    ) -> None: ...
    def stop(self, motors: list[int] | None) -> list[tuple[int, bool]]: ...
    def release(self) -> None: ...
    def configure(self, settings: _Settings) -> None: ...
    def scan(self) -> list[int]: ...
    def set_id(self, new: int) -> int: ...
    def record(self, file: str | os.PathLike[str] | None) -> None: ...
    def wait(self, seconds: float) -> None: ...
    def begin_reading(self, motors: list[int]) -> int: ...
    def take_readings(self, reader: int, seconds: float) -> list[Reading]: ...
    def end_reading(self, reader: int) -> None: ...
    def latest(self, motor: int) -> Reading | None: ...
    def take_notes(self) -> list[str]: ...
    def run(
        self,
        asked: str | tuple[str, list[tuple[str, list[float]]]],
        motors: list[tuple[int, bool]],
        rate_hz: int,
    ) -> tuple[str | None, str, str, str]: ...
    def close(self) -> tuple[list[tuple[int, bool]], list[int]]: ...

def command(arguments: list[str]) -> int: ...
