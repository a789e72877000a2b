"""Figures of steps and sines, computed without MotorLink's code: by numpy and python-control.

figures.py systems             prints known_systems.csv: step responses of known systems, by python-control
figures.py compare RUN FIGURES computes the figures of an exported run (CSV) and compares them with the exported
                               figures of the page (CSV)
"""

import csv
import math
import sys

import control
import numpy as np

# name, numerator, denominator, setpoint before, setpoint, seconds, replies a second
SYSTEMS = [
    # python-control issue 554: it answers at once, and the first value must not be subtracted.
    ("third order", (0.6287, 37.74, 774.4, 5797, 7515), (1.629, 45.74, 788.4, 5809, 7515), 0, 100, 2, 1000),
    # python-control issue 337: it begins in the wrong direction and ends at -1.40103.
    ("non-minimum phase", (3.32, 0, -162.8), (1, 24.56, 186.5, 457.8, 116.2), 0, 100, 40, 200),
    ("damping 0.2", (25,), (1, 2, 25), 0, 100, 12, 200),
    ("down", (64,), (1, 8, 64), 120, 20, 5, 200),
    ("to a negative value", (1,), (0.003, 0.17, 1), 0, -80, 3, 200),
    ("through zero", (144,), (1, 16.8, 144), -100, 100, 3, 500),
]
COLUMNS = "name,above,below,from,to,for_s,hz,steady,rise_s,overshoot,wrong_way,settling_s,peak,peak_s"


def systems():
    print(COLUMNS)
    for name, above, below, start, end, for_s, hz in SYSTEMS:
        times = np.linspace(0, for_s, 100_001)
        system = control.tf(above, below)
        found = control.step_info(system, T=times)
        _, answer = control.step_response(system, T=times)
        final = found["SteadyStateValue"]
        figures = [
            start + (end - start) * final,
            found["RiseTime"],
            found["Overshoot"] / 100,
            found["Undershoot"] / 100,
            found["SettlingTime"],
            start + (end - start) * (answer.max() if final > 0 else answer.min()),
            found["PeakTime"],
        ]
        texts = [" ".join(map(str, above)), " ".join(map(str, below))]
        print(",".join([name, *texts, *map(str, (start, end, for_s, hz)), *(f"{one:.5f}" for one in figures)]))


# Baud of each model; a frame has 100 bits.
BAUD = {"DDSM115": 115_200, "DDSM315": 115_200, "DDSM210": 115_200, "DDSM400": 38_400}
# docs/experiments.md, Figures
RESOLUTION_RPM = 1
TREND = 0.0005


def read_run(path, motor, model):
    """Replies and setpoints with the times at the motor."""
    airtime_s = 100 / BAUD[model]
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["motor"] == motor]
    told = [row for row in rows if row["speed_rpm"]]
    replies = np.array([(float(row["time"]) - airtime_s, float(row["speed_rpm"])) for row in told])
    amps = np.array([(float(row["time"]) - airtime_s, float(row["current_a"])) for row in told])
    sent = {float(row["sent"]) + airtime_s: float(row["setpoint"]) for row in rows if row["sent"]}
    return replies, amps, np.array(sorted(sent.items()))


def between(points, from_s, to_s):
    return points[(points[:, 0] >= from_s) & (points[:, 0] < to_s)]


def middles(points):
    """Where the report changes, the speed is in the middle; beside that, the ends."""
    differ = np.flatnonzero(np.diff(points[:, 1]))
    return np.vstack([points[:1], (points[differ] + points[differ + 1]) / 2, points[-1:]])


def reaches(points, level):
    place = int(np.argmax(points[:, 1] >= level))
    if points[place, 1] < level:
        return None
    if place == 0:
        return points[0, 0]
    return np.interp(level, points[place - 1 : place + 1, 1], points[place - 1 : place + 1, 0])


def top_of(points):
    """The top of a parabola through the replies round the highest one."""
    highest = points[:, 1].max()
    first = int(np.argmax(points[:, 1]))
    last = first
    while last + 1 < len(points) and points[last + 1, 1] == highest:
        last += 1
    at = (points[first, 0] + points[last, 0]) / 2
    half = (at - reaches(points, 0.9 * highest)) / 4
    near = points[abs(points[:, 0] - at) <= half]
    if len(near) < 4:
        return at, highest
    bend, slope, level = np.polyfit(near[:, 0] - at, near[:, 1], 2)
    turn = -slope / (2 * bend)
    if bend < 0 and abs(turn) <= half:
        return at + turn, np.polyval([bend, slope, level], turn)
    return at, level


