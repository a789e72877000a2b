"""Shows what a motor reports, and writes it to a CSV file: python monitor.py /dev/ttyUSB0 motor_log.csv [SECONDS]"""

import csv
import sys

import motorlink

NAMES = ["time_s", "motor", "mode", "speed_rpm", "current_a", "angle_deg", "temperature_c", "faults"]

with motorlink.open(sys.argv[1]) as bus, open(sys.argv[2], "w", newline="") as file:
    rows = csv.writer(file)
    rows.writerow(NAMES)
    for reading in bus.motor().readings(float(sys.argv[3]) if sys.argv[3:] else None):
        rows.writerow([getattr(reading, name) for name in NAMES])
        print(f"\r{reading} {reading.faults or 'OK'}", end="", flush=True)
