"""Drives a motor by typed commands: python operate.py /dev/ttyUSB0"""

import sys

import motorlink

with motorlink.open(sys.argv[1], keepalive=False) as bus:
    wheel = bus.motor()
    while (line := input("rpm 100 | amps 0.5 | degrees 90 | stop | info | quit: ").split()) != ["quit"]:
        try:
            match line:
                case ["rpm" | "amps" | "degrees" as loop, value]:
                    wheel.drive(**{loop: float(value)})
                case ["stop"]:
                    print(wheel.stop())
                case _:
                    print(wheel.reading)
        except (motorlink.Error, ValueError) as error:
            print(error)
