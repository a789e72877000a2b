//! What an operator does in the tab `Raw Hex`, and what the page does about it.

use crate::{
    model::{
        page::{Dialog, Page, RawOrder},
        terms,
        tool_entry::interval,
    },
    ui::{format, target::Target},
};
use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    Notice,
    bus::{Command, Consent, Refusal, Repeat, is_hazardous},
    protocol::{Frame, Layout, Mode, MotorId, Request},
};

/// As many as one can watch.
const FIRST_COUNT: i32 = 10;

/// As often as a motor is driven at first, so that a drive frame that is repeated turns it evenly.
const FIRST_INTERVAL_MS: i32 = 20;

/// The tab `Raw Hex`: what was entered for a frame, and what is known of the last one beside what the bus tells.
#[derive(Clone, Copy)]
pub(crate) struct Raw {
    pub(crate) page: Page,
    /// What stands in the textbox.
    pub(crate) text: RwSignal<String>,
    pub(crate) repeats: RwSignal<bool>,
    /// How often, where it repeats; 0 is until stopped.
    pub(crate) count: Target,
    /// In milliseconds.
    pub(crate) interval: Target,
    /// Why the last one was not sent.
    pub(crate) refused: RwSignal<Option<String>>,
    /// The last one that was given to the bus, until a stop makes it moot.
    pending: StoredValue<Option<RawOrder>>,
    /// What the operator was asked about last, and meant. Of another frame, or of this one where it
    /// means something else, nothing was agreed.
    agreed: StoredValue<Option<(RawOrder, Mode)>>,
}

impl Raw {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            text: RwSignal::new(String::new()),
            repeats: RwSignal::new(false),
            count: Target::new(FIRST_COUNT),
            interval: Target::new(FIRST_INTERVAL_MS),
            refused: RwSignal::new(None),
            pending: StoredValue::new(None),
            agreed: StoredValue::new(None),
        }
    }

    /// A stop: a refusal that comes late asks nothing any more.
    pub(crate) fn forget_pending(self) {
        self.pending.set_value(None);
    }

    /// The port is closed or lost: nothing was agreed for the next.
    pub(crate) fn forget(self) {
        self.forget_pending();
        self.agreed.set_value(None);
    }

    fn repeat(self) -> Repeat {
        let count = u32::try_from(self.count.get_untracked()).unwrap_or_default();
        match interval(self.interval.get_untracked()) {
            Some(interval) if self.repeats.get_untracked() => Repeat::Times { count, interval },
            _ => Repeat::Once,
        }
    }
}

impl Raw {
    /// Sends a frame as often as entered; one that can move a wheel after a question, unless just this
    /// was agreed to.
    pub(crate) fn send_raw(self, frame: Frame) {
        let repeat = self.repeat();
        let order = RawOrder { frame, repeat };
        let meant = self.what_is_meant(order);
        let agreed = meant.is_some() && self.agreed.get_value() == meant;
        if is_hazardous(&frame) && !agreed {
            self.page.dialog.set(Some(Dialog::Hazard(order)));
        } else {
            self.send_order(order, Consent::None);
        }
    }

    /// The frame, how often, and the loop that its motor reports. `None` where that is not known,
    /// or the frame is not for one motor: then it is asked about each time.
    fn what_is_meant(self, order: RawOrder) -> Option<(RawOrder, Mode)> {
        let id = Request::parse(&order.frame).ok()?.addressee()?;
        let mode = self.page.latest.with_value(|session| session.mode(id))?;
        Some((order, mode.value))
    }

    /// The operator means it, and is not asked again about the same.
    pub(crate) fn send_hazard(self, order: RawOrder) {
        self.agreed.set_value(self.what_is_meant(order));
        self.send_order(order, Consent::None);
    }

    pub(crate) fn send_order(self, order: RawOrder, consent: Consent) {
        let RawOrder { frame, repeat } = order;
        self.refused.set(None);
        self.pending.set_value(Some(order));
        self.page.command(Command::SendRaw {
            frame,
            repeat,
            consent,
        });
    }

    /// Sends the frame no more, and stops what it may have moved.
    pub(crate) fn stop_raw(self) {
        self.forget_pending();
        self.page.command(Command::StopRaw);
    }

    /// Writes an example into the textbox: the query with this answer.
    pub(crate) fn write_example(self, reply_layout: Layout) {
        let id: MotorId = self.page.selected.get_untracked();
        let request = match reply_layout {
            Layout::Query => Request::Query { id },
            Layout::Drive => Request::IdQuery,
        };
        self.text.set(request.frame().to_string());
    }

    /// What the worker tells of a frame that was not sent.
    pub(crate) fn notice(self, notice: &Notice) {
        let (frame, repeat, refusal) = match notice {
            Notice::Refused {
                command: Command::SendRaw { frame, repeat, .. },
                refusal,
            } => (*frame, *repeat, *refusal),
            Notice::TooLate(Command::SendRaw { .. }) => {
                let words = tr!("Too late: the page was busy. Press Send again.");
                return self.refused.set(Some(words.to_owned()));
            }
            _ => return,
        };
        let order = RawOrder { frame, repeat };
        let pending = self.pending.get_value() == Some(order);
        match refusal {
            // Asked about each time, unless a stop came between.
            Refusal::NeedsConsent(current)
                if pending && self.page.dialog.get_untracked().is_none() =>
            {
                self.page
                    .dialog
                    .set(Some(Dialog::HighRawCurrent { order, current }));
            }
            Refusal::NeedsConsent(current) => {
                let amps = format::amps_of(current);
                let words = tr!(
                    "{amps} is above 6.1 A. Press Send again, then confirm.",
                    amps
                );
                self.refused.set(Some(words));
            }
            refusal => self.refused.set(Some(terms::refusal(refusal))),
        }
    }
}

/// Whether this notice is one that the raw editor shows itself.
pub(crate) fn belongs_to_raw_editor(notice: &Notice) -> bool {
    match notice {
        Notice::Refused { command, .. } | Notice::TooLate(command) => {
            matches!(command, Command::SendRaw { .. } | Command::StopRaw)
        }
        _ => false,
    }
}
