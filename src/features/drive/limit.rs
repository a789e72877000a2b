//! The limits of Settings, where one drives.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::bus::{Limits, Refusal};

use crate::{
    model::{page::Page, terms},
    ui::{
        drawer::Drawer,
        format,
        reactive::{dynamic, handler},
    },
};

/// The speed limit in rpm that the bus has.
pub(crate) fn speed_limit(page: Page) -> i32 {
    let limits = page.preferences.with(|chosen| chosen.limits);
    limits.speed_rpm().into()
}

/// Why this speed is refused.
pub(crate) fn speed_refused(page: Page, rpm: i32) -> Option<String> {
    let limit = page.preferences.with(|chosen| chosen.limits).speed_rpm();
    is_beyond(rpm, limit).then(|| terms::refusal(Refusal::AboveSpeedLimit(limit)))
}

/// The same reason, or why this speed is refused.
pub(crate) fn or_refused(
    page: Page,
    reason: Signal<Option<String>>,
    rpm: impl Fn() -> i32 + Send + Sync + 'static,
) -> Signal<Option<String>> {
    Signal::derive(move || reason.get().or_else(|| speed_refused(page, rpm())))
}

fn is_beyond(rpm: i32, limit: u16) -> bool {
    rpm.unsigned_abs() > limit.into()
}

/// What a limit is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Speed,
    Current,
}

impl Quantity {
    /// The limit in words; `None` if it is as high as the motor allows.
    fn limit(self, limits: Limits) -> Option<String> {
        match self {
            Self::Speed => (limits.speed_rpm() < Limits::SPEED_RPM.1)
                .then(|| tr!("Limit: {limit} rpm", limit = limits.speed_rpm())),
            Self::Current => (limits.current_ma() < Limits::CURRENT_MA.1).then(|| {
                let limit = format::milliamps(limits.current_ma());
                tr!("Limit: {limit} A", limit)
            }),
        }
    }
}

/// Button `Limit: 60 rpm`: opens the panel Settings.
#[component]
pub(crate) fn LimitLink(page: Page, quantity: Quantity) -> impl IntoView {
    let words = move || {
        page.preferences
            .with(|chosen| quantity.limit(chosen.limits))
    };
    view! {
        <button
            type="button"
            class="help-link"
            title=tr!("Change it in Settings")
            hidden=dynamic(move || words().is_none())
            on:click=handler(move |_| page.drawer.set(Some(Drawer::Settings)))
        >
            {dynamic(move || words().unwrap_or_default())}
        </button>
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_shown_unless_it_is_the_highest() {
        let all = Limits::new(330, 8_000, 80).unwrap();
        assert_eq!(Quantity::Speed.limit(all), None);
        assert_eq!(Quantity::Current.limit(all), None);
        let low = Limits::new(60, 2_700, 75).unwrap();
        assert_eq!(Quantity::Speed.limit(low).as_deref(), Some("Limit: 60 rpm"));
        assert_eq!(
            Quantity::Current.limit(low).as_deref(),
            Some("Limit: 2.7 A")
        );
    }

    #[test]
    fn a_speed_beyond_the_limit_is_refused_in_both_directions() {
        for (rpm, refused) in [(60, false), (-60, false), (61, true), (-61, true)] {
            assert_eq!(is_beyond(rpm, 60), refused, "{rpm}");
        }
    }
}
