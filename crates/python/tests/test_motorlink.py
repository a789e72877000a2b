"""The package against virtual motors: in this process, and on a pseudo-terminal, where the wheel's own state is known.

MOTORLINK names the command `motorlink`. `cargo xtask test --only python-package` runs this.
"""

import asyncio
import ctypes
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import motorlink
import numpy

EXAMPLES = Path(__file__).parent.parent / "examples"


class Motors:
    """Virtual motors on a pseudo-terminal. They keep their last command when frames cease."""

    def __init__(self, *flags):
        self.folder = tempfile.TemporaryDirectory()
        self.port = os.path.join(self.folder.name, "port")
        command = [os.environ["MOTORLINK"], "virtual", "--link", self.port, *flags]
        self.program = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        assert self.program.stdout.readline().startswith("ready")
        os.environ["XDG_STATE_HOME"] = self.folder.name

    def rpm(self, motor=1):
        self.program.stdin.write(f"state {motor}\n")
        return float(self.program.stdout.readline().split("rpm=")[1].split()[0])

    def until(self, is_so, what):
        until = time.monotonic() + 20
        while not is_so(self.rpm()):
            assert time.monotonic() < until, what
            time.sleep(0.02)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.program.terminate()
        self.program.communicate(timeout=10)
        self.folder.cleanup()


