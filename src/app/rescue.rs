//! Stops what a failed port worker has left driven: another worker opens the same port for that alone.
//!
//! A wheel may turn on when frames cease. So the page does not wait for a person: the failed worker is terminated, which
//! frees its port, and the next one stops the motors as its first act on the port. After that the page stays stopped
//! until it is reloaded.

use std::{cell::Cell, rc::Rc, time::Duration};

use js_sys::{Function, Reflect};
use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_messages::{
    Adapter, Connection, ModelChoice, Notice, PortRef, ToPage, ToWorker, Update, UsbId,
    bus::{Activity, LeftDriven, MotorStatus, StopReport},
    protocol::{Mode, MotorId, family::Model},
};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};

use crate::{
    app::features::Features,
    link::{
        serial_ports,
        worker_link::{WorkerLink, WorkerState},
    },
    model::{
        help_topic::HelpTopic,
        notice_board::{NoticeText, Remedy, Tone, Topic},
        page::Page,
        snapshot::Session,
        terms,
    },
    ui::{clock::page_origin_ms, reactive::effect},
};

/// Workers that are started one after the other: one that fails at once will fail again.
const WORKERS_MAX: u32 = 3;
/// Pause before the port is tried again that does not open: longer than the worker itself tries it.
const TRY_AGAIN: Duration = Duration::from_millis(500);
/// Tries to open the port: half a minute. Then only the power switch is left.
const TRIES_MAX: u32 = 12;

/// What is known of the line of the failed worker.
struct Rescue {
    page: Page,
    usb: Option<UsbId>,
    model: Model,
    left: Vec<LeftDriven>,
    tries: Cell<u32>,
    workers: Cell<u32>,
}

/// How far it is.
enum Stage<'a> {
    Stopping,
    Stopped(&'a StopReport),
    NothingLeft,
    NotConfirmed,
}

/// From now on a worker that fails is noticed at once, and what it has left driven is stopped.
pub(crate) fn be_ready(features: Features) {
    let page = features.page;
    page.worker.rescue.set_value(Some(Box::new(move |session| {
        if let Some(rescue) = Rescue::of(page, session) {
            begin(&Rc::new(rescue));
        }
    })));
    let watched = StoredValue::new(false);
    effect(move || {
        let is_open = page.shown.with(|session| {
            matches!(
                session.connection,
                Connection::Connected(Adapter::Serial(_))
            )
        });
        if is_open && !watched.get_value() {
            watched.set_value(true);
            let lost = move || {
                // A page that is gone has nothing to lose.
                if page.worker.state.try_get_untracked() == Some(WorkerState::Running) {
                    features.worker_lost();
                }
            };
            // A browser without locks has the error event, and the pings.
            let _ = when_worker_ends(page, lost);
        }
    });
}

/// Calls `ended` when the worker has ended, however it ended: the browser releases its lock then. The worker takes it
/// before it opens its first serial port.
fn when_worker_ends(page: Page, ended: impl FnOnce() + 'static) -> Option<()> {
    let get = |object: &JsValue, name: &str| Reflect::get(object, &name.into()).ok();
    let locks = get(&get(&js_sys::global(), "navigator")?, "locks")?;
    let request: Function = get(&locks, "request")?.dyn_into().ok()?;
    let origin_ms = page
        .worker
        .clock
        .get_value()
        .worker_origin_ms(page_origin_ms());
    let name = lock_name(origin_ms);
    request
        .call2(&locks, &name.into(), &Closure::once_into_js(ended))
        .ok()?;
    Some(())
}

/// The name of the lock of the worker whose clock began then. The worker itself makes the same name (`adapters.js`), so
/// half a millisecond is rounded down in both: another name is free, as if the worker had ended.
fn lock_name(origin_ms: f64) -> String {
    format!("worker {:.0}", origin_ms.floor())
}

impl Rescue {
    /// `None` if no serial port was open: virtual motors end with their worker.
    fn of(page: Page, session: &Session) -> Option<Self> {
        let (Connection::Connected(adapter) | Connection::Reconnecting(adapter)) =
            session.connection
        else {
            return None;
        };
        let Adapter::Serial(usb) = adapter else {
            return None;
        };
        let left = session.motors.iter().filter(|motor| motor.may_turn);
        let left = left.map(|motor| LeftDriven {
            id: motor.id,
            mode: left_loop(motor),
        });
        let chosen = page.model.get_untracked();
        Some(Self {
            page,
            usb,
            model: session.line.map_or(chosen, |line| line.model),
            left: left.collect(),
            tries: Cell::new(0),
            workers: Cell::new(0),
        })
    }

    fn say(&self, stage: &Stage) {
        self.page.notify(&|| text(stage));
    }

    fn receive(self: &Rc<Self>, message: &ToPage) {
        match message {
            ToPage::Hello { .. } => self.connect(),
            ToPage::Died => begin(self),
            ToPage::Update(update) => self.update(update),
            ToPage::Ping | ToPage::Run(_) => {}
        }
    }

