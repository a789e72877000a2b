//! Rate, limits and ramp, remembered and sent to the bus.

use leptos::prelude::*;
use motorlink_messages::bus::{Command, CommandRate, Limits};

use crate::{
    model::{
        drive_settings::RAMP_STORED_AS, guards::stop_blocked_by, page::Page, preferences::remember,
    },
    ui::target::Target,
};

impl Page {
    pub(crate) fn set_rate(self, hertz: i32) {
        let rate = u16::try_from(hertz).ok().map(CommandRate::new);
        if let Some(Ok(rate)) = rate {
            self.prefer(|preferences| preferences.rate = rate);
            self.send_rate();
        }
    }

    /// Sends the rate to the bus; each opened port has a new bus.
    pub(crate) fn send_rate(self) {
        let rate = self.preferences.with_untracked(|chosen| chosen.rate);
        if self.is_connected() {
            self.command(Command::SetRate(rate));
        }
    }

    /// Applies the entered limits. Each is in its range.
    pub(crate) fn set_limits(self) {
        let whole = |target: Target| u16::try_from(target.get_untracked()).unwrap_or(0);
        let limits = Limits::new(
            whole(self.settings.speed_limit),
            whole(self.settings.current_limit),
            whole(self.settings.temperature_limit),
        );
        if let Ok(limits) = limits {
            self.prefer(|preferences| preferences.limits = limits);
            self.send_limits();
        }
    }

    /// The worker keeps them for every port that is opened.
    pub(crate) fn send_limits(self) {
        let limits = self.preferences.with_untracked(|chosen| chosen.limits);
        self.command(Command::SetLimits(limits));
    }

    pub(crate) fn set_ramp(self) {
        let ramp = self.settings.ramp.get_untracked();
        remember(RAMP_STORED_AS, &ramp.to_string());
        if self.is_connected() {
            self.send_ramp();
        }
    }

    /// Sends the entered ramp to the bus of a new port, which has the ramp of the previous port.
    pub(crate) fn send_ramp(self) {
        self.command(Command::SetRamp(self.settings.entered_ramp()));
    }

    fn is_connected(self) -> bool {
        self.latest
            .with_value(|session| stop_blocked_by(session).is_none())
    }
}
