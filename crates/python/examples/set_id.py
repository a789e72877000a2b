"""Gives the only motor on the bus another ID: python set_id.py /dev/ttyUSB0 2"""

import sys

import motorlink

with motorlink.open(sys.argv[1]) as bus:
    new = int(sys.argv[2])
    if input(f"Give the only motor on the bus the ID {new}? [y/N] ") == "y":
        print("changed and verified; before:", bus.set_id(new))
