//! How the wheels of the models differ in the picture.
//!
//! Only the wheel of a DDSM115 has published measures. The others are drawn by eye, so that a person sees which model
//! the page shows.

use motorlink_messages::protocol::family::Model;

/// What differs between wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Size of the wheel, relative to a DDSM115.
    pub size: f64,
    /// Size of hub and cover on that wheel, relative to a DDSM115: a smaller hub has a wider tyre.
    pub hub: f64,
    /// Number of tread blocks.
    pub tread_blocks: u16,
    /// How far the tread leans forward, in degrees.
    pub tread_lean_deg: f64,
    /// Width of a tread block at the ground, in degrees.
    pub tread_tip_deg: f64,
    /// Number of holes in the hub.
    pub holes: u16,
    /// Number of screws in the cover.
    pub screws: u16,
    /// Greatest speed of the ring in rpm.
    pub speed_rpm_max: u16,
}

impl Look {
    /// Of a model.
    #[must_use]
    pub const fn of(model: Model) -> Self {
        let speed_rpm_max = model.spec().speed_rpm_max;
        let ddsm115 = Self {
            size: 1.0,
            hub: 1.0,
            tread_blocks: 32,
            tread_lean_deg: 6.5,
            tread_tip_deg: 6.2,
            holes: 18,
            screws: 3,
            speed_rpm_max,
        };
        match model {
            Model::Ddsm115 => ddsm115,
            // Larger, with a wide tyre.
            Model::Ddsm315 => Self {
                size: 1.07,
                hub: 0.84,
                tread_blocks: 20,
                tread_lean_deg: 9.0,
                tread_tip_deg: 11.0,
                holes: 12,
                screws: 6,
                ..ddsm115
            },
            // Small.
            Model::Ddsm210 => Self {
                size: 0.74,
                hub: 1.06,
                tread_blocks: 48,
                tread_lean_deg: 0.0,
                tread_tip_deg: 4.2,
                holes: 10,
                ..ddsm115
            },
            // Larger, with a block tread.
            Model::Ddsm400 => Self {
                size: 1.05,
                hub: 0.94,
                tread_blocks: 24,
                tread_lean_deg: 0.0,
                tread_tip_deg: 9.0,
                holes: 24,
                screws: 4,
                ..ddsm115
            },
        }
    }
}