class OnVirtualMotors(unittest.TestCase):
    def test_a_drive_has_readings_and_its_end_stops_and_confirms(self):
        with motorlink.virtual(ids=[1, 2]) as bus:
            wheel = bus.motor(1)
            wheel.drive(rpm=100)
            readings = list(wheel.readings(seconds=2))
        last = readings[-1]
        self.assertAlmostEqual(last.speed_rpm, 100, delta=3)
        self.assertIsNotNone(last.current_a)
        self.assertIsNotNone(last.temperature_c)
        self.assertEqual({reading.motor for reading in readings}, {1})
        self.assertGreater(len(readings), 60)
        self.assertEqual(bus.last_stop, motorlink.Stop([1], []))

    def test_a_mirrored_pair_has_one_sign_and_a_second_drive_changes_the_speed(self):
        with motorlink.virtual(ids=[1, 2]) as bus:
            pair = bus.group(1, -2)
            pair.drive(rpm=60)
            pair.drive(rpm=90)
            bus.sleep(1)
            speeds = {reading.motor: reading for reading in pair.readings(0.5)}
            self.assertAlmostEqual(speeds[1].speed_rpm, 90, delta=3)
            self.assertAlmostEqual(speeds[2].speed_rpm, 90, delta=3)
            self.assertGreater(speeds[1].current_raw, 0)
            self.assertLess(speeds[2].current_raw, 0)
            stop = pair.stop()
            self.assertTrue(stop)
            self.assertEqual(sorted(stop.confirmed), [1, 2])

    def test_a_turning_wheel_is_stopped_and_switched_to_another_loop(self):
        with motorlink.virtual() as bus:
            wheel = bus.motor()
            wheel.drive(rpm=100)
            bus.sleep(0.5)
            wheel.drive(degrees=90)
            bus.sleep(2)
            self.assertAlmostEqual(wheel.reading.angle_deg, 90, delta=2)
            wheel.drive(amps=0.3)
            self.assertEqual(next(wheel.readings(1)).mode, "current loop")

    def test_a_turning_group_is_stopped_and_switched_to_another_loop(self):
        with motorlink.virtual(ids=[1, 2]) as bus:
            pair = bus.group(1, -2)
            pair.drive(rpm=60)
            bus.sleep(0.5)
            pair.drive(amps=0.1)
            readings = {reading.motor: reading for reading in pair.readings(0.3)}
            self.assertEqual({reading.mode for reading in readings.values()}, {"current loop"})
            pair.drive(degrees=90)
            bus.sleep(2)
            readings = {reading.motor: reading for reading in pair.readings(0.3)}
            self.assertAlmostEqual(readings[1].angle_deg, 90, delta=2)

    def test_a_stop_of_another_thread_ends_the_switch_of_a_group(self):
        with motorlink.virtual(ids=[1, 2], keepalive=False) as bus:
            pair = bus.group(1, -2)
            pair.drive(rpm=60)
            bus.sleep(0.5)
            raised = []

            def drive():
                try:
                    pair.drive(amps=0.1)
                except motorlink.NotDone as error:
                    raised.append(str(error))

            thread = threading.Thread(target=drive)
            thread.start()
            time.sleep(0.1)
            bus.motor(1).stop()
            thread.join()
            self.assertEqual(len(raised), 1, raised)
            bus.sleep(0.5)
            speeds = [abs(reading.speed_rpm) for reading in pair.readings(0.3)]
            self.assertLess(max(speeds), 1)

    def test_values_out_of_range_say_what_is_allowed_and_drive_nothing(self):
        with motorlink.virtual() as bus:
            wheel = bus.motor(1)
            for asked, says in [
                ({"rpm": 900}, "-380 to 380"),
                ({"amps": 9}, "-8 to 8 A"),
                ({"amps": 7}, "high_current=True"),
                ({"degrees": 400}, "0 to 360"),
                ({}, "give one of"),
                ({"rpm": 1, "amps": 1}, "give one of"),
            ]:
                with self.assertRaisesRegex(motorlink.InvalidInput, says):
                    wheel.drive(**asked)
            with self.assertRaisesRegex(motorlink.NotDone, "0x09"):
                bus.motor(9)
            self.assertIsNone(bus.last_stop)
        with self.assertRaisesRegex(motorlink.NotDone, "closed"):
            wheel.drive(rpm=10)

    def test_experiments_have_figures_and_data(self):
        with motorlink.virtual() as bus, tempfile.TemporaryDirectory() as folder:
            run = bus.motor(1).step(to_rpm=80, repeats=1, hold_s=1, rest_s=0.5)
            self.assertIsNone(run.aborted)
            self.assertTrue(0.05 < run.figures[0]["rise_s"] < 0.5, run.figures)
            run.save(folder)
            self.assertEqual({Path(name).suffix for name in os.listdir(folder)}, {".json", ".csv"})
            steps = [{"rpm": 60, "for_s": 0.5}]
            run = bus.motor(1).run({"motorlink_sequence": 1, "steps": steps})
            self.assertEqual(run.figures[0]["motor"], 1)
            with self.assertRaisesRegex(motorlink.InvalidInput, "to_rpm: 900 is above 330"):
                bus.motor(1).step(to_rpm=900)

    def test_readings_come_as_arrays_and_in_an_event_loop(self):
        async def drive():
            async with motorlink.virtual(rate_hz=200) as bus:
                wheel = bus.motor(1)
                wheel.drive(rpm=100)
                ticks = 0

                async def tick():
                    nonlocal ticks
                    while True:
                        await asyncio.sleep(0.01)
                        ticks += 1

                task = asyncio.create_task(tick())
                count = len([reading async for reading in wheel.readings_async(1)])
                task.cancel()
                arrays = await asyncio.to_thread(wheel.collect, 0.5)
                return count, ticks, arrays

        count, ticks, arrays = asyncio.run(drive())
        self.assertGreater(count, 150)
        self.assertGreater(ticks, 50)
        self.assertTrue(numpy.all(numpy.diff(arrays["time_s"]) > 0))
        self.assertAlmostEqual(numpy.nanmean(arrays["speed_rpm"][-20:]), 100, delta=3)

    def test_a_run_goes_on_beside_a_thread_that_reads_and_a_second_one_has_its_own_result(self):
        with motorlink.virtual(ids=[1, 2], keepalive=False) as bus:
            wheel = bus.motor(1)
            reading = threading.Thread(target=lambda: list(bus.motor(2).readings(3)))
            reading.start()
            runs = [wheel.step(to_rpm=rpm, repeats=1, hold_s=1, rest_s=0.5) for rpm in (60, 90)]
            reading.join()
            for run, rpm in zip(runs, (60, 90)):
                self.assertIsNone(run.aborted)
                self.assertAlmostEqual(run.figures[0]["peak_rpm"], rpm, delta=10)
            numbers = [json.loads(run.json)["number"] for run in runs]
            self.assertNotEqual(*numbers)

    def test_a_side_is_that_of_the_handle(self):
        with motorlink.virtual(ids=[1, 2]) as bus:
            pair, own = bus.group(1, -2), bus.motor(2)
            pair.drive(rpm=60)
            bus.sleep(1)
            self.assertLess(own.reading.speed_rpm, -50)
            by_pair = [one.speed_rpm for one in pair.readings(0.3) if one.motor == 2]
            self.assertGreater(by_pair[-1], 50)

    def test_after_a_stop_of_all_nothing_drives_before_the_release(self):
        with motorlink.virtual() as bus:
            wheel = bus.motor()
            wheel.drive(rpm=60)
            self.assertTrue(bus.stop())
            with self.assertRaisesRegex(motorlink.NotDone, "bus.release"):
                wheel.drive(rpm=60)
            bus.release()
            wheel.drive(rpm=60)

    def test_a_refused_change_of_speed_raises_in_its_own_call(self):
        with motorlink.virtual() as bus:
            bus.limits(rpm=120)
            bus.limits(celsius=60)
            wheel = bus.motor()
            wheel.drive(rpm=100)
            with self.assertRaisesRegex(motorlink.NotDone, "limit"):
                wheel.drive(rpm=200)
            wheel.drive(rpm=60)
            bus.sleep(1)
            self.assertAlmostEqual(wheel.reading.speed_rpm, 60, delta=3)

    def test_an_exceeded_limit_is_an_exception_with_its_figures(self):
        with motorlink.virtual() as bus:
            bus.limits(rpm=50)
            wheel = bus.motor(1)
            with self.assertRaisesRegex(motorlink.NotDone, "limit"):
                wheel.drive(rpm=100)


    def test_bad_input_is_an_exception_of_the_package_that_says_what_to_do(self):
        with motorlink.virtual(ids=[1, 2]) as bus:
            wheel = bus.motor(1)
            id, whole = "from 1 to 254", "expected a whole number, not"
            time, number = "expected 0 seconds to a year", "expected a number, not"
            cases = {
                "a large ID": (id, lambda: bus.motor(300)),
                "ID 0": ("1 to 254", lambda: bus.motor(0)),
                "a negative ID": (id, lambda: bus.motor(-1)),
                "a huge ID": (id, lambda: bus.motor(10**30)),
                "a text as ID": (whole, lambda: bus.motor("1")),
                "a fraction as ID": (whole, lambda: bus.motor(1.5)),
                "a group of none": ("name the IDs", lambda: bus.group()),
                "a text in a group": (whole, lambda: bus.group(1, "-2")),
                "a new ID": (id, lambda: bus.set_id(1000)),
                "a reserved ID": ("not allowed|200|0xC8", lambda: bus.set_id(200)),
                "virtual IDs": ("expected the IDs", lambda: motorlink.virtual(ids=5)),
                "no virtual IDs": ("expected the IDs", lambda: motorlink.virtual(ids=[])),
                "a large virtual ID": (id, lambda: motorlink.virtual(ids=[256])),
                "NaN rpm": (f"rpm: {number} nan", lambda: wheel.drive(rpm=math.nan)),
                "infinite amps": (f"amps: {number} inf", lambda: wheel.drive(amps=math.inf)),
                "a text as rpm": (f"rpm: {number} '60'", lambda: wheel.drive(rpm="60")),
                "huge rpm": (f"rpm: {number} 1", lambda: wheel.drive(rpm=10**400)),
                "much rpm": ("380", lambda: wheel.drive(rpm=1e30)),
                "acceleration": ("0 to 255", lambda: wheel.drive(rpm=1, acceleration=256)),
                "negative seconds": (time, lambda: bus.sleep(-1)),
                "NaN seconds": (number, lambda: bus.sleep(math.nan)),
                "endless seconds": (number, lambda: bus.sleep(math.inf)),
                "readings of the past": (time, lambda: next(wheel.readings(-1))),
                "arrays of the past": (time, lambda: wheel.collect(-1)),
                "a negative timeout": (time, lambda: motorlink.open("/dev/null", timeout=-1)),
                "a port that is a number": ("port: expected a path", lambda: motorlink.open(5)),
                "a model": ("no such model", lambda: motorlink.virtual(model=115)),
                "a rate": ("500", lambda: motorlink.virtual(rate_hz=100_000)),
                "a fraction as rate": (whole, lambda: motorlink.virtual(rate_hz=0.5)),
                "a negative limit": ("380", lambda: bus.limits(rpm=-1)),
                "a large limit": ("380", lambda: bus.limits(rpm=10**9)),
                "a NaN limit": (number, lambda: bus.limits(amps=math.nan)),
                "a negative ramp": ("10,000", lambda: bus.limits(ramp_rpm_s=-5)),
                "a recording": ("file: expected a path", lambda: bus.record(5)),
                "a NaN parameter": (f"to_rpm: {number} nan", lambda: wheel.step(to_rpm=math.nan)),
                "a text as parameter": (number, lambda: wheel.step(to_rpm="fast")),
                "a study": ("no such study", lambda: wheel.characterise(5)),
                "a sequence": ("sequence: ", lambda: wheel.run({"steps": {1, 2}})),
                "a rate of a run": ("500", lambda: wheel.step(rate_hz=10**6)),
            }
            for name, (says, call) in cases.items():
                with self.subTest(name):
                    with self.assertRaisesRegex(motorlink.InvalidInput, says) as raised:
                        call()
                    self.assertNotIn("\n", str(raised.exception))
            # They have changed nothing.
            wheel.drive(rpm=60)
            bus.sleep(1)
            self.assertAlmostEqual(wheel.reading.speed_rpm, 60, delta=3)

    def test_a_refusal_does_not_repeat_the_name_of_its_exception(self):
        with motorlink.virtual(ids=[1, 2], model="ddsm210") as bus:
            for motors in (bus.motor(1), bus.group(1, 2)):
                with self.assertRaisesRegex(motorlink.NotDone, "no current loop") as raised:
                    motors.drive(amps=0.1)
                self.assertNotIn("not done", str(raised.exception))


