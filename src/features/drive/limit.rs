//! The limits of Settings, where one drives.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Limits, Refusal},
    protocol::family::Model,
};

use crate::{
    model::{page::Page, place::Place, terms},
    ui::{
        format,
        reactive::{dynamic, handler},
    },
};

/// The highest current, that of the model or the limit of Settings: as a raw setpoint, and in amps.
pub(crate) fn current_limit(page: Page) -> (i32, String) {
    let of_settings = page.preferences.with(|chosen| chosen.limits).current_ma();
    let milliamps = page.current_max_ma().min(of_settings.into());
    let milliamps = u16::try_from(milliamps).unwrap_or(of_settings);
    (raw(milliamps), format::milliamps(milliamps))
}

/// Full scale, 32,767, is 8 A. Rounded down, so that the current is not above its limit.
fn raw(milliamps: u16) -> i32 {
    i32::from(milliamps) * i32::from(i16::MAX) / i32::from(Limits::CURRENT_MA.1)
}

/// Why this speed is refused.
pub(crate) fn speed_refused(page: Page, rpm: i32) -> Option<String> {
    let limit = page.preferences.with(|chosen| chosen.limits).speed_rpm();
    refusal(rpm, limit, page.model.get()).map(terms::refusal)
}

/// The same reason, or why this speed is refused.
pub(crate) fn or_refused(
    page: Page,
    reason: Signal<Option<String>>,
    rpm: impl Fn() -> i32 + Send + Sync + 'static,
) -> Signal<Option<String>> {
    Signal::derive(move || reason.get().or_else(|| speed_refused(page, rpm())))
}

fn refusal(rpm: i32, limit: u16, model: Model) -> Option<Refusal> {
    let is_beyond = |most: u16| rpm.unsigned_abs() > most.into();
    if is_beyond(model.spec().speed_rpm_max) {
        Some(Refusal::AboveSpeedOfModel(model))
    } else {
        is_beyond(limit).then_some(Refusal::AboveSpeedLimit(limit))
    }
}

/// What a limit is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Speed,
    Current,
}

impl Quantity {
    /// The limit in words; `None` if it is as high as the motor allows.
    fn limit(self, limits: Limits, model: Model) -> Option<String> {
        let spec = model.spec();
        match self {
            Self::Speed => (limits.speed_rpm() < spec.speed_rpm_max)
                .then(|| tr!("Limit: {limit} rpm", limit = limits.speed_rpm())),
            Self::Current => (limits.current_ma() < spec.current.milliamps()).then(|| {
                let limit = format::milliamps(limits.current_ma());
                tr!("Limit: {limit} A", limit)
            }),
        }
    }
}

/// Button `Limit: 60 rpm`: opens the place with the panel Settings.
#[component]
pub(crate) fn LimitLink(page: Page, quantity: Quantity) -> impl IntoView {
    let words = move || {
        page.preferences
            .with(|chosen| quantity.limit(chosen.limits, page.model.get()))
    };
    view! {
        <button
            type="button"
            class="help-link"
            title=tr!("Change it in Settings")
            hidden=dynamic(move || words().is_none())
            on:click=handler(move |_| page.open(Place::Setup))
        >
            {dynamic(move || words().unwrap_or_default())}
        </button>
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::CurrentTarget;

    use super::*;

    #[test]
    fn a_limit_is_shown_unless_it_is_the_highest() {
        let all = Limits::new(330, 8_000, 80).unwrap();
        let of = |quantity: Quantity, limits| quantity.limit(limits, Model::Ddsm115);
        assert_eq!(of(Quantity::Speed, all), None);
        assert_eq!(of(Quantity::Current, all), None);
        let low = Limits::new(60, 2_700, 75).unwrap();
        assert_eq!(of(Quantity::Speed, low).as_deref(), Some("Limit: 60 rpm"));
        assert_eq!(of(Quantity::Current, low).as_deref(), Some("Limit: 2.7 A"));
        assert_eq!(Quantity::Speed.limit(all, Model::Ddsm210), None);
        let fast = Quantity::Speed.limit(all, Model::Ddsm400);
        assert_eq!(fast.as_deref(), Some("Limit: 330 rpm"));
    }

    #[test]
    fn a_current_limit_is_a_raw_setpoint_that_is_not_above_it() {
        for (milliamps, expected) in [(8_000, 32_767), (2_700, 11_058), (100, 409)] {
            assert_eq!(raw(milliamps), expected);
            assert!(CurrentTarget::new(expected).is_ok());
        }
    }

    #[test]
    fn a_speed_beyond_the_limit_is_refused_in_both_directions() {
        for (rpm, refused) in [(60, false), (-60, false), (61, true), (-61, true)] {
            let refusal = refusal(rpm, 60, Model::Ddsm115);
            assert_eq!(refusal.is_some(), refused, "{rpm}");
        }
        // Another limit would not help.
        for rpm in [211, -380] {
            let of_model = Refusal::AboveSpeedOfModel(Model::Ddsm210);
            assert_eq!(refusal(rpm, 60, Model::Ddsm210), Some(of_model), "{rpm}");
        }
    }
}