    fn update(self: &Rc<Self>, update: &Update) {
        let report = update.notices.iter().find_map(|notice| match notice {
            Notice::StopEnded(report) => Some(report),
            _ => None,
        });
        if let Some(report) = report {
            if report.motors.iter().all(|motor| motor.confirmed) {
                self.end(&Stage::Stopped(report));
            } else {
                self.say(&Stage::NotConfirmed);
            }
            return;
        }
        match update.connection {
            Connection::Failed(_) if self.tries.get() < TRIES_MAX => {
                let rescue = Rc::clone(self);
                set_timeout(move || rescue.connect(), TRY_AGAIN);
            }
            Connection::Failed(_) => self.say(&Stage::NotConfirmed),
            Connection::Connected(_) if !update.motors.iter().any(|motor| motor.may_turn) => {
                self.end(&Stage::NothingLeft);
            }
            _ => {}
        }
    }

    /// Opens the port of the failed worker. Of several that are alike the worker finds the right one.
    fn connect(self: &Rc<Self>) {
        self.tries.set(self.tries.get() + 1);
        let rescue = Rc::clone(self);
        spawn_local(async move {
            let permitted = serial_ports::permitted(rescue.usb)
                .await
                .unwrap_or_default();
            let of_make = |port: &PortRef| port.usb == rescue.usb;
            rescue.page.post(&ToWorker::ConnectSerial {
                candidates: permitted.into_iter().filter(of_make).collect(),
                wanted: rescue.page.selected.get_untracked(),
                model: ModelChoice {
                    model: rescue.model,
                    detect: false,
                },
                left: rescue.left.clone(),
            });
        });
    }

    /// Nothing turns: the worker has nothing more to do.
    fn end(&self, stage: &Stage) {
        self.page.worker.link.with_value(|link| {
            if let Some(link) = link {
                link.end();
            }
        });
        self.say(stage);
    }
}

/// The loop that the worker has left it in; `None` if it may be another one than the last reply says.
fn left_loop(motor: &MotorStatus) -> Option<Mode> {
    match motor.activity {
        Activity::Switching { .. } => None,
        _ => motor.last.map(|last| last.reply.mode),
    }
}

/// Starts a worker that stops the motors. Not within the handler that has noticed the failure, which belongs to the
/// failed worker.
fn begin(rescue: &Rc<Rescue>) {
    let nth = rescue.workers.get() + 1;
    rescue.workers.set(nth);
    if nth > WORKERS_MAX {
        rescue.say(&Stage::NotConfirmed);
        return;
    }
    rescue.say(&Stage::Stopping);
    let rescue = Rc::clone(rescue);
    spawn_local(async move {
        let (receiving, failing) = (Rc::clone(&rescue), Rc::clone(&rescue));
        let started = WorkerLink::spawn(
            move |message| receiving.receive(&message),
            move || begin(&failing),
        );
        match started {
            Ok(link) => rescue.page.worker.link.set_value(Some(link)),
            Err(_) => rescue.say(&Stage::NotConfirmed),
        }
    });
}

fn text(stage: &Stage) -> NoticeText {
    let reload = tr!("Reload the page to continue.");
    let title = tr!("The background worker has stopped");
    let say = |advice: &[&str]| {
        NoticeText::new(Topic::Worker, Tone::Error, title, advice)
            .explained_at(HelpTopic::StoppedByItself)
    };
    let with_reload = |text| NoticeText {
        remedy: Some(Remedy::Reload),
        ..text
    };
    match stage {
        Stage::Stopping => say(&[tr!(
            "Another one is stopping the motors. Until standstill is confirmed, a wheel may turn: keep clear."
        )]),
        Stage::Stopped(report) => {
            let ids: Vec<MotorId> = report.motors.iter().map(|motor| motor.id).collect();
            with_reload(say(&[&terms::stopped(&ids), reload]))
        }
        Stage::NothingLeft => with_reload(say(&[tr!("No motor was running."), reload])),
        Stage::NotConfirmed => with_reload(say(&[
            tr!("Standstill is not confirmed. If a wheel is turning, switch off the power."),
            reload,
        ])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::snapshot::tests::status;

    /// The motor may be in either loop. In the position loop, a brake turns the wheel to 0 degrees.
    #[test]
    fn the_loop_of_a_motor_that_switches_is_unknown() {
        let in_velocity_loop = status(0, Mode::Velocity, 0);
        assert_eq!(left_loop(&in_velocity_loop), Some(Mode::Velocity));
        let to = Mode::Position;
        let switching = MotorStatus {
            activity: Activity::Switching { to },
            ..in_velocity_loop
        };
        assert_eq!(left_loop(&switching), None);
    }

    #[test]
    fn the_lock_has_the_name_that_the_worker_gives_it() {
        for origin_ms in [
            1_795_266_936_962.0,
            1_795_266_936_962.5,
            1_795_266_936_962.9,
        ] {
            assert_eq!(lock_name(origin_ms), "worker 1795266936962");
        }
        assert_eq!(lock_name(1_795_266_936_963.5), "worker 1795266936963");
    }
}
