//! The curves of a plan and of a run, as SVG.

use std::fmt::Write;

use motorlink_messages::{
    experiments::{
        plan::{POINTS_MAX, Plan},
        runner::{Mark, Sample},
        sequence::Quantity,
    },
    protocol::{Instant, MotorId},
};

use crate::features::experiments::texts;

/// Columns of a live curve: a part of the plan's longest time each.
const COLUMNS: usize = 600;
/// The width and the height of the drawing in its own units.
const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 400.0;
/// Motors that have a colour of their own; the next ones begin again.
const COLOURS: usize = 4;

/// Least and greatest value of each column.
type Columns = Vec<Option<(f64, f64)>>;

/// The measured values of a run, as least and greatest value per column.
#[derive(Clone, Debug, Default)]
pub(super) struct Live {
    began: Option<Instant>,
    longest_s: f64,
    motors: Vec<(MotorId, Quantity, Columns)>,
    /// When each step began, in seconds, and which it is.
    begun: Vec<(f64, usize)>,
}

impl Live {
    pub(super) fn of(plan: &Plan) -> Self {
        let motor = |motor: &motorlink_messages::experiments::plan::PlanMotor| {
            (motor.id, motor.quantity, vec![None; COLUMNS])
        };
        Self {
            began: None,
            longest_s: plan.longest_s(),
            motors: plan.motors().iter().map(motor).collect(),
            begun: Vec::new(),
        }
    }

    pub(super) const fn began_at(&self) -> Option<Instant> {
        self.began
    }

    pub(super) const fn began(&mut self, at: Instant) {
        self.began = Some(at);
    }

    pub(super) fn step_began(&mut self, mark: &Mark) {
        // A step has a point, so the curves end before.
        if let Some(began) = self.began.filter(|_| self.begun.len() < POINTS_MAX) {
            let at_s = mark.at.since(began).as_secs_f64();
            self.begun.push((at_s, mark.step));
        }
    }

    pub(super) fn add(&mut self, sample: &Sample) {
        let Some(began) = self.began else { return };
        let Some((_, quantity, columns)) =
            self.motors.iter_mut().find(|(id, _, _)| *id == sample.id)
        else {
            return;
        };
        let value = match quantity {
            Quantity::Rpm => sample.rpm.map(f64::from),
            Quantity::Amps => sample.current.map(|current| current.amps().into()),
            Quantity::Degrees => sample.degrees.map(f64::from),
        };
        let Some(value) = value else { return };
        let passed = sample.at.since(began).as_secs_f64() / self.longest_s.max(0.001);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a float cast saturates, and there are few columns"
        )]
        let column = ((passed * COLUMNS as f64) as usize).min(COLUMNS - 1);
        if let Some(cell) = columns.get_mut(column) {
            let (least, greatest) = cell.unwrap_or((value, value));
            *cell = Some((least.min(value), greatest.max(value)));
        }
    }

    /// Least and greatest value of all motors with this quantity.
    fn range(&self, quantity: Quantity) -> Option<(f64, f64)> {
        let of = self.motors.iter().filter(|(_, own, _)| *own == quantity);
        let values = of.flat_map(|(_, _, columns)| columns.iter().flatten());
        values
            .copied()
            .reduce(|(least, greatest), (low, high)| (least.min(low), greatest.max(high)))
    }
}

/// The chart of a plan: a drawing for each quantity in it, with the measured curves of its run.
pub(super) fn html(plan: &Plan, live: Option<&Live>) -> String {
    let mut html = String::new();
    for quantity in Quantity::ALL {
        if plan.motors().iter().any(|motor| motor.quantity == quantity) {
            draw(&mut html, plan, live, quantity);
        }
    }
    html
}