def step_figures(replies, amps, at_s, to_s, start, end):
    response = between(replies, at_s, to_s)
    last_s = response[-1, 0]
    tail = response[response[:, 0] >= last_s - (last_s - at_s) / 4]
    steady = tail[:, 1].mean()
    trend = abs(np.polyfit(tail[:, 0] - last_s, tail[:, 1], 1)[0]) * (last_s - at_s) / 4
    edges_s = np.linspace(last_s - (last_s - at_s) / 4, last_s, 4)
    edges_s[3] += 1
    thirds = [between(tail, *edges)[:, 1].mean() for edges in zip(edges_s, edges_s[1:])]
    way = steady - start
    response = np.vstack([[at_s, start], response])
    known = middles(response)
    band = max(0.02 * abs(way), RESOLUTION_RPM)
    outside = int(np.flatnonzero(abs(known[:, 1] - steady) > band)[-1])
    inward = known[outside : outside + 2]
    edge = steady + band * np.sign(known[outside, 1] - steady)
    order = inward[:, 1].argsort()
    enters = np.interp(edge, inward[order, 1], inward[order, 0]) if len(inward) == 2 else last_s
    settled = (
        max(trend, np.ptp(thirds)) <= max(TREND * abs(way), RESOLUTION_RPM)
        and trend + RESOLUTION_RPM <= 0.2 * abs(way)
        and enters < last_s - (last_s - at_s) / 4
    )
    scale = way if settled else end - start
    parts = lambda points, by: np.column_stack([points[:, 0], (points[:, 1] - start) / by])
    roots = parts(known, scale)
    roots[:, 1] = np.sign(roots[:, 1]) * np.sqrt(abs(roots[:, 1]))
    begins = reaches(roots, math.sqrt(0.01 * abs((end - start) / scale)))
    peak_s, peak = top_of(parts(response, scale))
    figures = {
        "settled": "true" if settled else "false",
        "latency_s": begins - at_s,
        "peak_rpm": start + scale * peak,
        "peak_s": peak_s - at_s,
        "peak_a": abs(between(amps, at_s, to_s)[:, 1]).max(),
    }
    if not settled:
        return figures
    shown = max(TREND, RESOLUTION_RPM / abs(way) / 2)
    wrong = top_of(parts(response, -way))[1]
    of_way = parts(known, way)
    figures["rise_s"] = reaches(of_way, 0.9) - reaches(of_way, 0.1)
    figures["overshoot"] = peak - 1 if peak - 1 > shown else 0
    figures["undershoot"] = wrong if wrong > shown else 0
    figures["settling_s"] = enters - at_s
    figures["steady_error_rpm"] = end - steady
    if peak - 1 <= shown:
        figures["peak_rpm"] = steady
        del figures["peak_s"]
    return figures


def sine_figures(replies, sent, hz, from_s, to_s):
    omega = 2 * math.pi * hz
    starts = np.clip(sent[:, 0], from_s, to_s)
    ends = np.append(starts[1:], to_s)
    asked = np.exp(-1j * omega * (starts - from_s)) - np.exp(-1j * omega * (ends - from_s))
    asked = (sent[:, 1] * asked).sum() / (1j * omega) * 2 / (to_s - from_s)
    answer = between(replies, from_s, to_s)
    times, values = answer[:, 0] - from_s, answer[:, 1]
    ones = np.ones_like(times)
    columns = np.column_stack([np.cos(omega * times), np.sin(omega * times), ones, times])
    found = np.linalg.lstsq(columns, values, rcond=None)[0]
    rest = ((columns @ found - values) ** 2).sum()
    line = columns[:, 2:]
    whole = ((line @ np.linalg.lstsq(line, values, rcond=None)[0] - values) ** 2).sum()
    ratio = (found[0] - 1j * found[1]) / asked
    return {
        "gain_db": 20 * math.log10(abs(ratio)),
        "phase_deg": math.degrees(np.angle(ratio)),
        "r_squared": 1 - rest / whole,
    }


# How far a figure may be off. The run as CSV has milliamps, and no setpoint whose reply was lost.
OFF = {"peak_a": 5e-4, "gain_db": 0.03, "phase_deg": 0.3, "r_squared": 1e-4}


def compare(run, figures):
    with open(figures, newline="") as file:
        rows = list(csv.DictReader(file))
    compared = 0
    for row in rows:
        replies, amps, sent = read_run(run, row["motor"], row["model"])
        from_s = float(row.get("at_s") or row["from_s"])
        to_s = float(row["to_s"])
        if "hz" in row:
            if row["valid"] != "true":
                continue
            found = sine_figures(replies, sent, float(row["hz"]), from_s, to_s)
            # The script does not count turns.
            found["phase_deg"] += 360 * round((float(row["phase_deg"]) - found["phase_deg"]) / 360)
        else:
            assert abs(sent[:, 0] - from_s).min() < 1e-5, f"no setpoint at {from_s}"
            found = step_figures(replies, amps, from_s, to_s, float(row["from_rpm"]), float(row["to_rpm"]))
        for name in ["latency_s", "rise_s", "overshoot", "undershoot", "settling_s", "steady_error_rpm", "peak_rpm",
                     "peak_s", "peak_a", "settled", "gain_db", "phase_deg", "r_squared"]:
            if name not in row:
                continue
            own, other = found.get(name, ""), row[name]
            where = f"{name} at {from_s}: {own} here, {other} on the page"
            if own == "" or other == "" or name == "settled":
                assert own == other, where
                continue
            assert abs(own - float(other)) <= OFF.get(name, 1e-4), where
            compared += 1
    print(compared)


if sys.argv[1] == "systems":
    systems()
else:
    compare(*sys.argv[2:])
