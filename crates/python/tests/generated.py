"""Two ___ wheels: motor 1 from 0 to 80 rpm, motor 2 from 0 to 80 rpm, for at most 0.9 s.

Needs the Python package motorlink. If the cable or the computer fails, the wheel may keep turning. Only the power switch
stops it then.
"""

import motorlink

SEQUENCE = r"""{ "motorlink_sequence": 1, "name": "Two \"\"\" wheels", "limits": { "rpm": 200 }, "steps": [ {
"shape": "ramp", "rpm": 60, "for_s": 0.4 }, { "repeat": 2, "steps": [ { "shape": "sine", "rpm": 60,
"amplitude": 20, "hz": 4, "for_s": 0.25 } ] } ] }"""

with motorlink.open("/dev/ttyUSB0") as bus:
    motors = bus.group(1, -2)
    print("motor 1 from 0 to 80 rpm, motor 2 from 0 to 80 rpm, for at most 0.9 s. Keep clear of the wheels.")
    if input("Start? [y/N] ") == "y":
        run = motors.run(SEQUENCE)
        print(run.aborted or "finished", run.figures)
        run.save(".")
print(bus.last_stop)
