//! Templates of sequences.

use strum::VariantArray;

use super::{
    Condition, End, PASSES_MAX, Quantity, Repeat, RunLimits, Selection, Sequence, Shape, Step, Wave,
};

/// A template of a sequence. Each runs with all motors of the fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, VariantArray)]
pub enum Template {
    /// Both directions, from slow to fast: grease and bearings first.
    WarmUp,
    /// To both sides, ten times.
    BackAndForth,
    /// Increasing speeds, each long enough to settle: speed against current.
    Staircase,
    /// Sines from 0.2 to 20 Hz: the frequency response.
    SineSweep,
    /// Eight angles; each step waits until the angle is reached.
    PositionTour,
    /// Back and forth until the winding is warm, or for hours.
    Endurance,
}

/// Centre of the sine sweep: away from standstill, where dry friction changes its sign.
const SWEEP_CENTRE_RPM: f64 = 80.0;
/// Amplitude of the lowest frequencies.
const SWEEP_AMPLITUDE_RPM: f64 = 20.0;
/// Maximal rate of the sweep's setpoint, in rpm per second. The motor's own ramp is 277 rpm per second; it limits
/// faster setpoints.
const SWEEP_SLOPE_MAX: f64 = 200.0;
/// Minimal amplitude. The protocol has whole rpm.
const SWEEP_AMPLITUDE_MIN_RPM: f64 = 3.0;
/// Points from 0.2 to 20 Hz: ten per decade.
const SWEEP_POINTS: u32 = 21;

impl Template {
    /// All of them.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Its name for the user.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WarmUp => "Warm-up",
            Self::BackAndForth => "Back and forth",
            Self::Staircase => "Staircase",
            Self::SineSweep => "Sine sweep",
            Self::PositionTour => "Position tour",
            Self::Endurance => "Endurance",
        }
    }

    /// Its steps.
    #[must_use]
    pub fn sequence(self) -> Sequence {
        let (steps, limits) = match self {
            Self::WarmUp => (warm_up(), RunLimits::default()),
            Self::BackAndForth => (vec![swing(10, None)], RunLimits::default()),
            Self::Staircase => (staircase(), RunLimits::default()),
            Self::SineSweep => (sine_sweep(), RunLimits::default()),
            Self::PositionTour => (position_tour(), RunLimits::default()),
            Self::Endurance => {
                let warm = Some(Condition::CelsiusAbove(60.0));
                let limits = RunLimits {
                    celsius: Some(65.0),
                    ..RunLimits::default()
                };
                (vec![swing(PASSES_MAX / 4, warm)], limits)
            }
        };
        Sequence {
            name: self.name().to_owned(),
            limits,
            steps,
        }
    }
}

fn hold(rpm: f64, for_s: f64) -> Step {
    Step::hold(Selection::All, Quantity::Rpm, rpm, for_s)
}

fn ramp(to: f64, for_s: f64) -> Step {
    Step::follow(
        Selection::All,
        Quantity::Rpm,
        Shape::Ramp { to },
        End::After(for_s),
    )
}

fn warm_up() -> Vec<Step> {
    let speeds = [30.0, 60.0, 90.0];
    let both = speeds.into_iter().flat_map(|rpm| [rpm, -rpm]);
    let mut steps: Vec<Step> = both
        .flat_map(|rpm| [ramp(rpm, 2.0), hold(rpm, 8.0), ramp(0.0, 2.0)])
        .collect();
    steps.push(hold(0.0, 1.0));
    steps
}

fn swing(passes: u32, until: Option<Condition>) -> Step {
    Step::Repeat(Repeat {
        passes,
        until,
        steps: vec![
            ramp(100.0, 1.0),
            hold(100.0, 2.0),
            ramp(0.0, 1.0),
            ramp(-100.0, 1.0),
            hold(-100.0, 2.0),
            ramp(0.0, 1.0),
        ],
    })
}

fn staircase() -> Vec<Step> {
    let up = [20.0, 40.0, 60.0, 80.0, 100.0, 120.0];
    let mut steps: Vec<Step> = up.into_iter().map(|rpm| hold(rpm, 4.0)).collect();
    steps.push(ramp(0.0, 2.0));
    steps.extend(up.into_iter().map(|rpm| hold(-rpm, 4.0)));
    steps.push(ramp(0.0, 2.0));
    steps
}

fn sine_sweep() -> Vec<Step> {
    let mut steps = vec![ramp(SWEEP_CENTRE_RPM, 2.0), hold(SWEEP_CENTRE_RPM, 1.0)];
    for point in 0..SWEEP_POINTS {
        // Rounded, so that a file has 0.252 instead of sixteen digits.
        let hz = 0.2 * 10_f64.powf(f64::from(point) / 10.0);
        let hz = (hz * 1000.0).round() / 1000.0;
        let amplitude = SWEEP_SLOPE_MAX / (std::f64::consts::TAU * hz);
        let amplitude = amplitude.clamp(SWEEP_AMPLITUDE_MIN_RPM, SWEEP_AMPLITUDE_RPM);
        let wave = Wave {
            centre: SWEEP_CENTRE_RPM,
            amplitude: (amplitude * 10.0).round() / 10.0,
            hz,
        };
        // At least three periods, and enough replies to average out the rounding to 1 rpm.
        let periods = (6.0 * hz).ceil().max(3.0);
        let for_s = (periods / hz * 1000.0).round() / 1000.0;
        steps.push(Step::follow(
            Selection::All,
            Quantity::Rpm,
            Shape::Sine(wave),
            End::After(for_s),
        ));
    }
    steps.push(ramp(0.0, 2.0));
    steps
}

fn position_tour() -> Vec<Step> {
    let angles = [45.0, 90.0, 180.0, 270.0, 315.0, 180.0, 45.0, 0.0];
    let go = |degrees: f64| {
        let near = End::Until {
            condition: Condition::DegreesNear {
                degrees,
                tolerance: 2.0,
            },
            within_s: 5.0,
        };
        let arrive = Step::follow(
            Selection::All,
            Quantity::Degrees,
            Shape::Step { to: degrees },
            near,
        );
        [
            arrive,
            Step::hold(Selection::All, Quantity::Degrees, degrees, 1.0),
        ]
    };
    angles.into_iter().flat_map(go).collect()
}
