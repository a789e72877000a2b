//! Rate, limits and ramp, remembered and sent to the bus.

use leptos::prelude::*;
use motorlink_messages::bus::{BusSettings, Command, CommandRate, Limits};

use crate::{
    model::{drive_settings::RAMP_STORED_AS, local_storage::remember, page::Page},
    ui::target::Target,
};

impl Page {
    pub(crate) fn set_rate(self, hertz: i32) {
        let rate = u16::try_from(hertz).ok().map(CommandRate::new);
        if let Some(Ok(rate)) = rate {
            self.prefer(|preferences| preferences.rate = rate);
            self.send_settings();
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
            self.send_settings();
        }
    }

    pub(crate) fn set_ramp(self) {
        let ramp = self.settings.ramp.get_untracked();
        remember(RAMP_STORED_AS, &ramp.to_string());
        self.send_settings();
    }

    /// Sends all of them to the worker, which keeps them for every port that is opened.
    pub(crate) fn send_settings(self) {
        let settings = self.preferences.with_untracked(|chosen| BusSettings {
            rate: chosen.rate,
            ramp: self.settings.entered_ramp(),
            limits: chosen.limits,
            slow_brake_frames: false,
        });
        self.command(Command::Configure(settings));
    }
}
