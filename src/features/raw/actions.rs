//! Actions of the tab `Raw Hex`.

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
    bus::{Command, CommandKind, Consent, Refusal, Repeat, is_hazardous},
    protocol::{Frame, Layout, Mode, MotorId, Request},
};

/// As many as a user can follow.
const FIRST_COUNT: i32 = 10;

/// The default period of drive frames, so that a repeated drive frame turns the wheel evenly.
const FIRST_INTERVAL_MS: i32 = 20;

/// The tab `Raw Hex`: the entered frame, and the state of the last one that the bus does not report.
#[derive(Clone, Copy)]
pub(crate) struct Raw {
    pub(crate) page: Page,
    /// The content of the textbox.
    pub(crate) text: RwSignal<String>,
    pub(crate) repeats: RwSignal<bool>,
    /// Number of repeats; 0 is until stopped.
    pub(crate) count: Target,
    /// In milliseconds.
    pub(crate) interval: Target,
    /// Why the last frame was not sent.
    pub(crate) refused: RwSignal<Option<String>>,
    /// The last frame that was sent to the bus, until a stop.
    pending: StoredValue<Option<RawOrder>>,
    /// What the operator has confirmed last. It does not apply to another frame, nor to the same frame in another
    /// loop.
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

    /// After a stop, a late refusal opens no question.
    pub(crate) fn forget_pending(self) {
        self.pending.set_value(None);
    }

    /// The port is closed or lost: the confirmation does not apply to the next one.
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
    /// Sends a frame as often as entered. If it can move a wheel, asks first, unless the operator has just
    /// confirmed the same.
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

    /// The frame, the number of repeats, and the loop of its motor. `None` if the loop is unknown or the frame is not
    /// for one motor: then the page asks each time.
    fn what_is_meant(self, order: RawOrder) -> Option<(RawOrder, Mode)> {
        let id = Request::parse(&order.frame).ok()?.addressee()?;
        let mode = self.page.latest.with_value(|session| session.mode(id))?;
        Some((order, mode.value))
    }

    /// The operator has confirmed, and is not asked again about the same.
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

    /// Stops repeating the frame, and stops motors that it may have moved.
    pub(crate) fn stop_raw(self) {
        self.forget_pending();
        self.page.command(Command::StopRaw);
    }

    /// Writes an example into the textbox.
    pub(crate) fn write_example(self, reply_layout: Layout) {
        let id: MotorId = self.page.selected.get_untracked();
        let request = match reply_layout {
            Layout::Query => Request::Query { id },
            Layout::Drive => Request::IdQuery,
        };
        self.refused.set(None);
        self.text.set(request.frame().to_string());
    }

    /// Handles the refusal of a frame.
    pub(crate) fn notice(self, notice: &Notice) {
        let (frame, repeat, refusal) = match notice {
            Notice::Refused {
                command: CommandKind::SendRaw { frame, repeat },
                refusal,
            } => (*frame, *repeat, *refusal),
            Notice::TooLate(CommandKind::SendRaw { .. }) => {
                let words = tr!("Too late: the page was busy. Press Send again.");
                return self.refused.set(Some(words.to_owned()));
            }
            _ => return,
        };
        let order = RawOrder { frame, repeat };
        let pending = self.pending.get_value() == Some(order);
        match refusal {
            // Ask each time, unless a stop came in between.
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

/// Whether the raw editor shows this notice.
pub(crate) fn belongs_to_raw_editor(notice: &Notice) -> bool {
    match notice {
        Notice::Refused { command, .. } | Notice::TooLate(command) => {
            matches!(command, CommandKind::SendRaw { .. } | CommandKind::StopRaw)
        }
        _ => false,
    }
}
