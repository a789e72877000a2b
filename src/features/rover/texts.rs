//! The motion and the path of the vehicle as text.

use motorlink_i18n::{terms::in_language, tr};
use motorlink_messages::{experiments::vehicle::Motion, protocol::MotorId};

use crate::ui::{
    format::{UNKNOWN, signed_decimal},
    mathematics::modulo,
};

/// The figures below the drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Figures {
    pub(crate) forward: String,
    pub(crate) turn: String,
    pub(crate) driven: String,
    pub(crate) heading: String,
    /// Gaps of the path, and a wheel whose angle does not count.
    pub(crate) path_notes: String,
}

impl Figures {
    /// `motion` is `None` while a side is unknown.
    pub(crate) fn new(motion: Option<Motion>, driven_mm: f64, heading_deg: f64) -> Self {
        Self {
            forward: [&forward(motion), " m/s"].concat(),
            turn: [
                &signed(motion.map(|motion| motion.turn_deg_per_s), 0),
                " °/s",
            ]
            .concat(),
            driven: in_language(format!("{:.2} m", driven_mm / 1e3)),
            heading: [&heading(heading_deg), "°"].concat(),
            path_notes: String::new(),
        }
    }

    pub(crate) fn with_path(self, gaps: u32, misfit: Option<MotorId>) -> Self {
        let gaps = match gaps {
            0 => None,
            1 => Some(tr!("1 gap").to_owned()),
            gaps => Some(tr!("{gaps} gaps", gaps)),
        };
        let by_speed = |id| {
            tr!(
                "Path by speed: the angle of motor {id} does not follow its speed",
                id
            )
        };
        let notes: Vec<String> = gaps.into_iter().chain(misfit.map(by_speed)).collect();
        Self {
            path_notes: notes.join(". "),
            ..self
        }
    }

    /// The drawing in words.
    pub(crate) fn description(&self) -> String {
        let Self {
            forward,
            turn,
            driven,
            heading,
            path_notes,
        } = self;
        let said = tr!(
            "Forward {forward}, turn {turn}. Driven {driven}, heading {heading}.",
            forward,
            turn,
            driven,
            heading
        );
        if path_notes.is_empty() {
            said
        } else {
            format!("{said} {path_notes}.")
        }
    }
}

/// `+0.53`, in m/s.
pub(crate) fn forward(motion: Option<Motion>) -> String {
    signed(motion.map(|motion| motion.forward_mm_per_s / 1e3), 2)
}

/// `71`, in degrees: 359.6 is 0, not 360, and -0.4 is 0, not -0.
pub(crate) fn heading(heading_deg: f64) -> String {
    format!("{:.0}", modulo(heading_deg.round() + 0.0, 360.0))
}

#[allow(clippy::cast_possible_truncation, reason = "a few digits are shown")]
fn signed(value: Option<f64>, decimals: usize) -> String {
    let known = value.map(|value| signed_decimal(value as f32, decimals));
    known.unwrap_or_else(|| UNKNOWN.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_has_signs_and_what_is_unknown_has_none() {
        let motion = Motion {
            forward_mm_per_s: 533.8,
            turn_deg_per_s: -38.4,
        };
        let figures = Figures::new(Some(motion), 3_421.0, 377.6);
        assert_eq!(
            figures.description(),
            "Forward +0.53 m/s, turn \u{2212}38 °/s. Driven 3.42 m, heading 18°."
        );
        let still = Figures::new(Some(Motion::default()), 0.0, -0.4).with_path(1, None);
        assert_eq!(
            still.description(),
            "Forward 0.00 m/s, turn 0 °/s. Driven 0.00 m, heading 0°. 1 gap."
        );
        let unknown = Figures::new(None, 0.0, 359.6).with_path(3, Some(MotorId::FIRST));
        assert_eq!(
            unknown.description(),
            "Forward – m/s, turn – °/s. Driven 0.00 m, heading 0°. 3 gaps. \
             Path by speed: the angle of motor 0x01 does not follow its speed."
        );
    }
}
