"""Figures with intervals of an exported run, computed without MotorLink's code: by numpy and scipy.

intervals.py STUDY RUN   STUDY is the study as JSON, RUN the exported CSV file

Prints a line `value,plus_minus` for each figure, in the order of crates/experiments/tests/noisy_runs.
"""

import csv
import json
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

CONFIDENCE = 0.99
BATCHES = 15
TORQUE_NM_PER_A = 0.75
RAD_S_PER_RPM = 2 * np.pi / 60
RAW_A = 8 / 32767


def t_quantile(freedom):
    return student.ppf((1 + CONFIDENCE) / 2, freedom)


def ordinary(matrix, y):
    """Least squares with standard errors."""
    unknowns, *_ = np.linalg.lstsq(matrix, y, rcond=None)
    freedom = len(y) - matrix.shape[1]
    variance = np.sum((y - matrix @ unknowns) ** 2) / freedom
    errors = np.sqrt(np.diag(variance * np.linalg.inv(matrix.T @ matrix)))
    return unknowns, errors, freedom


def batched(values):
    """The values in batches of the same size, without the few behind the last one."""
    size = len(values) // BATCHES
    return values[: size * BATCHES].reshape(BATCHES, size, *values.shape[1:])


def of_batches(matrix, y, report, slope):
    """Least squares of batch means; each reported number adds the error of its rounding."""
    mean = batched(matrix).mean(axis=1)
    unknowns, errors, freedom = ordinary(mean, batched(y).mean(axis=1))
    size = len(y) // BATCHES
    turns = batched(slope(unknowns)) / size
    parts = np.linalg.pinv(mean)[:, :, None] * turns[None]
    levels = batched(report)
    variances = errors**2
    for level in np.unique(levels):
        variances = variances + parts[:, levels == level].sum(axis=1) ** 2 / 12
    return unknowns, np.sqrt(variances) * t_quantile(freedom)


def friction(study, run):
    speeds = study["speeds"]
    levels = []
    for step in [*range(int(speeds)), *range(int(speeds) + 1, 2 * int(speeds) + 1)]:
        rows = run[run["step"] == step]
        rows = rows[rows["time"] >= rows["time"][0] + study["hold_s"] / 2]
        levels.append((rows["rpm"].mean(), rows["amps"].mean()))
    rpm, amps = np.array(levels).T
    unknowns, errors, freedom = ordinary(np.c_[np.sign(rpm), rpm], amps)
    return zip(unknowns, errors * t_quantile(freedom))


def changes(rows, settle_s):
    """When the reported speed changed, and the speed halfway in rad/s."""
    rows = rows[rows["time"] >= rows["time"][0] + settle_s]
    slow = np.abs(rows["rpm"]) < 3
    rolls = rows[: np.argmax(slow)] if slow.any() and rows["setpoint"][0] == 0 else rows
    t, rpm = rolls["time"], rolls["rpm"]
    at = np.flatnonzero(np.diff(rpm))
    return (t[at] + t[at + 1]) / 2, (rpm[at] + rpm[at + 1]) / 2 * RAD_S_PER_RPM


def trapezoids(t, w):
    return np.r_[0, np.cumsum(np.diff(t) * (w[1:] + w[:-1]) / 2)]


def coast(coasts):
    """Friction over inertia: each coast has a start speed of its own."""
    t, w, angle, which = (np.concatenate(part) for part in zip(*coasts))
    starts = (which[:, None] == np.unique(which)[None]).astype(float)
    matrix = np.c_[-t, -angle, starts]
    weights = np.ones_like(w)
    for _ in range(2):
        found, *_ = np.linalg.lstsq(matrix * weights[:, None], w * weights, rcond=None)
        weights = 1 / (found[0] + found[1] * w)
    return found[:2]


