//! Step responses of systems whose figures python-control has computed.

use motorlink_experiments::analysis::{Point, StepFigures, StepRun, step_figures};

/// What `figures.py systems` prints.
const SYSTEMS: &str = include_str!("independent/known_systems.csv");

struct System {
    name: &'static str,
    above: Vec<f64>,
    below: Vec<f64>,
    from: f64,
    to: f64,
    for_s: f64,
    hz: f64,
    /// Steady value, rise time, overshoot, wrong way, settling time, peak and its time.
    figures: [f64; 7],
}

fn systems() -> Vec<System> {
    let system = |line: &'static str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |place: usize| -> f64 { cells[place].parse().unwrap() };
        let list = |place: usize| -> Vec<f64> {
            let numbers = cells[place].split(' ');
            numbers.map(|one| one.parse().unwrap()).collect()
        };
        System {
            name: cells[0],
            above: list(1),
            below: list(2),
            from: number(3),
            to: number(4),
            for_s: number(5),
            hz: number(6),
            figures: std::array::from_fn(|place| number(7 + place)),
        }
    };
    SYSTEMS.lines().skip(1).map(system).collect()
}

impl System {
    /// Replies to the step, by Runge and Kutta's method on the controllable form.
    fn replies(&self, until_s: f64) -> Vec<Point> {
        const STEPS: u32 = 20;
        let lead = self.below[0];
        let below: Vec<f64> = self.below.iter().map(|one| one / lead).collect();
        let order = below.len() - 1;
        let mut above = vec![0.0; below.len() - self.above.len()];
        above.extend(self.above.iter().map(|one| one / lead));
        let change = |state: &[f64]| -> Vec<f64> {
            let highest: f64 = (0..order).map(|n| below[order - n] * state[n]).sum();
            let mut change = state[1..].to_vec();
            change.push(1.0 - highest);
            change
        };
        let moved = |state: &[f64], by: &[f64], step: f64| -> Vec<f64> {
            state.iter().zip(by).map(|(x, d)| x + step * d).collect()
        };
        let mut state = vec![0.0; order];
        let step = 1.0 / self.hz / f64::from(STEPS);
        let mut points = Vec::new();
        for tick in 0_u32.. {
            let t_s = f64::from(tick) / self.hz;
            if t_s > until_s {
                break;
            }
            let inner: f64 = (0..order)
                .map(|n| (above[order - n] - above[0] * below[order - n]) * state[n])
                .sum();
            points.push(Point::new(
                t_s,
                self.from + (self.to - self.from) * (inner + above[0]),
            ));
            for _ in 0..STEPS {
                let a = change(&state);
                let b = change(&moved(&state, &a, step / 2.0));
                let c = change(&moved(&state, &b, step / 2.0));
                let d = change(&moved(&state, &c, step));
                for (n, x) in state.iter_mut().enumerate() {
                    *x += step / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]);
                }
            }
        }
        points
    }

    fn measure(&self, response: &[Point], resolution: f64) -> StepFigures {
        step_figures(&StepRun {
            at_s: 0.0,
            from: self.from,
            to: self.to,
            response,
            amps: &[],
            resolution,
        })
    }

    /// Each time within 1 %, each value within 0.5 % of the way.
    fn agrees(&self, found: &StepFigures) {
        let Self { name, figures, .. } = self;
        assert!(found.settled, "{name}: {found:?}");
        let [
            steady,
            rise_s,
            overshoot,
            wrong_way,
            settling_s,
            peak,
            peak_s,
        ] = *figures;
        let way = (steady - self.from).abs();
        let values = [
            ("steady error", found.steady_error, self.to - steady, way),
            ("overshoot", found.overshoot, overshoot, 1.0),
            ("wrong way", found.wrong_way, wrong_way, 1.0),
            ("peak", found.peak, peak, way),
        ];
        for (what, found, exact, of) in values {
            let found = found.unwrap();
            assert!(
                (found - exact).abs() <= 5e-3 * of,
                "{name}: {what} {found} {exact}"
            );
        }
        let has_peak = overshoot > 0.0;
        assert_eq!(found.peak_s.is_some(), has_peak, "{name}: {found:?}");
        let times = [
            ("rise", found.rise_s, rise_s),
            ("settling", found.settling_s, settling_s),
            (
                "peak",
                found.peak_s.or(Some(peak_s)),
                if has_peak {
                    peak_s
                } else {
                    found.peak_s.unwrap_or(peak_s)
                },
            ),
        ];
        for (what, found, exact) in times {
            let found = found.unwrap();
            assert!(
                (found / exact - 1.0).abs() <= 0.01,
                "{name}: {what} {found} {exact}"
            );
        }
    }
}

#[test]
fn six_known_systems_have_their_figures() {
    let systems = systems();
    assert_eq!(systems.len(), 6);
    for system in systems {
        system.agrees(&system.measure(&system.replies(system.for_s), 0.0));
    }
}

/// At any hold a step has its figures or has not settled.
#[test]
fn a_short_hold_has_the_right_figures_or_none() {
    for system in systems() {
        let all = system.replies(system.for_s);
        let mut settled = 0;
        for part in 1_u32..=100 {
            let until_s = system.for_s * f64::from(part) / 100.0;
            let held = &all[..all.partition_point(|point| point.t_s < until_s)];
            let found = system.measure(held, 0.0);
            if found.settled {
                system.agrees(&found);
                settled += 1;
            } else {
                assert_eq!(found.rise_s.or(found.overshoot).or(found.settling_s), None);
            }
        }
        assert!(settled >= 10, "{}: {settled}", system.name);
    }
}

#[test]
fn a_ramp_never_settles_however_short_its_way_is() {
    for tenths in 1..=3_000 {
        let way = f64::from(tenths) / 10.0;
        for (hold_s, phase) in [(0.5, 0.0), (1.5, 0.3), (3.0, 0.7)] {
            let ticks = 0_u32..;
            let times = ticks.map(|tick| f64::from(tick) * 5e-3);
            let ramp: Vec<Point> = times
                .take_while(|t_s| *t_s < hold_s)
                .map(|t_s| Point::new(t_s, (phase + way * t_s / hold_s).round()))
                .collect();
            let found = step_figures(&StepRun {
                at_s: 0.0,
                from: 0.0,
                to: 300.0,
                response: &ramp,
                amps: &[],
                resolution: 1.0,
            });
            assert!(!found.settled, "{way} rpm in {hold_s} s: {found:?}");
        }
    }
}
