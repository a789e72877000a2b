//! Draws the vehicle by setting a few attributes, and only those that differ.

use motorlink_messages::{
    bus::Activity,
    experiments::vehicle::{Geometry, Motion, Vehicle, Wheel},
    protocol::{MotorId, Setpoint},
};
use web_sys::Element;

use crate::{
    features::rover::{
        arrow::arrow,
        picture::{BAR_MM_PER_RPM, Scale},
        readings::{Card, card},
        texts::Figures,
        tread,
        trip::Trip,
    },
    model::snapshot::{Reading, Session},
    ui::{
        attribute::Attribute,
        frame_rate::frame_rate,
        mathematics::{limited, modulo},
        text::Text,
    },
};

/// The map shows at least so much around the path, in mm.
const MAP_MARGIN_MM: f64 = 300.0;
/// A map is this many times as wide as the arrow on it.
const MAP_OF_ARROW: f64 = 12.0;

/// The parts of one wheel, in the drawing and on its card.
struct WheelParts {
    wheel: Wheel,
    look: Attribute,
    blocks: Attribute,
    block_opacity: Attribute,
    mark: Attribute,
    mark_opacity: Attribute,
    commanded: Attribute,
    measured: Attribute,
    card_look: Attribute,
    speed: Text,
    rest: Text,
    trouble: Text,
}

/// The speeds of a wheel in rpm, + is forward; `None` where it is unknown or not commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Speeds {
    pub(crate) measured: Option<f64>,
    pub(crate) commanded: Option<f64>,
}

/// The moving parts of a mounted drawing.
pub(crate) struct Painter {
    vehicle: Vehicle,
    geometry: Geometry,
    scale: Scale,
    wheels: Vec<WheelParts>,
    description: Text,
    ground: Attribute,
    grid: Attribute,
    trail: Attribute,
    path: [Attribute; 3],
    commanded: Attribute,
    measured: Attribute,
    map: Attribute,
    here: Attribute,
    figures: [Text; 5],
}

impl Painter {
    /// Finds the moving parts; `None` if the panel has not the drawing of this vehicle.
    pub(crate) fn of(panel: &Element, vehicle: &Vehicle, geometry: Geometry) -> Option<Self> {
        let find = |selector, name| Attribute::find(panel, selector, name);
        let wheels = vehicle
            .wheels()
            .iter()
            .map(|wheel| wheel_parts(panel, wheel));
        Some(Self {
            vehicle: vehicle.clone(),
            geometry,
            scale: Scale::of(vehicle, geometry),
            wheels: wheels.collect::<Option<_>>()?,
            description: Text::find(panel, "desc")?,
            ground: find(".rover-ground", "transform")?,
            grid: find(".rover-grid", "transform")?,
            trail: find(".rover-trail", "transform")?,
            path: [
                find(".rover-known", "d")?,
                find(".rover-bridged", "d")?,
                find(".rover-gaps", "d")?,
            ],
            commanded: find(".rover-arrow.commanded", "d")?,
            measured: find(".rover-arrow.measured", "d")?,
            map: find(".rover-map", "viewBox")?,
            here: find(".rover-here", "transform")?,
            figures: [
                Text::find(panel, "#rover-forward")?,
                Text::find(panel, "#rover-turn")?,
                Text::find(panel, "#rover-driven")?,
                Text::find(panel, "#rover-heading")?,
                Text::find(panel, "#rover-gap-count")?,
            ],
        })
    }

    /// Draws the present state. The session has the operator's signs. Returns whether anything moves.
    pub(crate) fn paint(&mut self, session: &Session, trip: &Trip) -> bool {
        let mut moves = false;
        let (mut measured, mut commanded) = (Vec::new(), Vec::new());
        for parts in &mut self.wheels {
            let speeds = speeds(session, parts.wheel.id);
            parts.paint(session, speeds, self.scale);
            moves |= [speeds.measured, speeds.commanded]
                .iter()
                .flatten()
                .any(|rpm| *rpm != 0.0);
            measured.push(speeds.measured);
            commanded.push(speeds.commanded);
        }
        let motion = |rpm: &[_]| Motion::of(&self.vehicle, self.geometry, rpm);
        let (measured, commanded) = (motion(&measured), motion(&commanded));
        let arrow = |motion: Option<Motion>| {
            let arrow = motion.map(|motion| arrow(motion, self.geometry, self.scale.nose));
            arrow.unwrap_or_default()
        };
        let (arrow_measured, arrow_commanded) = (arrow(measured), arrow(commanded));
        self.measured.set(arrow_measured);
        self.commanded.set(arrow_commanded);
        self.paint_ground(trip);
        let (pose, path) = (trip.pose(), trip.path());
        let figures = Figures::new(measured, trip.driven_mm(), pose.heading_deg)
            .with_path(path.gaps(), trip.misfit());
        self.description.set(&figures.description());
        let Figures {
            forward,
            turn,
            driven,
            heading,
            path_notes,
        } = figures;
        for (words, text) in self
            .figures
            .iter_mut()
            .zip([forward, turn, driven, heading, path_notes])
        {
            words.set(&text);
        }
        moves
    }