def coast_down(study, run):
    coasts, pushes = [], []
    for step in np.unique(run["step"]):
        rows = run[run["step"] == step]
        if step % 2 == 1:
            t, w = changes(rows, 0.02)
            w = np.abs(w)
            coasts.append((t - t[0], w, trapezoids(t, w), np.full(len(t), step)))
        else:
            amps = np.round(rows["setpoint"][0] / RAW_A) * RAW_A
            pushes.append((amps * TORQUE_NM_PER_A, *changes(rows, 0.01)))
    dry, viscous = coast(coasts)
    without = np.array([coast(coasts[:at] + coasts[at + 1 :]) for at in range(len(coasts))])
    count = len(coasts)
    errors = np.sqrt((count - 1) / count * np.sum((without - without.mean(axis=0)) ** 2, axis=0))
    dry_off, viscous_off = errors * t_quantile(count - 1)
    slopes = []
    for torque, t, w in pushes:
        middle = (w[1:] + w[:-1]) / 2
        braked = np.sign(middle) * dry + middle * viscous
        lost = np.r_[0, np.cumsum(braked * np.diff(t))]
        slopes.append(np.polyfit(t - t[0], w + lost, 1)[0] / torque)
    mean = np.mean(slopes)
    off = np.std(slopes, ddof=1) / np.sqrt(len(slopes)) * t_quantile(len(slopes) - 1)
    inertia, inertia_off = 1 / mean, off / mean**2
    return [
        (dry, dry_off),
        (viscous, viscous_off),
        (inertia, inertia_off),
        (dry * inertia, np.hypot(dry_off * inertia, inertia_off * dry)),
        (viscous * inertia, np.hypot(viscous_off * inertia, inertia_off * viscous)),
    ]


def heating(study, run):
    rows = run[~np.isnan(run["celsius"])]
    t, celsius = rows["time"] - rows["time"][0], rows["celsius"]

    def model(unknowns):
        final, rise, constant = unknowns
        return final - rise * np.exp(-t / constant)

    def off(unknowns):
        return (batched(model(unknowns)) - batched(celsius)).mean(axis=1)

    start = [celsius[-1], np.ptp(celsius), t[-1] / 2]
    final, rise, constant = least_squares(off, start, x_scale=start, xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    decay = np.exp(-t / constant)
    matrix = np.c_[np.ones_like(t), -decay, -rise * decay * t / constant**2]
    # The time constant counts from the minimum.
    unknowns, plus_minus = of_batches(matrix, celsius, celsius, lambda _: np.ones_like(t))
    return zip(unknowns + [0, 0, constant], plus_minus)


def torque_speed(study, run):
    rows = run[run["step"] == 1]
    rpm, amps = np.abs(rows["rpm"]), rows["amps"]
    free = rpm[rows["time"] < rows["time"][0] + 5]
    (no_load,), (no_load_off,) = of_batches(np.ones((len(free), 1)), free, free, lambda _: np.ones_like(free))
    turns = rpm >= no_load / 4
    lost = (no_load - rpm)[turns]
    matrix, y = np.c_[np.ones_like(lost), lost, lost**2], amps[turns] ** 2
    # The noise of a square grows with the current.
    first, *_ = ordinary(batched(matrix).mean(axis=1), batched(y).mean(axis=1))
    weight = 1 / np.sqrt(np.maximum(matrix @ first, 0.03**2))
    unknowns, plus_minus = of_batches(
        matrix * weight[:, None],
        y * weight,
        rpm[turns],
        lambda found: (found[1] + 2 * found[2] * lost) * weight,
    )
    curve, least = unknowns[2], unknowns[2] - plus_minus[2]
    droop = 1 / (TORQUE_NM_PER_A * np.sqrt(curve))
    return [(no_load, no_load_off), (droop, 1 / (TORQUE_NM_PER_A * np.sqrt(least)) - droop)]


def read(path):
    columns = {"time": "time", "rpm": "speed_rpm", "amps": "current_a", "celsius": "temperature_c"}
    columns |= {"setpoint": "setpoint", "step": "step"}
    with open(path, newline="") as file:
        rows = [tuple(float(row[name] or "nan") for name in columns.values()) for row in csv.DictReader(file)]
    return np.array(rows, dtype=[(name, float) for name in columns])


def main():
    study, run = json.loads(sys.argv[1]), read(sys.argv[2])
    figures = {"friction": friction, "coast_down": coast_down, "heating": heating, "torque_speed": torque_speed}
    for value, plus_minus in figures[study["kind"]](study, run):
        print(float(value), float(plus_minus), sep=",")


main()