class OnASerialPort(unittest.TestCase):
    def test_a_frozen_interpreter_stops_the_wheel_and_says_so(self):
        def holds_the_interpreter():
            # Unlike ctypes.CDLL, this keeps the lock of the interpreter.
            ctypes.PyDLL(None).usleep(2_000_000)

        for freeze in (lambda: time.sleep(2), holds_the_interpreter):
            with Motors() as motors, motorlink.open(motors.port) as bus:
                wheel = bus.motor(1)
                wheel.drive(rpm=100)
                bus.sleep(0.7)
                freeze()
                self.assertLess(abs(motors.rpm()), 5)
                with self.assertRaisesRegex(motorlink.NotDone, "did not call motorlink for a second"):
                    wheel.drive(rpm=100)
                with self.assertRaisesRegex(motorlink.NotDone, "bus.release"):
                    wheel.drive(rpm=100)
                bus.release()
                wheel.drive(rpm=60)
                bus.sleep(1)
                self.assertAlmostEqual(motors.rpm(), 60, delta=5)

    def test_without_keepalive_a_sleeping_program_drives_on(self):
        with Motors() as motors, motorlink.open(motors.port, keepalive=False) as bus:
            wheel = bus.motor(1)
            wheel.drive(rpm=100)
            time.sleep(2)
            rpm = motors.rpm()
            # Where it does not turn, this raises the reason.
            wheel.drive(rpm=100)
            self.assertAlmostEqual(rpm, 100, delta=5)

    def test_every_end_of_a_program_stops_the_wheel(self):
        program = (
            "import motorlink, os, sys\n"
            "bus = motorlink.open(sys.argv[1], keepalive=False, timeout=30)\n"
            "bus.motor(1).drive(rpm=100)\n"
            "bus.sleep(0.7)\n"
            "print('drives', flush=True)\n"
        )
        ends = {
            "return": "",
            "exception": "raise RuntimeError\n",
            "exit": "sys.exit(3)\n",
            "Ctrl-C": "bus.sleep(60)\n",
            "SIGTERM": "bus.sleep(60)\n",
            "SIGQUIT": "bus.sleep(60)\n",
            "SIGTSTP": "bus.sleep(60)\n",
            "SIGHUP": "import time\ntime.sleep(60)\n",
            "freed": "del bus\nimport time\ntime.sleep(60)\n",
            "in a run, caught": (
                "import time\n"
                "wheel = bus.motor(1)\n"
                "wheel.stop()\n"
                "try:\n"
                "    wheel.run({'motorlink_sequence': 1, 'steps': [{'rpm': 60, 'for_s': 50}]})\n"
                "except KeyboardInterrupt:\n"
                "    time.sleep(60)\n"
            ),
        }
        for name, end in ends.items():
            with self.subTest(name), Motors() as motors:
                command = [sys.executable, "-c", program + end, motors.port]
                child = subprocess.Popen(
                    command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
                )
                self.assertEqual(child.stdout.readline(), "drives\n")
                if name == "in a run, caught":
                    time.sleep(3)
                    child.send_signal(signal.SIGINT)
                elif name == "Ctrl-C":
                    child.send_signal(signal.SIGINT)
                elif name.startswith("SIG"):
                    child.send_signal(getattr(signal, name))
                # The last one suspends the program.
                if name in ("freed", "in a run, caught", "SIGTSTP"):
                    motors.until(lambda rpm: abs(rpm) < 5, name)
                    child.kill()
                child.wait(10)
                child.stdout.close()
                self.assertLess(abs(motors.rpm()), 5, name)

    def test_ctrl_c_ends_a_long_wait(self):
        waits = {"scan": "bus.scan()", "first reply": "bus.motor(9)"}
        for name, wait in waits.items():
            program = (
                "import motorlink, sys\n"
                "bus = motorlink.open(sys.argv[1], timeout=30)\n"
                "print('waits', flush=True)\n"
                "try:\n"
                f"    {wait}\n"
                "except KeyboardInterrupt:\n"
                "    print(bus.motor(1).reading is not None, flush=True)\n"
            )
            with self.subTest(name), Motors() as motors:
                command = [sys.executable, "-c", program, motors.port]
                child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
                self.assertEqual(child.stdout.readline(), "waits\n")
                time.sleep(0.5)
                child.send_signal(signal.SIGINT)
                asked = time.monotonic()
                self.assertEqual(child.stdout.readline(), "True\n", name)
                self.assertLess(time.monotonic() - asked, 3, name)
                self.assertEqual(child.wait(10), 0)
                child.stdout.close()

    def test_a_signal_ends_a_long_wait_and_the_program(self):
        """Its handler closes the line for which the program waits."""
        program = (
            "import motorlink, sys\n"
            "bus = motorlink.open(sys.argv[1], timeout=30)\n"
            "bus.motor(1).drive(rpm=100)\n"
            "print('waits', flush=True)\n"
            "bus.motor(9)\n"
        )
        with Motors() as motors:
            command = [sys.executable, "-c", program, motors.port]
            child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
            self.assertEqual(child.stdout.readline(), "waits\n")
            time.sleep(0.5)
            child.send_signal(signal.SIGTERM)
            self.assertEqual(child.wait(5), -signal.SIGTERM)
            child.stdout.close()
            self.assertLess(abs(motors.rpm()), 5)

    def test_a_killed_program_is_stopped_by_the_next_one(self):
        program = "import motorlink, sys\nbus = motorlink.open(sys.argv[1], timeout=30)\nbus.motor(1).drive(rpm=100)\nbus.sleep(60)\n"
        with Motors() as motors:
            child = subprocess.Popen([sys.executable, "-c", program, motors.port])
            motors.until(lambda rpm: rpm > 90, "it drives")
            child.kill()
            child.wait()
            time.sleep(0.5)
            self.assertGreater(motors.rpm(), 90, "the motor keeps its last command")
            with motorlink.open(motors.port) as bus:
                self.assertLess(abs(motors.rpm()), 5)
                self.assertIn("earlier program", " ".join(bus.notes()))

    def test_a_port_that_is_gone_or_busy_is_named(self):
        with self.assertRaisesRegex(motorlink.NotDone, "/dev/ttyNone"):
            motorlink.open("/dev/ttyNone")
        with Motors() as motors, motorlink.open(motors.port):
            with self.assertRaisesRegex(motorlink.NotDone, "another program|use|busy"):
                motorlink.open(motors.port)

    def test_a_recording_is_a_session_with_its_replies(self):
        with Motors() as motors:
            file = os.path.join(motors.folder.name, "run.mcap")
            with motorlink.open(motors.port) as bus:
                bus.record(file)
                bus.motor(1).drive(rpm=60)
                bus.sleep(1)
            told = subprocess.run(
                [os.environ["MOTORLINK"], "session", "check", file], capture_output=True, text=True
            )
            self.assertEqual(told.returncode, 0, told)

    def test_another_thread_stops_a_wheel_that_is_read(self):
        with Motors() as motors, motorlink.open(motors.port) as bus:
            wheel = bus.motor(1)
            wheel.drive(rpm=100)
            stopper = threading.Timer(1, wheel.stop)
            stopper.start()
            last = list(wheel.readings(2.5))[-1]
            stopper.join()
            self.assertEqual(last.speed_rpm, 0)


