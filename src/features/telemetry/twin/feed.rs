//! The data of the twin: reports, the goal, and the activity of the bus.

use std::rc::Rc;

use motorlink_messages::bus::{Activity, Turns};
use motorlink_messages::protocol::{Rpm, Setpoint};

use crate::{
    features::telemetry::twin::{
        motion::{AngleQuality, Estimator, FRESH_MS, Pose, ReportedAngle},
        texts::{Figures, Motion},
    },
    link::clock::Clock,
};

/// The data of one motor: the page writes it at any rate, and the twin reads it once a frame. Nothing in it is a
/// signal.
///
/// All times are shown times, in milliseconds: see `link::clock`.
#[derive(Default)]
pub struct TwinFeed {
    estimator: Estimator,
    /// Last reported speed, and when.
    speed: Option<(f64, Rpm)>,
    /// Last reported angle in degrees.
    angle_deg: Option<f64>,
    goal: Option<Setpoint>,
    activity: Option<Activity>,
    turns: Option<Turns>,
    drawn: Option<Drawn>,
    /// Wakes the component, which sleeps while nothing moves.
    wake: Option<Rc<dyn Fn()>>,
}

/// The wheel in the last drawing, for other parts that show its angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// The angle in degrees, unwrapped: it may be any number. As a clockwise rotation it turns a
    /// drawing the right way.
    pub angle_deg: f64,
}

/// The content of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub pose: Pose,
    pub motion: Motion,
    /// `None` before the first report.
    pub figures: Option<Figures>,
    pub goal: Option<Setpoint>,
    /// Whether the goal is being sent.
    pub driven: bool,
    /// When the data becomes stale, which changes the view even at standstill.
    pub fresh_until_ms: Option<f64>,
}

impl TwinFeed {
    /// A reply of the motor, measured at `shown_ms`.
    ///
    /// `angle_deg` is the reported angle, 0 to 360, falling at positive speed; `None` if the reply does not contain
    /// it. `quality` tells drive replies from query replies. `speed_rpm` is the reported speed; a reply without one keeps the wheel at the speed before. Replies must come in
    /// the order of their measurement; an older one is ignored.
    pub fn sample(
        &mut self,
        shown_ms: f64,
        angle_deg: Option<f64>,
        quality: AngleQuality,
        speed_rpm: Option<i16>,
    ) {
        if !shown_ms.is_finite() {
            return;
        }
        self.speed = speed_rpm
            .map(|rpm| (shown_ms, Rpm::new(rpm)))
            .or(self.speed);
        let Some((_, speed)) = self.speed else {
            return;
        };
        let angle = angle_deg.map(|degrees| ReportedAngle { degrees, quality });
        self.angle_deg = angle_deg.or(self.angle_deg);
        self.estimator
            .report(shown_ms, angle, f64::from(speed.rpm()));
        self.wake();
    }

    /// The setpoint, as the page shows it; the pointer shows it.
    pub fn set_goal(&mut self, goal: Option<Setpoint>) {
        if self.goal != goal {
            self.goal = goal;
            self.wake();
        }
    }

    /// Sets what the bus does with the motor.
    pub fn set_activity(&mut self, activity: Option<Activity>) {
        if self.activity != activity {
            self.activity = activity;
            self.wake();
        }
    }

    /// Sets the turns that the bus has counted.
    pub fn set_turns(&mut self, turns: Option<Turns>) {
        if self.turns != turns {
            self.turns = turns;
            self.wake();
        }
    }

    /// Forgets the data after a disconnection or for another motor. The wheel stays as it was drawn.
    pub fn clear(&mut self) {
        self.estimator.clear();
        self.speed = None;
        self.angle_deg = None;
        self.goal = None;
        self.activity = None;
        self.turns = None;
        self.drawn = None;
        self.wake();
    }

    /// The last drawing; `None` before the first reported angle.
    #[must_use]
    pub const fn drawn(&self) -> Option<Drawn> {
        self.drawn
    }

    /// Calls `wake` with all new data. It must not touch the feed.
    pub(crate) fn on_new_data(&mut self, wake: Rc<dyn Fn()>) {
        self.wake = Some(wake);
    }

    fn wake(&self) {
        if let Some(wake) = &self.wake {
            wake();
        }
    }

    /// The content of the frame at this time of the page. A recording turns the wheel at the speed of its replay.
    pub(crate) fn view_at(&mut self, clock: Clock, now_ms: f64) -> View {
        let shown_ms = clock.shown_ms(now_ms);
        if clock.is_paused() {
            self.estimator.jump();
        }
        let mut view = self.view(shown_ms);
        let later_ms = now_ms - shown_ms;
        view.pose.settled |= clock.is_paused();
        let heading = &mut view.pose.heading;
        heading.rate_deg_per_s *= clock.speed;
        heading.known_until_ms += later_ms;
        if let Some(until_ms) = &mut view.fresh_until_ms {
            *until_ms += later_ms;
        }
        view
    }

