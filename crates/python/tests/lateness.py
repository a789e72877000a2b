"""How late drive frames are at 200 Hz while the interpreter is busy, beside the native command. After
`cargo xtask test --only python-package`:

    PYTHONPATH=target/python-package/installed MOTORLINK=target/debug/motorlink python3 crates/python/tests/lateness.py
"""

import os
import signal
import subprocess
import sys
import tempfile

SECONDS = 10
BUSY = f"""
import motorlink, sys, time
with motorlink.open(sys.argv[1], rate_hz=200, keepalive=False) as bus:
    bus.motor(1).drive(rpm=100)
    until = time.monotonic() + {SECONDS}
    count = 0
    while time.monotonic() < until:
        count += sum(range(100))
"""


def p99_late_ms(command):
    """The 99th percentile of how much later than 5 ms after the one before a drive frame is, in ms."""
    with tempfile.TemporaryDirectory() as folder:
        port, log = os.path.join(folder, "port"), os.path.join(folder, "log")
        motors = [os.environ["MOTORLINK"], "virtual", "--link", port, "--log", log]
        with subprocess.Popen(
            motors, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as program:
            program.stdout.readline()
            environment = {**os.environ, "XDG_STATE_HOME": folder}
            subprocess.run(command(port), env=environment, check=True, capture_output=True)
            program.send_signal(signal.SIGTERM)
        rows = [line.rstrip().split("\t") for line in open(log)]
        at = [int(row[0]) for row in rows if row[1] == "HOST" and row[2].startswith("01 64 03 E8")]
        at = at or [int(row[0]) for row in rows if row[1] == "HOST" and row[2].startswith("01 64 00 64")]
        late = sorted((two - one) / 1000 - 5 for one, two in zip(at, at[1:]))
        return len(at), late[len(late) * 99 // 100]


def native(port):
    line = ["--id", "1", "--port", port, "drive", "velocity", "100", "--rate", "200"]
    return [os.environ["MOTORLINK"], *line, "--secs", str(SECONDS)]


for _ in range(3):
    for name, command in [("native", native), ("python", lambda port: [sys.executable, "-c", BUSY, port])]:
        frames, late = p99_late_ms(command)
        print(f"{name}: {frames} frames, p99 {late:.2f} ms late")