class Examples(unittest.TestCase):
    """The four scripts of the article, rewritten."""

    def run_example(self, motors, name, *arguments, typed=""):
        file = EXAMPLES / name
        self.assertLessEqual(len(file.read_text().splitlines()), 20, name)
        command = [sys.executable, file, motors.port, *arguments]
        done = subprocess.run(command, input=typed, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done)
        return done.stdout

    def test_scan(self):
        with Motors("--ids", "1,7") as motors:
            told = self.run_example(motors, "scan.py")
            self.assertIn("0x01", told)
            self.assertIn("0x07", told)

    def test_set_id(self):
        with Motors() as motors:
            self.run_example(motors, "set_id.py", "5", typed="y\n")
            self.assertEqual(motors.rpm(5), 0)

    def test_monitor(self):
        with Motors() as motors:
            log = os.path.join(motors.folder.name, "log.csv")
            self.run_example(motors, "monitor.py", log, "1")
            rows = Path(log).read_text().splitlines()
            self.assertTrue(rows[0].startswith("time_s,motor"))
            self.assertGreater(len(rows), 5)

    def test_operate(self):
        with Motors() as motors:
            told = self.run_example(
                motors, "operate.py", typed="rpm 100\ninfo\nrpm fast\nstop\nquit\n"
            )
            self.assertIn("could not convert", told)
            self.assertIn("confirmed=[1]", told)