    /// The content of the frame at this shown time.
    pub(crate) fn view(&mut self, now_ms: f64) -> View {
        let pose = self.estimator.frame(now_ms);
        let fresh = self
            .speed
            .filter(|(at_ms, _)| now_ms - at_ms <= FRESH_MS)
            .map(|(_, speed)| speed);
        let angle_deg = pose.heading.angle_deg;
        // A report, as in the position card: the drawn wheel moves on between two replies.
        let figures = self
            .speed
            .map(|(_, speed)| Figures::new(speed, self.angle_deg, self.turns));
        self.drawn = self.angle_deg.map(|_| Drawn { angle_deg });
        let driven = match self.activity {
            Some(Activity::Driven { .. } | Activity::DrivenRaw | Activity::Stopping { .. }) => true,
            Some(Activity::Idle | Activity::Switching { .. }) | None => false,
        };
        View {
            pose,
            motion: Motion::of(fresh, self.goal, self.activity),
            figures,
            goal: self.goal,
            driven,
            fresh_until_ms: self.speed.map(|(at_ms, _)| at_ms + FRESH_MS),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use motorlink_messages::protocol::SpeedTarget;

    use super::*;

    #[test]
    fn news_wake_the_twin_and_old_news_do_not() {
        let woken = Rc::new(Cell::new(0));
        let mut feed = TwinFeed::default();
        feed.on_new_data(Rc::new({
            let woken = Rc::clone(&woken);
            move || woken.set(woken.get() + 1)
        }));
        let goal = Some(Setpoint::velocity(SpeedTarget::ZERO));
        feed.sample(0.0, Some(1.0), AngleQuality::Fine, Some(0));
        feed.set_goal(goal);
        feed.set_goal(goal);
        feed.set_activity(Some(Activity::Idle));
        feed.set_activity(Some(Activity::Idle));
        feed.clear();
        assert_eq!(woken.get(), 4);
    }

    /// A stop, as the page reports it.
    #[test]
    fn a_stop_is_braking_until_the_wheel_stands() {
        let mut feed = TwinFeed::default();
        assert_eq!(feed.view(0.0).motion, Motion::NoData);
        feed.sample(0.0, Some(90.0), AngleQuality::Fine, Some(100));
        assert_eq!(feed.view(5.0).motion, Motion::SpinningCcw);
        feed.set_activity(Some(Activity::Stopping { confirmed: false }));
        feed.sample(20.0, Some(78.0), AngleQuality::Fine, Some(60));
        assert_eq!(feed.view(25.0).motion, Motion::Braking);
        feed.sample(40.0, Some(75.0), AngleQuality::Fine, Some(0));
        let view = feed.view(45.0);
        assert_eq!(view.motion, Motion::Stationary);
        assert_eq!(view.fresh_until_ms, Some(540.0));
        assert_eq!(feed.view(541.0).motion, Motion::NoData);
    }

    /// A speed without an angle gives a text, and no guessed angle.
    #[test]
    fn speed_alone_is_said() {
        let mut feed = TwinFeed::default();
        feed.sample(0.0, None, AngleQuality::Fine, Some(-20));
        let view = feed.view(1.0);
        assert_eq!(view.motion, Motion::SpinningCw);
        assert_eq!(view.figures.unwrap().angle_text(), "–°");
    }

    /// A query reply at rest is coarse: the drawn wheel stays within its step, and the figure is the one of the card.
    #[test]
    fn at_rest_the_figure_is_the_reported_angle() {
        let mut feed = TwinFeed::default();
        feed.sample(0.0, Some(55.1), AngleQuality::Fine, Some(0));
        feed.sample(20.0, Some(56.5), AngleQuality::Coarse, Some(0));
        let view = feed.view(25.0);
        assert_eq!(view.figures.unwrap().angle_text(), "56.5°");
        assert!((view.pose.heading.angle_deg - 55.1).abs() < 0.1);
    }

    #[test]
    fn what_was_drawn_last_tells_the_angle_through_many_turns() {
        let mut feed = TwinFeed::default();
        feed.sample(0.0, Some(30.0), AngleQuality::Fine, Some(100));
        assert_eq!(feed.drawn(), None, "nothing was drawn yet");
        // 100 rpm make the angle fall by 12 degrees in 20 ms, and 3 turns in 1.8 s.
        for place in 0..=90_u32 {
            let at_ms = f64::from(place) * 20.0;
            let angle = (30.0 - f64::from(place) * 12.0).rem_euclid(360.0);
            feed.sample(at_ms, Some(angle), AngleQuality::Fine, Some(100));
            feed.view(at_ms);
        }
        let drawn = feed.drawn().unwrap();
        assert!((drawn.angle_deg - (30.0 - 1080.0)).abs() < 0.5, "{drawn:?}");
        feed.clear();
        assert_eq!(feed.drawn(), None);
    }

    #[test]
    fn clearing_forgets_all() {
        let mut feed = TwinFeed::default();
        feed.sample(0.0, Some(90.0), AngleQuality::Coarse, Some(100));
        feed.set_goal(Some(Setpoint::Brake));
        feed.clear();
        let view = feed.view(1.0);
        assert_eq!(
            (view.motion, view.figures, view.goal),
            (Motion::NoData, None, None)
        );
        assert_eq!(view.fresh_until_ms, None);
    }
}
