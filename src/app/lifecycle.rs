//! Handles a hidden, frozen or closed page; the title shows what turns.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::bus::{Activity, MotorStatus, StopReason};
use web_sys::VisibilityState;

use crate::{
    app::features::Features,
    model::snapshot::Session,
    ui::{
        clock::page_now_ms,
        format,
        listener::on_window,
        reactive::{effect, memo},
    },
};

/// How long the last handler of a closing page runs while a wheel may turn. The worker ends with that handler,
/// and braking a wheel from 100 rpm takes about 200 ms of frames. Nothing asynchronous survives the
/// handler, so this is a bounded busy wait.
///
/// It waits whenever rest is not known, not only while the page drives: a motor that has fallen silent may have lost its
/// replies alone, and then hears its stop, and it keeps its last command for ever if it gets none. A quarter of a second
/// is the price of that. A page on which nothing was driven, or every motor has confirmed its stop, closes at once.
const LAST_FRAMES_MS: f64 = 250.0;

const TITLE: &str = "MotorLink";

/// Stops the motors when the page is closed, and if the operator wants it, when it is hidden.
pub(crate) fn watch(features: Features) {
    on_window("pagehide", move |_| leave(features));
    on_window("freeze", move |_| leave(features));
    on_window("visibilitychange", move |_| visibility_changed(features));

    let title = memo(move || features.page.shown.with(title));
    effect(move || document().set_title(&title.get()));
}

fn leave(features: Features) {
    let may_turn = features
        .page
        .latest
        .with_value(|session| !session.is_known_to_rest());
    features.stop_all(StopReason::PageGone);
    if may_turn {
        let begun_ms = page_now_ms();
        while page_now_ms() - begun_ms < LAST_FRAMES_MS {
            std::hint::spin_loop();
        }
    }
}

fn visibility_changed(features: Features) {
    if document().visibility_state() != VisibilityState::Hidden {
        features.page.show();
        return;
    }
    let keep_driving = features
        .page
        .preferences
        .with_untracked(|chosen| chosen.keep_driving);
    if !keep_driving {
        features.stop_all(StopReason::PageHidden);
    }
}

/// `● +100 rpm - MotorLink` while a motor is driven, so that a hidden page shows what turns.
fn title(session: &Session) -> String {
    let said = |motor: &MotorStatus| match motor.activity {
        Activity::Driven { setpoint } => Some(format::goal(setpoint)),
        Activity::DrivenRaw => Some(tr!("raw frames").to_owned()),
        Activity::Stopping { confirmed: false } => Some(tr!("stopping").to_owned()),
        Activity::Stopping { confirmed: true } | Activity::Switching { .. } | Activity::Idle => {
            None
        }
    };
    // None in a recording, which has a title of its own.
    let driven: Vec<String> = session.active_motors().filter_map(said).collect();
    match driven.as_slice() {
        [] => TITLE.to_owned(),
        [one] => format!("● {one} - {TITLE}"),
        several => format!(
            "● {} - {TITLE}",
            tr!("{motors} motors", motors = several.len())
        ),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{CurrentTarget, Mode, Setpoint, SpeedTarget};

    use super::*;
    use crate::model::snapshot::tests::{session, status};

    fn title_with(activities: &[Activity]) -> String {
        let mut session = session(0, status(0, Mode::Velocity, 0));
        session.motors = activities
            .iter()
            .map(|activity| MotorStatus {
                activity: *activity,
                ..status(0, Mode::Velocity, 0)
            })
            .collect();
        title(&session)
    }

    #[test]
    fn the_title_says_what_turns() {
        let driven = |setpoint| Activity::Driven { setpoint };
        let fast = driven(Setpoint::velocity(SpeedTarget::clamped(100)));
        let amps = driven(Setpoint::Current(CurrentTarget::from_amps(-0.5)));
        assert_eq!(title_with(&[Activity::Idle]), "MotorLink");
        assert_eq!(title_with(&[fast]), "● +100 rpm - MotorLink");
        assert_eq!(title_with(&[amps]), "● \u{2212}0.50 A - MotorLink");
        assert_eq!(title_with(&[fast, amps]), "● 2 motors - MotorLink");
        assert_eq!(
            title_with(&[Activity::DrivenRaw]),
            "● raw frames - MotorLink"
        );
        let stopping = Activity::Stopping { confirmed: false };
        assert_eq!(title_with(&[stopping]), "● stopping - MotorLink");
    }
}