class TheGeneratedProgram(unittest.TestCase):
    """What the tab Code of the page writes: `crates/experiments/tests/python_program.rs` has the same text."""

    def test_it_asks_runs_its_sequence_and_stops_both_wheels(self):
        text = (Path(__file__).parent / "generated.py").read_text()
        for typed, says in [("n\n", "None"), ("y\n", "finished")]:
            with Motors("--ids", "1,2") as motors:
                program = os.path.join(motors.folder.name, "program.py")
                Path(program).write_text(text.replace("/dev/ttyUSB0", motors.port))
                command = [sys.executable, program]
                done = subprocess.run(
                    command, input=typed, capture_output=True, text=True, cwd=motors.folder.name
                )
                self.assertEqual(done.returncode, 0, done)
                self.assertIn(says, done.stdout)
                self.assertLess(abs(motors.rpm(1)) + abs(motors.rpm(2)), 5)


class TheCommand(unittest.TestCase):
    def test_a_signal_stops_what_it_drives(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number), Motors() as motors:
                command = [sys.executable, "-c", "import motorlink; motorlink.command()"]
                line = ["--port", motors.port, "--id", "1", "drive", "velocity", "100"]
                child = subprocess.Popen([*command, *line], stderr=subprocess.PIPE, text=True)
                motors.until(lambda rpm: rpm > 90, "it drives")
                child.send_signal(number)
                self.assertIn("stands, confirmed", child.communicate(timeout=10)[1])
                self.assertEqual(child.returncode, 0)
                self.assertLess(abs(motors.rpm()), 5)

    def test_the_package_brings_it(self):
        command = [sys.executable, "-c", "import motorlink; motorlink.command()"]
        told = subprocess.run(
            [*command, "--virtual", "info", "--json"], capture_output=True, text=True
        )
        self.assertEqual(told.returncode, 0, told)
        self.assertEqual(json.loads(told.stdout)[0]["mode"], "velocity")


if __name__ == "__main__":
    # A shell ignores them in what it starts in the background, and so would the programs that the tests start.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)
    unittest.main(verbosity=2)
