//! Feeds the history of the motors to the odometry, and keeps the path.
//!
//! The history has every reply of the last ten minutes. So the path is complete also after the page was hidden and
//! drew nothing.

use motorlink_messages::{
    experiments::{
        odometry::{Angle, Odometer, Pose, Report},
        vehicle::{Geometry, Vehicle},
    },
    protocol::{Instant, MotorId},
};

use crate::{
    features::rover::path::Path,
    model::{
        history::{History, Point},
        point::Kept,
    },
};

/// The way of the vehicle since the last reset.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trip {
    of: Option<(Vehicle, Geometry)>,
    odometer: Option<Odometer>,
    path: Path,
    /// From when on replies count, on the clock of the history.
    since: Option<Instant>,
}

impl Trip {
    /// Starts an empty path at this time.
    pub(crate) fn begin(&mut self, vehicle: &Vehicle, geometry: Geometry, now: Instant) {
        self.odometer = Some(Odometer::new(vehicle, geometry));
        self.of = Some((vehicle.clone(), geometry));
        self.path = Path::default();
        self.since = Some(now);
    }

    /// Counts the replies that are new. Other wheels or measures begin another path.
    pub(crate) fn follow(
        &mut self,
        vehicle: &Vehicle,
        geometry: Geometry,
        history: &History,
        now: Instant,
    ) {
        let same = self
            .of
            .as_ref()
            .is_some_and(|(of, with)| of == vehicle && *with == geometry);
        if !same {
            self.begin(vehicle, geometry, now);
        }
        let (Some(odometer), Some(since)) = (&mut self.odometer, self.since) else {
            return;
        };
        // Of each wheel.
        let mut reports = Vec::new();
        for (place, wheel) in vehicle.wheels().iter().enumerate() {
            let mut of_wheel = Vec::new();
            if let Some(track) = history.track(wheel.id) {
                let newest = odometer.newest(place);
                let mut before = newest;
                let (_, new) = track.around(newest.unwrap_or(since));
                for point in new.filter(|point| Some(point.at) > newest) {
                    let is_gap = before.is_some_and(|before| history.is_gap(before, point.at));
                    if let Some(report) = report(point, is_gap) {
                        of_wheel.push((point.at, report));
                        before = Some(point.at);
                    }
                }
            }
            reports.push(of_wheel.into_iter().peekable());
        }
        // In the order of time: the way begins with the first replies of both sides, also where many come at once.
        let path = &mut self.path;
        loop {
            let next = reports.iter_mut().enumerate();
            let next = next.filter_map(|(place, all)| Some((all.peek()?.0, place)));
            let Some((_, place)) = next.min() else {
                return;
            };
            if let Some((_, report)) = reports.get_mut(place).and_then(Iterator::next) {
                odometer.report(place, report);
                odometer.advance(|step| path.extend(step.pose, step.link));
            }
        }
    }

    pub(crate) fn pose(&self) -> Pose {
        self.odometer
            .as_ref()
            .map(Odometer::pose)
            .unwrap_or_default()
    }

    /// In mm.
    pub(crate) fn driven_mm(&self) -> f64 {
        self.odometer.as_ref().map_or(0.0, Odometer::driven_mm)
    }

    /// A wheel whose angle does not follow its speed, so that its speed counts.
    pub(crate) fn misfit(&self) -> Option<MotorId> {
        let (vehicle, _) = self.of.as_ref()?;
        let place = self.odometer.as_ref()?.misfit()?;
        vehicle.wheels().get(place).map(|wheel| wheel.id)
    }

    pub(crate) const fn path(&self) -> &Path {
        &self.path
    }
}

/// `None` without a speed.
fn report(point: &Point, is_cut_off: bool) -> Option<Report> {
    let angle = match point.detail {
        Kept::Fine(position) => Angle::Fine(position),
        Kept::Coarse(_, position) => Angle::Coarse(position),
        Kept::Odometry(_) | Kept::Temperature(_) | Kept::Nothing => Angle::None,
    };
    Some(Report::new(point.at, point.speed()?, angle, is_cut_off))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{
        history::tests::{sample, update},
        vehicle::{tests::names, vehicle_of},
    };

    /// Behind a jump in a recording, the replies of a minute come at once.
    #[test]
    fn the_way_is_the_same_whether_replies_come_one_by_one_or_all_at_once() {
        let vehicle = vehicle_of(&names(2)).unwrap();
        let geometry = Geometry::new(51, 300).unwrap();
        let mut history = History::default();
        let [mut one_by_one, mut at_once] = [Trip::default(), Trip::default()];
        for trip in [&mut one_by_one, &mut at_once] {
            trip.begin(&vehicle, geometry, Instant::ZERO);
        }
        for at_ms in (1_000..4_000).step_by(20) {
            let wheels = vehicle.wheels().iter();
            let samples =
                wheels.map(|wheel| sample(wheel.id, at_ms, if wheel.is_right { -60 } else { 60 }));
            history.take(&update(at_ms, samples.collect(), vec![]));
            one_by_one.follow(&vehicle, geometry, &history, Instant::ZERO);
        }
        at_once.follow(&vehicle, geometry, &history, Instant::ZERO);
        assert!(one_by_one.driven_mm() > 100.0, "{}", one_by_one.driven_mm());
        assert!(
            (at_once.driven_mm() - one_by_one.driven_mm()).abs() < 1.0,
            "{}",
            at_once.driven_mm()
        );
    }
}
