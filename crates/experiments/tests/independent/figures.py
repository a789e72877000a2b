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
from scipy.optimize import least_squares
from scipy.signal import residue

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


FITTED_MAX = 400


def lag_step(order, parameters, times):
    """By partial fractions: one exponential for each pole."""
    gain, dead_s, *lag = parameters
    below = [lag[0], 1] if order == "first" else [1 / lag[0] ** 2, 2 * lag[1] / lag[0], 1]
    parts, poles, _ = residue([1], [*below, 0])
    since = np.maximum(times - dead_s, 0)
    return gain * sum(part * np.exp(pole * since) for part, pole in zip(parts, poles)).real


def lag_response(order, parameters, omega):
    gain, dead_s, *lag = parameters
    s = 1j * omega
    below = lag[0] * s + 1 if order == "first" else (s / lag[0]) ** 2 + 2 * lag[1] * s / lag[0] + 1
    # The phase of a lag of first or second order does not pass -180 degrees.
    phase = -np.angle(below)
    return np.concatenate([np.log(abs(gain / below)), phase - omega * dead_s])


def fit(model, measured, starts):
    """The orders with their parameters and AICc, by scipy."""
    found = {}
    for order, parameters in starts:
        low = [-np.inf, 0] + [1e-4] * (len(parameters) - 2)
        one = least_squares(lambda it: model(order, it) - measured, parameters, bounds=(low, np.inf), xtol=1e-12,
                            ftol=1e-12, x_scale=np.maximum(np.abs(parameters), 0.01))
        if order not in found or one.cost < found[order].cost:
            found[order] = one
    rest = found["second"].fun
    similar = min(max((rest[1:] * rest[:-1]).sum() / (rest**2).sum(), 0), 0.99)
    independent = len(measured) * (1 - similar) / (1 + similar)

    def aicc(order):
        count = len(found[order].x) + 1
        variance = (found[order].fun ** 2).mean()
        return independent * math.log(variance) + 2 * count * (1 + (count + 1) / (independent - count - 1))

    order = min(found, key=aicc)
    return order, found[order].x, math.sqrt((found[order].fun ** 2).mean())


def fitted_figures(order, parameters, rms):
    gain, dead_s, *lag = parameters
    figures = {"fit_order": order, "fit_gain": gain, "fit_dead_s": dead_s, "fit_rms": rms}
    if order == "first":
        return figures | {"fit_time_s": lag[0]}
    return figures | {"fit_natural_hz": lag[0] / (2 * math.pi), "fit_damping": lag[1]}


def fitted_steps(rows, replies):
    """The model of the settled repeats of one acceleration."""
    repeats = []
    for row in rows:
        points = between(replies, float(row["at_s"]), float(row["to_s"]))
        start, end = float(row["from_rpm"]), float(row["to_rpm"])
        repeats.append(np.column_stack([points[:, 0] - float(row["at_s"]), (points[:, 1] - start) / (end - start)]))
    every = -(-sum(map(len, repeats)) // FITTED_MAX)
    points = np.vstack([repeat[::every] for repeat in repeats])
    starts = [("first", [1, 0.05, 0.2])] + [("second", [1, 0.02, 10, damping]) for damping in (0.3, 0.99, 2)]
    return fitted_figures(*fit(lambda order, it: lag_step(order, it, points[:, 0]), points[:, 1], starts))


def fitted_points(rows):
    valid = [row for row in rows if row["valid"] == "true"]
    omega = 2 * math.pi * np.array([float(row["hz"]) for row in valid])
    phases = np.array([row["turn_is_known"] == "true" for row in valid])
    ln = np.array([float(row["gain_db"]) for row in valid]) * math.log(10) / 20
    rad = np.radians([float(row["phase_deg"]) for row in valid])
    kept = np.concatenate([np.ones_like(phases), phases])
    # Gain and phase of a point follow each other, as on the page.
    order_of_rows = np.argsort(np.concatenate([np.arange(len(valid)) * 2, np.arange(len(valid)) * 2 + 1])[kept])
    rows_of = lambda both: both[kept][order_of_rows]
    starts = [("first", [1, 0.01, 0.1])] + [("second", [1, 0.01, 10, damping]) for damping in (0.3, 0.99, 2)]
    model = lambda order, it: rows_of(lag_response(order, it, omega))
    return fitted_figures(*fit(model, rows_of(np.concatenate([ln, rad])), starts))


def tracking_figures(path, motor, model):
    """Setpoint less report, with the setpoint that the motor had when it measured."""
    airtime_s = 100 / BAUD[model]
    column = {"rpm": "speed_rpm", "A": "current_a", "deg": "angle_deg"}
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["motor"] == motor]
    errors, times, before, now, unit = [], [], None, None, None
    for row in rows:
        if not row["sent"]:
            continue
        if now is None or row["sent"] != now["sent"]:
            before, now = now, row
        had = now if float(now["sent"]) + 2 * airtime_s <= float(row["time"]) + 1e-7 else before
        if had is None or had["setpoint_unit"] not in column:
            continue
        unit = unit or had["setpoint_unit"]
        if had["setpoint_unit"] == unit and row[column[unit]]:
            errors.append(float(had["setpoint"]) - float(row[column[unit]]))
            times.append(float(row["time"]) - airtime_s)
    errors = np.array(errors)
    if unit == "deg":
        errors = (errors + 180) % 360 - 180
    worst = int(np.argmax(abs(errors)))
    return {
        "setpoint_unit": unit,
        "replies": len(errors),
        "rms_error": math.sqrt((errors**2).mean()),
        "worst_error": errors[worst],
        "worst_s": times[worst],
    }


# How far a figure may be off. The run as CSV has milliamps, and no setpoint whose reply was lost.
OFF = {"peak_a": 5e-4, "gain_db": 0.03, "phase_deg": 0.3, "r_squared": 1e-4, "replies": 0}
# How far a value of a model may be off, as a part: two solvers end near the same least sum.
FIT_OFF = 0.005


def compare_fits(rows, replies):
    """The models of the steps of each acceleration, or of the points."""
    compared = 0
    groups = {row.get("acceleration"): [] for row in rows}
    for row in rows:
        if row.get("settled") != "false":
            groups[row.get("acceleration")].append(row)
    for group in groups.values():
        if not group or not group[0]["fit_order"]:
            continue
        found = fitted_steps(group, replies) if "at_s" in group[0] else fitted_points(group)
        for name, own in found.items():
            other = group[0][name]
            where = f"{name}: {own} here, {other} on the page"
            if name == "fit_order":
                assert own == other, where
                continue
            assert abs(own - float(other)) <= max(FIT_OFF * abs(own), 1e-4), where
            compared += 1
    return compared


def compare(run, figures):
    with open(figures, newline="") as file:
        rows = list(csv.DictReader(file))
    compared = 0
    for row in rows:
        if "rms_error" in row:
            for name, own in tracking_figures(run, row["motor"], row["model"]).items():
                where = f"{name}: {own} here, {row[name]} on the page"
                if name == "setpoint_unit":
                    assert own == row[name], where
                else:
                    assert abs(own - float(row[name])) <= OFF.get(name, 1e-4), where
                    compared += 1
            continue
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
    if "fit_order" in rows[0]:
        compared += compare_fits(rows, read_run(run, rows[0]["motor"], rows[0]["model"])[0])
    print(compared)


if sys.argv[1] == "systems":
    systems()
else:
    compare(*sys.argv[2:])
