//! The charts of a plan and of its run.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::{
    experiments::{
        chart::{AxisName, Chart, HEIGHT_MAX, Line, Look, RUNS_MAX},
        plan::{POINTS_MAX, Plan},
        runner::{Mark, Sample},
        sequence::Quantity,
    },
    protocol::{Instant, MotorId},
};

use crate::{
    features::experiments::texts,
    ui::{
        reactive::{dynamic, effect},
        size_watch::SizeWatch,
    },
};

/// Columns of a live curve: a part of the plan's longest time each.
const COLUMNS: usize = 600;
/// The last colour of a chart. The others are for the motors, again from the first if there are more.
const SETPOINT_COLOUR: usize = RUNS_MAX - 1;

/// A chart that is less wide has its full height.
const NARROW_PX: i32 = 500;

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

    /// A line for each motor with this quantity.
    fn lines(&self, quantity: Quantity) -> Vec<Line> {
        let motors = self.motors.iter().enumerate();
        let own = motors.filter(|(_, (_, own, _))| *own == quantity);
        own.map(|(place, (id, _, columns))| Line {
            colour: place % SETPOINT_COLOUR,
            look: Look::Plain,
            name: id.to_string(),
            points: self.points(columns),
        })
        .collect()
    }

    fn points(&self, columns: &Columns) -> Vec<(f64, f64)> {
        let columns = columns.iter().enumerate();
        let points = columns.filter_map(|(column, cell)| {
            let (low, high) = (*cell)?;
            #[allow(clippy::cast_precision_loss, reason = "there are few columns")]
            let t_s = (column as f64 + 0.5) / COLUMNS as f64 * self.longest_s;
            Some([(t_s, low), (t_s, high)])
        });
        points.flatten().collect()
    }
}

/// Charts, one below the other, in the width of their container: so their texts have the size of other texts.
#[component]
pub(super) fn Charts(
    charts: Box<dyn Fn() -> Vec<Chart>>,
    label: Signal<String>,
    /// Of each chart, without its legend.
    height_max: Signal<f64>,
) -> impl IntoView {
    let place = NodeRef::<Div>::new();
    let width = RwSignal::new(720);
    let watch = StoredValue::new_local(None::<SizeWatch>);
    let drawn = RwSignal::new(Vec::new());
    effect(move || drawn.set(charts()));
    effect(move || {
        let Some(place) = place.get() else { return };
        let mut html = String::new();
        drawn.with(|charts: &Vec<Chart>| {
            place.set_hidden(charts.is_empty());
            for chart in charts {
                // A builder that escapes every text.
                // A narrow page scrolls anyway.
                let height_max = if width.get() < NARROW_PX {
                    HEIGHT_MAX
                } else {
                    height_max.get()
                };
                let svg = chart.svg(&texts::axis, width.get().into(), height_max);
                svg.write(&mut html);
            }
        });
        place.set_inner_html(&html);
    });
    effect(move || {
        let Some(place) = place.get() else { return };
        watch.set_value(SizeWatch::of(&place.clone(), move || {
            let now = place.client_width();
            // Where it is not shown it has none.
            if now > 0 && now != width.get_untracked() {
                // Drawn at once, it would change the size that is being reported.
                request_animation_frame(move || width.set(now));
            }
        }));
    });
    view! { <div class="run-chart" role="img" aria-label=dynamic(move || label.get()) node_ref=place></div> }
}

/// The charts of a plan: one for each quantity in it, with the measured curves of its run.
pub(super) fn charts(plan: &Plan, live: Option<&Live>) -> Vec<Chart> {
    let quantities = Quantity::ALL.into_iter();
    let charts = quantities.filter_map(|quantity| of_quantity(plan, live, quantity));
    charts.collect()
}

fn of_quantity(plan: &Plan, live: Option<&Live>, quantity: Quantity) -> Option<Chart> {
    let begun = live.map_or(&[][..], |live| &live.begun);
    let curves = plan.curves_of_run(begun).into_iter();
    let planned = curves.filter(|curve| curve.motor.quantity == quantity);
    let planned = planned.enumerate().map(|(place, curve)| Line {
        colour: SETPOINT_COLOUR,
        look: Look::Dashed,
        // Once in the legend for all motors.
        name: if place == 0 {
            tr!("Setpoint").to_owned()
        } else {
            String::new()
        },
        points: curve.points.iter().map(|it| (it.t_s, it.value)).collect(),
    });
    let measured = live.map(|live| live.lines(quantity)).unwrap_or_default();
    let axis = match quantity {
        Quantity::Rpm => AxisName::Speed,
        Quantity::Amps => AxisName::Current,
        Quantity::Degrees => AxisName::Position,
    };
    Chart::of(AxisName::Time, axis, planned.chain(measured).collect())
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are drawn as they are")]
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

    fn only(mut charts: Vec<Chart>) -> Chart {
        assert_eq!(charts.len(), 1);
        charts.remove(0)
    }

    #[test]
    fn a_plan_is_drawn_with_its_range_and_its_time() {
        let chart = only(charts(&plan(), None));
        let [planned] = chart.lines.as_slice() else {
            panic!("{chart:?}");
        };
        assert_eq!(planned.look, Look::Dashed);
        let least_and_greatest = |value| planned.points.iter().any(|(_, y)| *y == value);
        assert!([90.0, -90.0].into_iter().all(least_and_greatest));
        assert_eq!(planned.points.last().unwrap().0, 73.0);
        assert!(chart.y.from <= -90.0 && chart.y.to >= 90.0);
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
        let end_s = |live: &Live| {
            let chart = only(charts(&plan, Some(live)));
            chart.lines[0].points.last().unwrap().0
        };
        assert_eq!(end_s(&live), 61.0);
        for (at_ms, step) in [(500, 0), (4_500, 1)] {
            let at = Instant::from_millis(at_ms);
            live.step_began(&Mark { at, step });
        }
        assert_eq!(end_s(&live), 5.0);
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
        let chart = only(charts(&plan, Some(&live)));
        assert!(chart.y.from <= -120.0, "{:?}", chart.y);
        let measured = &chart.lines[1];
        assert_eq!(measured.look, Look::Plain);
        let values: Vec<f64> = measured.points.iter().map(|point| point.1).collect();
        assert_eq!(values, [-120.0, 20.0], "before the run nothing is drawn");
    }
}
