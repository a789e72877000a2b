//! Draws a view by setting a few attributes of the picture, and only those that differ.

use leptos::web_sys::SvgElement;
use motorlink_messages::protocol::Setpoint;

use crate::{
    features::telemetry::twin::{
        blur::{sharpness, trail_deg},
        feed::View,
        look::Look,
        scale::SpeedScale,
        texts::{Motion, description},
        turning::Turning,
    },
    ui::{attribute::Attribute, frame_rate::frame_rate, text::Text},
};

/// The moving parts of a mounted picture.
pub struct Painter {
    wheel: Look,
    scale: SpeedScale,
    look: Attribute,
    description: Text,
    turning: Turning,
    tread: Attribute,
    tread_band: Attribute,
    holes: Attribute,
    hole_band: Attribute,
    trail: Attribute,
    trail_side: Attribute,
    speed_length: Attribute,
    speed_start: Attribute,
    knob: Attribute,
    goal_speed: Attribute,
    goal_angle: Attribute,
}

impl Painter {
    /// Finds the moving parts of the picture of this wheel; `None` if the element does not contain it.
    pub fn of(picture: &SvgElement, wheel: Look) -> Option<Self> {
        let find = |selector, name| Attribute::find(picture, selector, name);
        Some(Self {
            wheel,
            scale: SpeedScale {
                limit_rpm: wheel.speed_rpm_max.into(),
            },
            look: Attribute::of(picture.clone().into(), "data-look"),
            description: Text::find(picture, "desc")?,
            turning: Turning::find(picture)?,
            tread: find(".twin-tread", "opacity")?,
            tread_band: find(".twin-tread-band", "opacity")?,
            holes: find(".twin-holes", "opacity")?,
            hole_band: find(".twin-hole-band", "opacity")?,
            trail: find(".twin-trail", "stroke-dasharray")?,
            trail_side: find(".twin-trail", "transform")?,
            speed_length: find(".twin-speed", "stroke-dasharray")?,
            speed_start: find(".twin-speed", "stroke-dashoffset")?,
            knob: find(".twin-knob", "transform")?,
            goal_speed: find(".twin-goal-speed", "transform")?,
            goal_angle: find(".twin-goal-angle", "transform")?,
        })
    }

    /// Shows a view.
    pub fn paint(&mut self, view: &View, now_ms: f64) {
        self.turning.steer(view.pose.heading, now_ms);
        self.paint_wheel(view);
        self.paint_speed(view.pose.speed_rpm);
        self.paint_goal(view.goal);
        self.look.set(look(view));
        let speed = view.figures.map(|figures| figures.speed);
        self.description.set(&description(view.motion, speed));
    }

    fn paint_wheel(&mut self, view: &View) {
        let rpm = view.pose.speed_rpm;
        // Without fresh data the wheel does not turn, so it is drawn sharp.
        let blurred_rpm = if view.pose.fresh { rpm } else { 0.0 };
        let rate = frame_rate();
        let tread = sharpness(blurred_rpm, self.wheel.tread_blocks, rate);
        self.tread.set(opacity(tread));
        self.tread_band.set(opacity(1.0 - tread));
        let holes = sharpness(blurred_rpm, self.wheel.holes, rate);
        self.holes.set(opacity(holes));
        self.hole_band.set(opacity(1.0 - holes));
        // In steps of two degrees, as above.
        let trail = (trail_deg(blurred_rpm, rate) / 2.0).round() * 2.0;
        self.trail.set(format!("{trail:.0} 360"));
        // The trail is drawn clockwise of the mark, which is right for one direction. The other one mirrors it.
        let side = if rpm < 0.0 {
            "scale(-1 1)"
        } else {
            "scale(1 1)"
        };
        self.trail_side.set(side.to_owned());
    }

    /// Draws the speed in steps of half an rpm, a quarter of a degree on the ring. Finer steps would redraw the ring
    /// with every report of a wheel at constant speed.
    fn paint_speed(&mut self, rpm: f64) {
        let rpm = (rpm * 2.0).round() / 2.0;
        let dash = self.scale.dash(rpm);
        self.speed_length.set(format!("{:.2} 999", dash.length));
        self.speed_start.set(format!("{:.2}", -dash.start));
        self.knob.rotate(self.scale.bearing_deg(rpm));
    }

    fn paint_goal(&mut self, goal: Option<Setpoint>) {
        match goal {
            Some(Setpoint::Velocity { speed, .. }) => {
                let bearing_deg = self.scale.bearing_deg(f64::from(speed.rpm()));
                self.goal_speed.rotate(bearing_deg);
            }
            Some(Setpoint::Brake) => self.goal_speed.rotate(0.0),
            Some(Setpoint::Position(target)) => {
                self.goal_angle.rotate(f64::from(target.degrees()));
            }
            Some(Setpoint::Current(_) | Setpoint::OpenLoop(_)) | None => {}
        }
    }
}

/// The states of the style sheet, as words of the attribute `data-look`.
fn look(view: &View) -> String {
    let motion = match view.motion {
        Motion::NoData => "stale",
        Motion::Stationary => "stands",
        Motion::Braking => "brakes",
        Motion::SpinningCw | Motion::SpinningCcw if view.driven => "drives",
        Motion::SpinningCw | Motion::SpinningCcw => "coasts",
    };
    let goal = match view.goal {
        Some(Setpoint::Velocity { .. } | Setpoint::Brake) => " goal-speed",
        Some(Setpoint::Position(_)) => " goal-angle",
        // The ring is a scale of speeds, so it has no pointer for a current.
        Some(Setpoint::Current(_) | Setpoint::OpenLoop(_)) | None => "",
    };
    let driven = if view.driven { " goal-driven" } else { "" };
    [motion, goal, driven].concat()
}

/// An opacity in steps of a twentieth: each change inside the turning layer rasterizes it again.
fn opacity(part: f64) -> String {
    format!("{:.2}", (part * 20.0).round() / 20.0)
}