    fn paint_ground(&mut self, trip: &Trip) {
        let pose = trip.pose();
        self.ground.rotate(-modulo(pose.heading_deg, 360.0));
        let by = |x: f64, y: f64| format!("translate({x:.1} {y:.1})");
        let grid = self.scale.grid;
        // The ground moves against the vehicle.
        self.grid
            .set(by(-modulo(pose.x, grid), modulo(pose.y, grid)));
        self.trail.set(by(-pose.x, pose.y));
        for (attribute, line) in self.path.iter_mut().zip(trip.path().lines()) {
            attribute.set(line);
        }
        let [left, top, right, bottom] = trip.path().bounds();
        let size = (right - left).max(bottom - top) + 2.0 * MAP_MARGIN_MM;
        let (x, y) = (f64::midpoint(left, right), f64::midpoint(top, bottom));
        self.map.set(format!(
            "{:.0} {:.0} {size:.0} {size:.0}",
            x - size / 2.0,
            y - size / 2.0
        ));
        self.here.set(format!(
            "translate({:.0} {:.0}) rotate({:.0}) scale({:.1})",
            pose.x,
            -pose.y,
            modulo(pose.heading_deg, 360.0),
            size / MAP_OF_ARROW
        ));
    }
}

impl WheelParts {
    fn paint(&mut self, session: &Session, speeds: Speeds, scale: Scale) {
        let Card {
            speed,
            rest,
            trouble,
            look,
        } = card(session, self.wheel.id);
        self.look.set(look.to_owned());
        self.card_look.set(look.to_owned());
        self.speed.set(&speed);
        self.rest.set(&rest);
        self.trouble.set(&trouble);
        let rpm = speeds.measured.unwrap_or_default();
        if let Some(rolled) = rolled_deg(session, &self.wheel, rpm) {
            let width = scale.half_tyre * 0.86;
            self.blocks.set(tread::blocks(rolled, scale.radius, width));
            self.mark.set(tread::mark(rolled, scale.radius, width));
        }
        let [blocks, mark] = tread::opacities(rpm, frame_rate());
        self.block_opacity.set(blocks);
        self.mark_opacity.set(mark);
        self.measured.set(bar(speeds.measured));
        self.commanded.set(bar(speeds.commanded));
    }
}

fn wheel_parts(panel: &Element, wheel: &Wheel) -> Option<WheelParts> {
    let number = wheel.id.get();
    let one = |selector: String| panel.query_selector(&selector).ok().flatten();
    let drawn = one(format!("[data-wheel='{number}']"))?;
    let card = one(format!("[data-card='{number}']"))?;
    let find = |selector, name| Attribute::find(&drawn, selector, name);
    Some(WheelParts {
        wheel: wheel.clone(),
        blocks: find(".rover-blocks", "d")?,
        block_opacity: find(".rover-blocks", "opacity")?,
        mark: find(".rover-mark", "d")?,
        mark_opacity: find(".rover-mark", "opacity")?,
        commanded: find(".rover-bar.commanded", "d")?,
        measured: find(".rover-bar.measured", "d")?,
        look: Attribute::of(drawn, "data-look"),
        speed: Text::find(&card, ".rover-speed span")?,
        rest: Text::find(&card, ".rover-rest")?,
        trouble: Text::find(&card, ".rover-trouble")?,
        card_look: Attribute::of(card, "data-look"),
    })
}

/// The present speeds of a wheel. The session has the operator's signs.
pub(crate) fn speeds(session: &Session, id: MotorId) -> Speeds {
    let speed = session.speed(id).filter(Reading::is_fresh);
    let activity = session.motor(id).map(|motor| motor.activity);
    Speeds {
        measured: speed.map(|reading| f64::from(reading.value.rpm())),
        commanded: match activity {
            Some(Activity::Driven {
                setpoint: Setpoint::Velocity { speed, .. },
            }) => Some(f64::from(speed.rpm())),
            Some(
                Activity::Stopping { .. }
                | Activity::Driven {
                    setpoint: Setpoint::Brake,
                },
            ) => Some(0.0),
            _ => None,
        },
    }
}

/// How far the wheel has rolled forward, by the reported angle and, since then, by the speed.
fn rolled_deg(session: &Session, wheel: &Wheel, rpm: f64) -> Option<f64> {
    let angle = session.angle(wheel.id)?;
    // The angle falls at positive speed.
    let reported = -wheel.forward_sign() * f64::from(angle.value.degrees());
    let since_s = if angle.is_fresh() {
        angle.age.as_secs_f64()
    } else {
        0.0
    };
    Some(reported + rpm * 6.0 * since_s)
}

/// The bar of a speed as path data; upwards is forward.
fn bar(rpm: Option<f64>) -> String {
    let length = |rpm: f64| limited(rpm, -330.0, 330.0) * BAR_MM_PER_RPM;
    rpm.filter(|rpm| *rpm != 0.0)
        .map_or_else(String::new, |rpm| format!("M0 0v{:.1}", -length(rpm)))
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{Mode, SpeedTarget};

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    #[test]
    fn commanded_is_the_setpoint_and_a_stop_is_zero() {
        let of = |activity| {
            let mut motor = status(1_000, Mode::Velocity, 80);
            motor.activity = activity;
            speeds(&session(1_016, motor), ID)
        };
        let setpoint = Setpoint::velocity(SpeedTarget::new(90).unwrap());
        let driven = of(Activity::Driven { setpoint });
        assert_eq!(
            (driven.measured, driven.commanded),
            (Some(80.0), Some(90.0))
        );
        assert_eq!(
            of(Activity::Stopping { confirmed: false }).commanded,
            Some(0.0)
        );
        assert_eq!(of(Activity::Idle).commanded, None);
        assert_eq!(of(Activity::DrivenRaw).commanded, None);
    }

    #[test]
    fn a_bar_points_the_way_the_wheel_goes_and_none_is_drawn_at_a_standstill() {
        assert_eq!(bar(Some(100.0)), "M0 0v-50.0");
        assert_eq!(bar(Some(-999.0)), "M0 0v165.0");
        assert_eq!(bar(Some(0.0)), "");
        assert_eq!(bar(None), "");
    }
}
