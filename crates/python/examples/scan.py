"""Which motors are on the bus: python scan.py /dev/ttyUSB0"""

import sys

import motorlink

with motorlink.open(sys.argv[1]) as bus:
    for motor in bus.scan():
        print(f"0x{motor:02X}", bus.motor(motor).reading)