fn draw(html: &mut String, plan: &Plan, live: Option<&Live>, quantity: Quantity) {
    let curves = plan.curves_of_run(live.map_or(&[], |live| &live.begun));
    let curves = || {
        curves
            .iter()
            .filter(|curve| curve.motor.quantity == quantity)
    };
    let end_s = curves()
        .filter_map(|curve| curve.points.last())
        .fold(0.001_f64, |end, point| end.max(point.t_s));
    let mut range = curves().fold((0.0_f64, 0.0_f64), |(least, greatest), curve| {
        let motor = curve.motor;
        (least.min(motor.least), greatest.max(motor.greatest))
    });
    if let Some((least, greatest)) = live.and_then(|live| live.range(quantity)) {
        range = (range.0.min(least), range.1.max(greatest));
    }
    let (least, greatest) = range;
    let margin = (greatest - least).max(1e-3) * 0.05;
    let (low, high) = (least - margin, greatest + margin);
    let y = |value: f64| HEIGHT * (high - value) / (high - low);
    let x = |t_s: f64| WIDTH * t_s / end_s;
    let unit = texts::unit(quantity);
    let zero = y(0.0);
    let _ = write!(
        html,
        "<div class=\"plan-chart\"><span class=\"plan-high\">{} {unit}</span>\
         <span class=\"plan-low\">{} {unit}</span>\
         <svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" preserveAspectRatio=\"none\" aria-hidden=\"true\">\
         <path class=\"plan-zero\" d=\"M0 {zero:.1}H{WIDTH}\"/>",
        texts::signed(greatest),
        texts::signed(least),
    );
    for curve in curves() {
        let mut path = String::new();
        for point in &curve.points {
            let command = if path.is_empty() { 'M' } else { 'L' };
            let _ = write!(path, "{command}{:.1} {:.1}", x(point.t_s), y(point.value));
        }
        let _ = write!(html, "<path class=\"plan-asked\" d=\"{path}\"/>");
    }
    let motors = live.map(|live| live.motors.as_slice()).unwrap_or_default();
    let longest_s = live.map_or(end_s, |live| live.longest_s);
    for (place, (_, own, columns)) in motors.iter().enumerate() {
        if *own != quantity {
            continue;
        }
        let mut path = String::new();
        for (column, cell) in columns.iter().enumerate() {
            let Some((low, high)) = cell else { continue };
            #[allow(clippy::cast_precision_loss, reason = "there are few columns")]
            let t_s = (column as f64 + 0.5) / COLUMNS as f64 * longest_s;
            let command = if path.is_empty() { 'M' } else { 'L' };
            let _ = write!(path, "{command}{:.1} {:.1}", x(t_s), y(*low));
            if low < high {
                let _ = write!(path, "V{:.1}", y(*high));
            }
        }
        let _ = write!(
            html,
            "<path class=\"plan-measured m{}\" d=\"{path}\"/>",
            place % COLOURS
        );
    }
    let _ = write!(
        html,
        "</svg><span class=\"plan-begin\">{}</span><span class=\"plan-end\">{}</span></div>",
        texts::duration(0.0),
        texts::duration(end_s)
    );
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        experiments::{
            plan::Fleet,
            sequence::{Sequence, Template},
        },
        protocol::Current,
    };

    use super::*;

    fn plan() -> Plan {
        let fleet = Fleet::of([MotorId::FIRST]);
        Plan::new(&Template::WarmUp.sequence(), &fleet).unwrap()
    }

    #[test]
    fn a_plan_is_drawn_with_its_range_and_its_time() {
        let html = html(&plan(), None);
        assert!(
            html.contains("+90 rpm") && html.contains("\u{2212}90 rpm"),
            "{html}"
        );
        assert!(html.contains("1 min 13 s"), "{html}");
        assert_eq!(html.matches("plan-asked").count(), 1);
        assert!(!html.contains("plan-measured"));
    }

    #[test]
    fn a_step_after_a_condition_is_drawn_where_it_began() {
        let text = r#"{ "motorlink_sequence": 1, "steps": [
            { "rpm": 50, "until": { "rpm_above": 45 }, "within_s": 60 },
            { "rpm": 20, "for_s": 1 }] }"#;
        let fleet = Fleet::of([MotorId::FIRST]);
        let plan = Plan::new(&Sequence::from_json(text).unwrap(), &fleet).unwrap();
        let mut live = Live::of(&plan);
        live.began(Instant::from_millis(500));
        assert!(html(&plan, Some(&live)).contains("1 min 1 s"));
        for (at_ms, step) in [(500, 0), (4_500, 1)] {
            let at = Instant::from_millis(at_ms);
            live.step_began(&Mark { at, step });
        }
        let html = html(&plan, Some(&live));
        assert!(html.contains(&texts::duration(5.0)), "{html}");
        assert!(html.contains("L800.0 "), "{html}");
    }

    #[test]
    fn samples_are_drawn_at_their_time_and_widen_the_range() {
        let plan = plan();
        let mut live = Live::of(&plan);
        let sample = |at_ms, rpm| Sample {
            id: MotorId::FIRST,
            at: Instant::from_millis(at_ms),
            rpm: Some(rpm),
            current: Some(Current::from_raw(0)),
            degrees: None,
            celsius: None,
        };
        live.add(&sample(1_000, 5));
        live.began(Instant::from_millis(1_000));
        live.add(&sample(1_000, -120));
        live.add(&sample(1_001, 20));
        assert_eq!(live.range(Quantity::Rpm), Some((-120.0, 20.0)));
        let html = html(&plan, Some(&live));
        assert!(html.contains("\u{2212}120 rpm"), "{html}");
        assert_eq!(html.matches("plan-measured").count(), 1);
    }
}
