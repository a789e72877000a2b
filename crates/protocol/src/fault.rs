//! The faults that a motor of any model may report.

/// A protection or defect that a motor reports.
///
/// | bit | DDSM115, DDSM315 | DDSM210 | DDSM400 |
/// |---|---|---|---|
/// | 0 | sensor | | sensor |
/// | 1 | bus overcurrent | overcurrent | overcurrent |
/// | 2 | phase overcurrent | | |
/// | 3 | stall | | stall |
/// | 4 | over-temperature | over-temperature | over-temperature |
/// | 5 | | | disconnected |
/// | 6 | | | over- or undervoltage |
///
/// Source: the maker's manual for the DDSM115, two clients for the others. One published table calls bit 4
/// of a DDSM115 "troubleshooting".
///
/// | of a DDSM115 | trips at | clears |
/// |---|---|---|
/// | sensor | encoder defect | not known |
/// | bus overcurrent | 3 A | after 5 s |
/// | phase overcurrent | 4.6 A | after 5 s |
/// | stall | blocked over 5 s | after 5 s |
/// | over-temperature | 80 °C | below 75 °C |
///
/// When a protection of the others trips and clears is not published, except the 80 °C of a DDSM210.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The encoder fails.
    Sensor,
    /// The supply current is too high.
    BusOvercurrent,
    /// A phase current is too high.
    PhaseOvercurrent,
    /// Too much current, of the supply or of a phase.
    Overcurrent,
    /// The wheel is blocked.
    Stall,
    /// The winding is too hot.
    OverTemperature,
    /// The motor reports that it is disconnected. No source says from what.
    Disconnected,
    /// The supply voltage is too high or too low.
    Voltage,
}

impl Fault {
    /// Its bit in the fault byte.
    #[must_use]
    pub const fn mask(self) -> u8 {
        match self {
            Self::Sensor => 1,
            Self::BusOvercurrent | Self::Overcurrent => 1 << 1,
            Self::PhaseOvercurrent => 1 << 2,
            Self::Stall => 1 << 3,
            Self::OverTemperature => 1 << 4,
            Self::Disconnected => 1 << 5,
            Self::Voltage => 1 << 6,
        }
    }

    /// Short name, in lower case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::BusOvercurrent => "bus overcurrent",
            Self::PhaseOvercurrent => "phase overcurrent",
            Self::Overcurrent => "overcurrent",
            Self::Stall => "stall",
            Self::OverTemperature => "over-temperature",
            Self::Disconnected => "disconnected",
            Self::Voltage => "over- or undervoltage",
        }
    }
}
